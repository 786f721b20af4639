#include "tools/program/command/record/fmu_documents.hpp"

#include <fmt/format.h>

#include "engine/base/provenance.hpp"
#include "tools/program/html/page.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

std::string rows_of(const std::vector<FmuVariable>& variables) {
    std::string rows;
    for (const FmuVariable& row : variables)
        rows +=
            fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", html(row.name),
                        row.kind == "flag" ? "output, Boolean" : row.kind, row.unit == "1" ? "" : html(row.unit), html(row.description));
    return rows;
}

std::string page_of(const FmuFacts& facts, const std::vector<FmuVariable>& variables, int version) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}</title></head>\n<body>\n<h1>{0}</h1>\n<p>{1}</p>\n"
        "<p>A chain-driven continuously variable transmission for co-simulation by FMI {2}.0, exported by cvtflow {3}. It runs on the "
        "thread "
        "of its importer. Communication steps may have any length; inputs are constant within a step. The FMU starts from a settled state; "
        "after a change of a parameter it settles again while its initialisation ends.</p>\n"
        "<p>Where the balance of energy does not close, results are wrong: <code>unreliable</code> becomes true, the step in which it does "
        "returns a warning, and the log states the reason.</p>\n{5}{4}<p><a "
        "href=\"licenses/license.txt\">Licences</a></p>\n</body>\n</html>\n",
        html(facts.name), html(facts.description), version, engine::current_provenance().version,
        table("", "Variables", {"name", "causality", "unit", "meaning"}, rows_of(variables)),
        facts.sources.empty() ? ""
                              : fmt::format("<p>sources/ has the library's sources. In that folder, GCC or Clang build it by<br><code>c++ "
                                            "@build.txt -o ../binaries/{}/{}.so</code><br>and with -march=native for this processor: "
                                            "the bits are the same.</p>\n",
                                            version == 2 ? "linux64" : "x86_64-linux", facts.identifier));
}

}  // namespace

std::vector<ZipPart> fmu_documents(const FmuFacts& facts, const std::vector<FmuVariable>& variables, int version) {
    const auto file = [](const char* name, const char* of) { return ZipPart{name, std::string(asset(of))}; };
    std::vector<ZipPart> parts{
        {"documentation/index.html", page_of(facts, variables, version)},
        {"documentation/licenses/license.txt", fmt::format("{}\n{}\n{}", asset("LICENSE"), std::string(80, '-'), asset("licenses.txt"))}};
    if (version == 2) {
        parts.push_back(file("model.png", "fmu_icon.png"));
    } else {
        parts.push_back(file("terminalsAndIcons/icon.png", "fmu_icon.png"));
        parts.push_back(file("terminalsAndIcons/icon.svg", "fmu_icon.svg"));
    }
    return parts;
}

}  // namespace cvtflow::tools
