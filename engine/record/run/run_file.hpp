#pragma once
/// The record of a run: channels over time, states, tables of events, attributes, in one HDF5 file.
///
///     /                     attributes: format "cvtflow run", format_version, status, and those given
///     /channels/time  [n] s    /channels/<name>  [n] or [n, width] (float32); attributes units, description, index, axis; scales: time,
///                           axis
///     /states/time    [m] s    /states/y  [m, state_size]    /states/phases  [m, phase_count] (uint8)
///     /tables/<name>  [k] compound of float64 and int64; attributes description, units[], descriptions[] (one per column)
///     /<axis>         scale of a second dimension, without numbers: /link, /tip, /unknown, /phase, …
///
/// During the run, the file is `<path>.part`, open as single writer with multiple readers (SWMR). After a kill at any instant it
/// holds all rows up to the last flush; channels may be longer than their time, never shorter. It takes its final name in close(), at once.
/// Leftover or live .part files open with RunReader, or in Python with h5py.File(path, "r", swmr=True). `h5clear -s` makes them plain.
/// A finished file ends with a seal (file_seal.hpp), which h5py and others pass over.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

/// Contents of a record. Names must be unique within their kind; "time" is taken; '/' in a channel's name makes groups.
struct RunContents {
    std::vector<ChannelInfo> channels{};
    std::size_t state_size = 0;   ///< unknowns; 0: no /states
    std::size_t phase_count = 0;  ///< bytes of discrete state that go with a state; 0: none
    std::string state_description = "state vector";
    std::vector<TableInfo> tables{};
    std::vector<Attribute> attributes{};
};

struct RunFileOptions {
    double flush_seconds = 5.0;  ///< wall time after which an append first flushes by itself [s]
    int channel_rows = 512;      ///< rows of channels gathered in memory; chunks of the file have as many, at most 512
    bool continues = false;      ///< `<path>.part` stays as it is, and this is discarded, unless take_place() is called
};

/// Writer. All errors are RecordError; those of writing contain the path, the reason and what is saved, for instance
/// "out.h5.part: cannot write: No space left on device; saved: 1024 rows up to t = 0.01023 s".
/// A full disk is noticed before anything is written, so the file stays whole, and the call may be repeated once there is room:
/// a row whose append threw was not taken; rows that were taken wait in memory.
///
/// Not thread-safe; one thread at a time. append… copy into memory taken at construction and allocate nothing; if a chunk is complete or
/// flush_seconds have passed they first call HDF5, which allocates inside (RowBlock::write) and writes.
class RunFile {
public:
    /// Creates `<path>.part`. Errors: those of require_place(), contents that contradict.
    RunFile(const OutputFile& file, RunContents contents, RunFileOptions options = {});
    /// Saves what it can if close() was not called, sets the status to "interrupted" unless set_status() was called, leaves the .part file.
    ~RunFile();
    RunFile(const RunFile&) = delete;
    RunFile& operator=(const RunFile&) = delete;

    /// One row of all channels. @param time [s] @param values all channels concatenated in order of declaration; those of a channel with
    /// several are rounded to floats here, as they are in the file
    void append(double time, std::span<double> values);
    /// @param time [s] @param state state_size values @param phases phase_count values
    void append_state(double time, std::span<const double> state, std::span<const std::uint8_t> phases);
    /// One row of a table. Integer columns take whole numbers of magnitude below 2^53. values [columns]
    void append_row(std::string_view table, std::span<const double> values);

    /// Adds or replaces an attribute of the whole file. It reaches the file when this object closes it (SWMR allows no sooner).
    void set_attribute(Attribute attribute);
    /// Sets a status other than "finished", e.g. the text of a fault. It reaches the file when this object closes it; until then "running".
    void set_status(std::string status);

    /// Brings every row to disk (fsync).
    void flush();
    /// Flushes and becomes `<path>.part`, in place of the record whose rows it has.
    void take_place();
    /// Flushes, completes, and renames to the final name. No call but the destructor may follow.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace cvtflow::engine
