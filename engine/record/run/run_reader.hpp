#pragma once
/// Reads the record of a run (run_file.hpp draws it): finished, left by a killed run, or being written.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

struct RecordedState {
    double time = 0.0;          ///< [s]
    std::vector<double> state;  ///< [unknowns]
    std::vector<std::uint8_t> phases;
    bool operator==(const RecordedState&) const = default;
};

/// All errors are RecordError. At opening, after "path: ": "No such file or directory", "a folder, not a file", "not a regular file", "not
/// an HDF5 file", "truncated HDF5 file: 2000 bytes of 8200", "damaged HDF5 file (reason)", "an HDF5 file, but not a cvtflow run", "format
/// version 2 is newer than this program reads (1)"; later for names that are not there and for damaged data. Rows are those that were there
/// at opening.
class RunReader {
public:
    explicit RunReader(const std::string& path);
    ~RunReader();
    RunReader(RunReader&&) noexcept;
    RunReader& operator=(RunReader&&) noexcept;

    /// Whether it is byte for byte what its writer finished; false while it is written, after a kill, and for what others have made of it.
    [[nodiscard]] bool sealed() const noexcept { return sealed_; }
    /// "finished", "running" (also of a killed run), "interrupted", what is wrong with its results, or what ended the run.
    [[nodiscard]] const std::string& status() const noexcept { return status_; }
    /// Attributes of the whole file, by name; without format, format_version and status.
    [[nodiscard]] const std::vector<Attribute>& attributes() const noexcept { return attributes_; }

    /// Channels in order of declaration.
    [[nodiscard]] const std::vector<ChannelInfo>& channels() const noexcept { return channels_; }
    /// Rows of every channel.
    [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
    /// Times of the rows [s].
    [[nodiscard]] std::vector<double> times() const;
    /// All rows of a channel, [rows * width], row by row.
    [[nodiscard]] std::vector<double> channel(std::string_view name) const;
    /// Rows first … first + count - 1 of a channel, or of "time" [s]. @param count all of these rows must be there
    [[nodiscard]] std::vector<double> channel_rows(std::string_view name, std::size_t first, std::size_t count) const;
    /// Last row of a channel, [width]; empty if there are no rows.
    [[nodiscard]] std::vector<double> last(std::string_view name) const;

    /// Times of the recorded states [s]; may be empty.
    [[nodiscard]] std::vector<double> state_times() const;
    /// @param number 0 … state_times().size() - 1
    [[nodiscard]] RecordedState state(std::size_t number) const;

    [[nodiscard]] const std::vector<TableInfo>& tables() const noexcept { return tables_; }
    /// Rows of a table, each as long as it has columns; integers as reals.
    [[nodiscard]] std::vector<std::vector<double>> table(std::string_view name) const;

private:
    struct Impl;
    std::string path_;
    std::unique_ptr<Impl> impl_;
    bool sealed_ = false;
    std::string status_;
    std::vector<Attribute> attributes_;
    std::vector<ChannelInfo> channels_;
    std::vector<TableInfo> tables_;
    std::size_t rows_ = 0, states_ = 0;
};

/// Whether a record has a text as its attribute of that name; `torn`: or its beginning, which a power cut leaves.
/// @throws RecordError as RunReader
[[nodiscard]] bool is_record_with(const std::string& path, std::string_view attribute, std::string_view text, bool torn = false);
/// Whether a file is what a writer that was killed has left of a record, so that HDF5 cannot read it.
[[nodiscard]] bool is_torn_record(const std::string& path);
/// For readers of others: @throws RecordError for a file that cannot be read, or whose bytes have changed since it was finished
void require_unchanged(const std::string& path);

}  // namespace cvtflow::engine
