#include "source_tree_fixture.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace cvtflow::architecture {

namespace {

const std::array folders{"model", "engine", "tasks", "api", "tools", "bench", "examples", "tests"};

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string output_of(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return "";
    std::string output;
    std::array<char, 4096> buffer;
    while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
    return pclose(pipe) == 0 ? output : "";
}

std::vector<SourceFile> source_files() {
    const std::filesystem::path root = CVTFLOW_SOURCE_DIR;
    std::vector<SourceFile> files;
    for (const char* folder : folders) {
        if (!std::filesystem::exists(root / folder)) continue;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".cpp" && extension != ".hpp") continue;
            files.push_back({std::filesystem::relative(entry.path(), root).generic_string(), read(entry.path())});
        }
    }
    std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
    return files;
}

std::set<std::string> tracked_top_level() {
    std::istringstream listing(output_of("git -C '" CVTFLOW_SOURCE_DIR "' ls-files 2>/dev/null"));
    std::set<std::string> names;
    for (std::string path; std::getline(listing, path);) names.insert(path.substr(0, path.find('/')));
    return names;
}

std::vector<Include> includes_of(const std::string& text) {
    static const std::regex pattern(R"rx(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)rx");
    std::vector<Include> includes;
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::smatch match;
        if (std::regex_match(line, match, pattern)) includes.push_back({number, match[2], match[1] == "\""});
    }
    return includes;
}

int line_count(const std::string& text) {
    const auto newlines = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    return !text.empty() && text.back() != '\n' ? newlines + 1 : newlines;
}

}  // namespace cvtflow::architecture
