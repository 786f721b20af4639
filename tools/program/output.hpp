#pragma once
/// Output of commands: where it goes, which existing files it may replace, folders of results.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/part_file.hpp"
#include "tasks/scene/scene.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cvtflow::tools {

inline constexpr const char* force_meaning = "Replace existing output files";

/// The name of a file beside a record or sweep: its name, without .h5, .part, .csv or .toml, and another ending. "run_0.1" gives
/// "run_0.1.html".
[[nodiscard]] std::string beside(const std::string& file, std::string_view ending);

/// A file that a command writes: it may replace one with `force`, and a finished one that is not write-protected under a default name in
/// results/. @param named the user chose the name
[[nodiscard]] engine::OutputFile output_file(const std::string& path, bool named, bool force);
/// "FILE: the existing file is replaced"; empty: there is none.
[[nodiscard]] std::string replacing(const std::string& path);

/// Path results/NAME of what no -o names; creates the folder. @throws engine::RecordError if this user must not
[[nodiscard]] std::string default_place(const std::string& name);
/// Lets an input of a command be NAME alone where only results/NAME exists, with a line on stderr. @param files  not of folders: a channel
/// may have the name of one
CLI::Option* with_default_place(CLI::Option* option, bool files = false);

/// Checks the path of a checkpoint: an existing file must be a checkpoint, because it is removed at the end of the run.
/// @throws engine::RecordError
void require_checkpoint_place(const std::string& path, const std::vector<std::filesystem::path>& inputs);
/// Refuses to start a run whose checkpoint exists: that run is unfinished. @throws engine::RecordError
void keep_checkpoint(const std::string& file);
/// Removes such a checkpoint, whose record will be replaced, unless it is an input.
void forget_checkpoint(const std::string& file, const std::vector<std::filesystem::path>& inputs);

/// -o DIR, --csv, --json, --svg.
struct OutputArguments {
    std::string folder;                           ///< empty: no files, or "results" if a kind is requested
    bool csv = false, json = false, svg = false;  ///< requested kinds; none: all

    [[nodiscard]] bool any() const noexcept { return !folder.empty() || csv || json || svg; }
    [[nodiscard]] bool wants_pictures() const noexcept { return svg || (!folder.empty() && !csv && !json); }
};

void declare_output(CLI::App& app, OutputArguments& arguments);

}  // namespace cvtflow::tools
