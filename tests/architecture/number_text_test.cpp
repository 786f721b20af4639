/// Numbers are read and written with a decimal point, whatever the locale of the host: std::from_chars (engine/base/text.hpp) and fmt.

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

/// Calls that follow the locale of C or C++.
const std::regex locale_calls(R"(\b(strto(d|f|ld)|atof|sto(d|f|ld)|[a-z]*printf|[a-z]*scanf|setlocale|localeconv)\b ?\()"
                              R"(|\b(basic_)?o?stringstream\b|\bstd::locale\(|\blocale::global\b|\bput_time\b)");
const std::regex stream(R"(\b(std::)?(ifstream|istringstream|istream)\b)"), extraction(R"([\w)] >> [a-z]\w*)"), grouped(R"(\{:[^{}"]*L\})");

/// Who may, and why.
const std::map<std::string, std::string> locale_exempt{
    {"tasks/scene/ready_scenes.cpp", "addresses in hexadecimal"},
    {"tasks/batch/shard.cpp", "counts in a folder's name"},
    {"tools/program/command/run/resume.cpp", "counts in a folder's name"},
    {"tasks/batch/sweep/scalar.cpp", "words"},
    {"tasks/schedule/schedule.cpp", "words, which number_of reads"},
    {"engine/record/hdf5/hdf5_open.cpp", "a word, which number_of reads"},
    {"tools/cmake/web/missing.hpp", "functions that a browser's library lacks: it has the C locale alone"},
};

/// Whether a file's code runs in a host's process or writes files. Other benchmarks are programs that leave the locale as it is: "C".
bool reads_numbers(const SourceFile& file) {
    static const std::set<std::string> parts{"engine", "model", "tasks", "api", "tools"};
    return parts.contains(file.part()) || file.path.starts_with("bench/lab/") || file.path.starts_with("bench/study/");
}

/// Call that follows the locale, or "".
std::string localised(const std::string& text) {
    const std::string code = code_only(text);
    std::smatch found;
    if (std::regex_search(code, found, locale_calls)) return found.str();
    const bool read = std::regex_search(code, stream) && code.find(".imbue(") == std::string::npos;
    if (read && std::regex_search(code, found, extraction)) return found.str();
    return std::regex_search(text, grouped) ? "{:L}" : "";
}

TEST(NumberText, FollowsNoLocale) {
    std::set<std::string> used;
    for (const SourceFile& file : source_files()) {
        if (!reads_numbers(file)) continue;
        const std::string found = localised(file.text);
        if (found.empty()) continue;
        used.insert(file.path);
        EXPECT_TRUE(locale_exempt.contains(file.path))
            << file.path << ": '" << found << "' follows the locale: use engine::number_of and fmt";
    }
    for (const auto& [path, reason] : locale_exempt) EXPECT_TRUE(used.contains(path)) << path << " is exempt and need not be: " << reason;
}

TEST(NumberText, TheScannerFindsEveryKindOfCall) {
    for (const char* text :
         {"x = std::strtod(a, b);", "x = atof(a);", "x = std::stod(a);", "std::snprintf(a, n, f, x);", "printf(f, x);",
          "std::ostringstream text;", "std::ifstream file(path);\ndouble x;\nfile >> x;", "std::sscanf(a, b)", "fmt::format(\"{:L}\", n)"})
        EXPECT_NE(localised(text), "") << text;
    for (const char* text : {"std::strtoul(a, b, 10);", "fmt::print(f, x);", "std::istringstream a(b);\na.imbue(c);\na >> x;",
                             "x = y >> z;", "std::ifstream file(path);\nstd::getline(file, line);"})
        EXPECT_EQ(localised(text), "") << text;
}

}  // namespace
}  // namespace cvtflow::architecture
