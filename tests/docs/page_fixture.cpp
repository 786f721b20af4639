#include "tests/docs/page_fixture.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace cvtflow::docs {
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

namespace {

/// Reads the comment above a block, if it is such a comment.
void read_comment(const std::string& line, Block& next) {
    static const std::regex form("<!-- (file|nightly|deep|not run): (.*) -->");
    std::smatch match;
    if (!std::regex_match(line, match, form)) return;
    if (match[1] == "file") next.file = match[2];
    if (match[1] == "nightly") next.nightly = match[2];
    if (match[1] == "deep") next.deep = match[2];
    if (match[1] == "not run") next.not_run = match[2];
}

/// Calls each(line, number, inside a block) for every line, fences included in the block.
template <class Each>
void walk(const std::string& text, const Each& each) {
    std::istringstream lines(text);
    bool inside = false;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        const bool fence = line.starts_with("```");
        each(line, ++number, inside || fence);
        if (fence) inside = !inside;
    }
}

}  // namespace

std::vector<Block> Page::blocks() const {
    std::vector<Block> found;
    Block next;
    bool open = false;
    walk(text, [&](const std::string& line, int number, bool inside) {
        if (inside && line.starts_with("```")) {
            if (open) found.push_back(std::exchange(next, {}));
            open = !open;
            if (open) next.line = number, next.language = line.substr(3);
        } else if (inside) {
            next.text += line + "\n";
        } else {
            read_comment(line, next);
        }
    });
    return found;
}

std::vector<Line> Page::text_lines() const {
    std::vector<Line> found;
    walk(text, [&](const std::string& line, int number, bool inside) {
        if (!inside) found.push_back({number, line});
    });
    return found;
}

std::vector<std::string> Page::links() const {
    static const std::regex link(R"(\]\(([^)\s]+)\))"), code("`[^`]*`");
    std::vector<std::string> found;
    walk(text, [&](const std::string& line, int, bool inside) {
        if (inside) return;
        const std::string plain = std::regex_replace(line, code, "");
        for (std::sregex_iterator each(plain.begin(), plain.end(), link), end; each != end; ++each) found.push_back((*each)[1]);
    });
    return found;
}

std::vector<std::string> Page::anchors() const {
    std::vector<std::string> found;
    walk(text, [&](const std::string& line, int, bool inside) {
        if (inside || !line.starts_with("#")) return;
        std::string name;
        for (const char letter : line.substr(std::min(line.size(), line.find(' ') + 1))) {
            const auto code = static_cast<unsigned char>(letter);
            if (std::isalnum(code) != 0 || letter == '-' || letter == '_' || code >= 0x80) name += static_cast<char>(std::tolower(code));
            if (letter == ' ') name += '-';
        }
        found.push_back(name);
    });
    return found;
}

const std::vector<Page>& pages() {
    static const std::vector<Page> all = [] {
        const fs::path top = CVTFLOW_SOURCE_DIR;
        std::vector<Page> found;
        const auto take = [&](const fs::directory_entry& entry) {
            if (entry.path().extension() == ".md")
                found.push_back({entry.path().lexically_relative(top).generic_string(), text_of(entry.path())});
        };
        for (const auto& entry : fs::directory_iterator(top)) take(entry);
        for (const char* folder : {"docs", "model", "tools", "api"})
            for (const auto& entry : fs::recursive_directory_iterator(top / folder)) take(entry);
        std::sort(found.begin(), found.end(), [](const Page& a, const Page& b) { return a.path < b.path; });
        return found;
    }();
    return all;
}

Page page(const std::string& path) {
    for (const Page& each : pages())
        if (each.path == path) return each;
    throw std::invalid_argument("no page " + path);
}

std::vector<std::string> avoided_words(const Page& glossary) {
    static const std::regex row(R"(\|[^|]*\|[^|]*\|([^|]*)\|)"), italics(R"(\*([^*]+)\*)");
    std::vector<std::string> found;
    bool inside = false;
    for (const Line& line : glossary.text_lines()) {
        inside = line.text.starts_with("|") && (inside || line.text == "| word | means | not |");
        std::smatch match;
        if (!inside || !std::regex_match(line.text, match, row)) continue;
        const std::string cell = match[1];
        for (std::sregex_iterator each(cell.begin(), cell.end(), italics), end; each != end; ++each) found.push_back((*each)[1]);
    }
    return found;
}

}  // namespace cvtflow::docs
