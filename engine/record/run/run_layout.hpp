#pragma once
/// Internal to engine/record: what the datasets of a run's file are, and how they are created. The drawing is in run_file.hpp.

#include <string>
#include <vector>

#include "engine/record/hdf5/hdf5_series.hpp"
#include "engine/record/run/run_file.hpp"

namespace cvtflow::engine::hdf5 {

inline constexpr const char* run_format = "cvtflow run";
inline constexpr std::int64_t run_format_version = 1;

/// Datasets that grow together, the time (if any) last, as RowBlock requires.
struct BlockShape {
    std::vector<SeriesShape> series;
    std::size_t rows = 1;  ///< number per chunk
};

struct RunLayout {
    BlockShape channels;
    BlockShape states;               ///< y, phases (if any), time; empty if there are no states
    std::vector<BlockShape> tables;  ///< one dataset each
    std::vector<Handle> types;       ///< keeps the tables' compound types alive
};

/// Throws Failure if names are empty, taken twice or reserved, or widths are not positive.
void check_contents(const RunContents& contents);
[[nodiscard]] RunLayout run_layout(const RunContents& contents, const RunFileOptions& options);
/// Creates the file with all its objects, which SWMR does not allow later, and closes it. Throws Failure.
void create_run(const std::string& path, const RunContents& contents, const RunLayout& layout);

}  // namespace cvtflow::engine::hdf5
