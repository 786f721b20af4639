/// Gates on size: files of 500 lines, functions of 40, lines of 140 characters.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

constexpr int max_file_lines = 500;
constexpr int max_function_lines = 40;
constexpr std::ptrdiff_t most_columns = 140;

/// The only file with a longer function, which is a table: path and what is tabulated.
const std::map<std::string, std::string> tables{
    {"tasks/scene/parameter_table.cpp", "one row per parameter"},
};

TEST(Size, FilesAreShort) {
    for (const SourceFile& file : source_files()) EXPECT_LE(line_count(file.text), max_file_lines) << file.path;
}

TEST(Size, FunctionsAreShort) {
    for (const SourceFile& file : source_files()) {
        if (tables.contains(file.path)) continue;
        for (const FunctionBody& function : functions_of(file.text)) {
            EXPECT_LE(function.lines, max_function_lines) << file.path << ":" << function.line << ": " << function.head;
        }
    }
}

/// The formatter breaks no text in quotes.
TEST(Size, LinesAreShort) {
    for (const SourceFile& file : source_files()) {
        std::istringstream lines(file.text);
        int number = 0;
        for (std::string line; std::getline(lines, line);) {
            ++number;
            const auto characters = std::count_if(line.begin(), line.end(), [](char byte) { return (byte & 0xC0) != 0x80; });  // UTF-8
            EXPECT_LE(characters, most_columns) << file.path << ":" << number;
        }
    }
}

TEST(Size, ExemptionsAreNeeded) {
    for (const SourceFile& file : source_files()) {
        if (!tables.contains(file.path)) continue;
        const auto functions = functions_of(file.text);
        const bool needed =
            std::any_of(functions.begin(), functions.end(), [](const FunctionBody& each) { return each.lines > max_function_lines; });
        EXPECT_TRUE(needed) << file.path << " has no long function any more: take it off the list";
    }
}

TEST(Size, TheScannerSeesTheCode) {
    std::size_t functions = 0;
    for (const SourceFile& file : source_files()) functions += functions_of(file.text).size();
    EXPECT_GT(functions, 100u);
}

}  // namespace
}  // namespace cvtflow::architecture
