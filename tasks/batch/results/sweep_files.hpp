#pragma once
/// The files that a sweep writes into its folder, by name: what it may replace there, and all that it removes. Internal to tasks.

#include <filesystem>
#include <string>

#include "engine/record/run/output_rule.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

/// The table of a sweep. Replaces a table with the same definition. @param read  the file's own contents were read and are of this sweep,
/// even if HDF5 cannot read it
[[nodiscard]] engine::Permit permit_table(const std::string& file, const std::string& definition, bool read = false);
/// The record of a case. Replaces one of the same case, and what a killed writer left of it.
[[nodiscard]] engine::Permit permit_record(const std::string& file, const Scene& of_case);
/// A state or checkpoint. Replaces one.
[[nodiscard]] engine::Permit permit_state(const std::string& file, const Sweep& sweep);

/// Removes the checkpoints and ends of cases that are over: DIR/checkpoints and DIR/continuation. Files of other names stay, and so do the
/// sweep's inputs.
void remove_case_files(const std::filesystem::path& checkpoints, const std::filesystem::path& continuation, const Sweep& sweep);

/// An empty folder DIR/bench-XXXXXX that goes with this object, with all that a sweep has written there.
class BenchFolder {
public:
    /// @throws engine::RecordError
    BenchFolder(const std::string& parent, const Sweep& sweep);
    ~BenchFolder();
    BenchFolder(const BenchFolder&) = delete;
    BenchFolder& operator=(const BenchFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
    /// Takes the table of the round before away.
    void forget_table() const;

private:
    const Sweep& sweep_;
    std::filesystem::path path_;
};

}  // namespace cvtflow::tasks
