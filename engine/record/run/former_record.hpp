#pragma once
/// Continues a record: copies what an earlier run wrote up to a checkpoint into the record of the continuing run.
///
/// A file that HDF5 had open for writing when its process was killed is safe to read but not to write: space that its tables use may count
/// as free. So the rows are copied, up to their count at the checkpoint, into FILE.part.part, which then becomes FILE.part.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/record/run/run_file.hpp"

namespace cvtflow::engine {

/// Rows of one kind: how many, and a checksum over all of them in their order.
struct RowsWritten {
    std::size_t count = 0;
    std::uint64_t sum = 0;

    /// Adds a row, with its time and phases if it has any.
    /// @param time [s]   @param values [columns]
    void add(double time, std::span<const double> values, std::span<const std::uint8_t> phases = {}) noexcept;
    bool operator==(const RowsWritten&) const = default;
};

/// Number and checksums of the rows at a checkpoint, to recognise an unfinished record, which has no seal.
struct RecordPosition {
    RowsWritten channels;
    RowsWritten states;
    std::vector<RowsWritten> tables{};  ///< rows of tables in the order of RunContents, without time
};

/// Record that a run continues, locked against other writers.
struct FormerRecord {
    std::string path;  ///< FILE.part, or else the finished FILE; empty: neither is of the run
    Descriptor lock = Descriptor();
};

/// Checks the place of a record that is continued, where files of the run may be replaced. @param own whether a record is of the run
/// @throws RecordError as require_place()
[[nodiscard]] FormerRecord former_record(OutputFile& file, const MayReplace& own);

/// Copies the first rows of a record into a new one of the same contents, which then takes its place.
/// Errors (RecordError): the former holds less than that, or other numbers, e.g. since it is another run's; other channels; damaged.
void copy_record(const std::string& path, const RecordPosition& until, const RunContents& contents, RunFile& file);

}  // namespace cvtflow::engine
