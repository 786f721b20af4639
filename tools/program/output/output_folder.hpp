#pragma once
/// Files that a measuring command leaves behind: tables, numbers for programs, pictures.

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace cvtflow::tools {

/// -o DIR, --csv, --json, --svg.
struct OutputArguments {
    std::string folder;                           ///< empty: nothing is written, unless a kind is asked for: then "results"
    bool csv = false, json = false, svg = false;  ///< kinds asked for; none: all

    [[nodiscard]] bool any() const noexcept { return !folder.empty() || csv || json || svg; }
};

void declare_output(CLI::App& app, OutputArguments& arguments);

/// Writes files of the kinds asked for, creating the folder.
class OutputFolder {
public:
    explicit OutputFolder(const OutputArguments& arguments) : arguments_(arguments) {}
    /// Does nothing if its kind (by the name's ending: .csv, .json, .svg) is not asked for.
    /// @throws std::runtime_error "DIR/NAME: cannot write"
    void write(const std::string& name, const std::string& text);
    [[nodiscard]] bool wants(const std::string& name) const;
    /// "  written             DIR/NAME, …\n", and which kinds were asked for that this command had nothing for; empty if nothing was asked
    /// for.
    [[nodiscard]] std::string written() const;

private:
    OutputArguments arguments_;
    std::vector<std::string> names_;
};

}  // namespace cvtflow::tools
