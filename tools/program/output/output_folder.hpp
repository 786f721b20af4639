#pragma once
/// Files of results: tables (CSV), numbers for programs (JSON), pictures (SVG).

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace cvtflow::tools {

/// -o DIR, --csv, --json, --svg.
struct OutputArguments {
    std::string folder;                           ///< empty: no files, or "results" if a kind is requested
    bool csv = false, json = false, svg = false;  ///< requested kinds; none: all

    [[nodiscard]] bool any() const noexcept { return !folder.empty() || csv || json || svg; }
};

void declare_output(CLI::App& app, OutputArguments& arguments);

/// Writes files of the requested kinds; creates the folder.
class OutputFolder {
public:
    explicit OutputFolder(const OutputArguments& arguments) : arguments_(arguments) {}
    /// Does nothing if its kind (by the name's ending: .csv, .json, .svg) is not requested.
    /// @throws std::runtime_error "DIR/NAME: cannot write"
    void write(const std::string& name, const std::string& text);
    [[nodiscard]] bool wants(const std::string& name) const;
    /// "  written             DIR/NAME, …\n", and requested kinds that this command does not have; empty if no file was requested.
    [[nodiscard]] std::string written() const;

private:
    OutputArguments arguments_;
    std::vector<std::string> names_;
};

}  // namespace cvtflow::tools
