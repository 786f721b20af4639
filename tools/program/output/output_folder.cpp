#include "tools/program/output/output_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

#include "tools/program/output/outputs.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

void declare_output(CLI::App& app, OutputArguments& arguments) {
    app.add_option("-o,--output", arguments.folder, "Folder for tables and pictures (default: none; results with --csv, --json or --svg)")
        ->type_name("DIR");
    app.add_flag("--csv", arguments.csv, "Write tables");
    app.add_flag("--json", arguments.json, "Write all results as JSON, with provenance");
    app.add_flag("--svg", arguments.svg, "Write pictures (default with -o: --csv, --json and --svg)");
}

bool OutputFolder::wants(const std::string& name) const {
    if (!arguments_.any()) return false;
    if (!arguments_.csv && !arguments_.json && !arguments_.svg) return true;
    return (name.ends_with(".csv") && arguments_.csv) || (name.ends_with(".json") && arguments_.json) ||
           (name.ends_with(".svg") && arguments_.svg);
}

void OutputFolder::write(const std::string& name, const std::string& text) {
    if (!wants(name)) return;
    const std::filesystem::path path = std::filesystem::path(arguments_.folder.empty() ? "results" : arguments_.folder) / name;
    std::error_code ignored;  // writing the file then fails with a message
    std::filesystem::create_directories(path.parent_path(), ignored);
    const bool picture = name.ends_with(".svg");
    engine::OutputRule rule = picture ? marked_rule("picture", name) : text_rule(text);
    rule.advice = "remove it, or name another folder";
    engine::write_whole({path.string(), rule}, picture ? marked(text, mark_of("picture", name)) : text);
    names_.push_back(path.string());
}

std::string OutputFolder::written() const {
    std::string text = names_.empty() ? "" : field("written", fmt::format("{}", fmt::join(names_, ", ")));
    for (const auto& [asked, ending] : {std::pair{arguments_.csv, "csv"}, {arguments_.json, "json"}, {arguments_.svg, "svg"}}) {
        const auto ends = [kind = std::string(".") + ending](const std::string& name) { return name.ends_with(kind); };
        if (asked && std::none_of(names_.begin(), names_.end(), ends))
            text += field("not written", fmt::format("--{}: this command has no such file", ending));
    }
    return text;
}

}  // namespace cvtflow::tools
