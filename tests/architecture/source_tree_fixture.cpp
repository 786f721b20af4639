#include "source_tree_fixture.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
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
    std::istringstream listing(output_of(git + "ls-files 2>/dev/null"));
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

// A scanner of braces: enough C++ to measure functions, no more.

namespace {

/// Overwrites [begin, end) with spaces, keeping line breaks.
void blank(std::string& text, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < std::min(end, text.size()); ++i) {
        if (text[i] != '\n') text[i] = ' ';
    }
}

std::size_t after(const std::string& text, const std::string& what, std::size_t from) {
    const std::size_t found = text.find(what, from);
    return found == std::string::npos ? text.size() : found + what.size();
}

std::size_t end_of_literal(const std::string& text, std::size_t begin) {
    std::size_t i = begin + 1;
    while (i < text.size() && text[i] != text[begin] && text[i] != '\n') i += text[i] == '\\' ? 2 : 1;
    return i + 1;
}

std::size_t end_of_raw_literal(const std::string& text, std::size_t quote) {
    const std::size_t open = text.find('(', quote);
    return after(text, ")" + text.substr(quote + 1, open - quote - 1) + "\"", open);
}

std::size_t end_of_directive(const std::string& text, std::size_t begin) {
    std::size_t end = text.find('\n', begin);
    while (end != std::string::npos && end > 0 && text[end - 1] == '\\') end = text.find('\n', end + 1);
    return end == std::string::npos ? text.size() : end;
}

bool word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Where the comment, literal or directive that begins at i ends; i if none begins there.
std::size_t end_of_noise(const std::string& text, std::size_t i, bool line_start) {
    const char c = text[i];
    const char before = i == 0 ? '\n' : text[i - 1];
    if (c == '#' && line_start) return end_of_directive(text, i);
    if (c == '/' && text.compare(i, 2, "//") == 0) return end_of_directive(text, i);
    if (c == '/' && text.compare(i, 2, "/*") == 0) return after(text, "*/", i + 2);
    if (c == '"') return before == 'R' ? end_of_raw_literal(text, i) : end_of_literal(text, i);
    if (c == '\'' && !word(before)) return end_of_literal(text, i);
    return i;
}

enum class Block { scope, initialiser, function };

/// Kind of block that a brace opens, from the text between the last ; { or } and itself.
Block kind_of(const std::string& head) {
    static const std::regex scope(R"(^(?:template\s*<.*>\s*)?(?:requires\s*\([^()]*\)\s*)?(?:(?:inline|export|typedef|extern)\s*)*)"
                                  R"((?:namespace|class|struct|union|enum)\b(?:\s+alignas\s*\([^()]*\))?[^()=]*$)");
    static const std::regex linkage(R"(^extern\s*$)");
    if (std::regex_match(head, scope) || std::regex_match(head, linkage)) return Block::scope;
    if (!head.empty() && (head.back() == '=' || head.find('(') == std::string::npos)) return Block::initialiser;
    return Block::function;
}

std::string one_line(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (!space) result += c;
        if (space && !result.empty() && result.back() != ' ') result += ' ';
    }
    while (!result.empty() && result.back() == ' ') result.pop_back();
    return result;
}

int line_of(const std::string& text, std::size_t position) {
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

std::size_t closing_brace(const std::string& code, std::size_t open) {
    int depth = 0;
    for (std::size_t i = open; i < code.size(); ++i) {
        if (code[i] == '{') ++depth;
        if (code[i] == '}' && --depth == 0) return i;
    }
    return code.size() - 1;
}

/// Name of the function that a statement or a head begins, with its class where it is given; empty if it is none for others.
std::string function_name(const std::string& head) {
    static const std::regex none(R"(^(template|using|friend|static|static_assert|typedef|return|extern|enum|catch|inline)\b)"
                                 R"(|\)[^()]*= ?(0|default|delete)$)");
    static const std::regex pattern(R"(^[^(=<]*?(?:<[^()]*>[^(=<]*?)?((?:\w+::)?~?\b\w+) ?\((?!\*))");
    static const std::regex keyword(R"(^(void|bool|int|double|alignas|noexcept|decltype|operator)$)");
    std::smatch match;
    if (std::regex_search(head, none) || head.find("operator") != std::string::npos) return "";
    return std::regex_search(head, match, pattern) && !std::regex_match(match[1].str(), keyword) ? match[1].str() : "";
}

/// Removes attributes and the access specifier in front of a member.
std::string plain_head(const std::string& head) {
    static const std::regex noise(R"(\[\[.*?\]\] ?|\b(public|private|protected) ?: ?)");
    return std::regex_replace(head, noise, "");
}

/// Class of the innermost scope with "::", empty in a namespace.
std::string class_of(const std::string& scope) {
    static const std::regex pattern(R"((?:^|> |\) )(?:class|struct) (?:alignas ?\([^)]*\) |[A-Z_]+ )?(\w+))");
    std::smatch match;
    return std::regex_search(scope, match, pattern) ? match[1].str() + "::" : "";
}

/// Names of the base classes in the head of a class.
std::vector<std::string> bases_of(std::string head) {
    static const std::regex arguments(R"(<[^<>]*>)"), base(R"((?: : |, )(?:(?:public|private|protected|virtual) )*(?:\w+::)*(\w+))");
    for (std::size_t before = 0; before != head.size();) before = head.size(), head = std::regex_replace(head, arguments, "");
    std::vector<std::string> bases;
    for (std::sregex_iterator match(head.begin(), head.end(), base), end; match != end; ++match) bases.push_back((*match)[1]);
    return bases;
}

/// Name of the method of a class that a statement or a head inside of it declares; empty if it declares none.
std::string method_name(const std::string& head, const std::string& name) {
    static const std::regex prefix(R"(^(?:template ?<.*?> (?=\w)|requires ?\([^()]*\) |(?:static|inline|constexpr|virtual|explicit) )+)");
    static const std::regex none(
        R"(^(?:using|friend|typedef|static_assert|enum|struct|class)\b|\boperator\b|~|\) ?= ?(?:default|delete)$)");
    static const std::regex function(R"(^[^(=]*?\b(\w+) ?\()");
    const std::string plain = std::regex_replace(head, prefix, "");
    std::smatch match;
    const bool declares = !std::regex_search(plain, none) && std::regex_search(plain, match, function) && match[1].str() != name;
    return declares ? match[1].str() : "";
}

}  // namespace

std::string code_only(const std::string& text) {
    std::string code = text;
    bool line_start = true;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t end = end_of_noise(text, i, line_start);
        blank(code, i, end);
        if (end == i && text[i] == '\n') line_start = true;
        if (end == i && std::isspace(static_cast<unsigned char>(text[i])) == 0) line_start = false;
        i = std::max(end, i + 1);
    }
    return code;
}

std::vector<FunctionBody> functions_of(const std::string& text) {
    const std::string code = code_only(text);
    std::vector<FunctionBody> functions;
    std::size_t begin = 0;  // of the head
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code[i] == ';' || code[i] == '}') begin = i + 1;
        if (code[i] != '{') continue;
        const std::string head = one_line(code.substr(begin, i - begin));
        const Block kind = kind_of(head);
        if (kind != Block::scope) {
            while (begin < i && std::isspace(static_cast<unsigned char>(code[begin])) != 0) ++begin;
            const std::size_t end = closing_brace(code, i);
            const int line = line_of(code, begin);
            if (kind == Block::function) functions.push_back({head, line, line_of(code, end) - line + 1, code.substr(i, end - i)});
            i = end;
        }
        begin = i + 1;
    }
    return functions;
}

std::vector<NamedFunction> named_functions(const std::string& text) {
    const std::string code = code_only(text);
    std::vector<NamedFunction> functions;
    std::vector<std::string> scopes;
    std::size_t begin = 0;  // of the head
    for (std::size_t i = 0; i < code.size(); ++i) {
        const char c = code[i];
        if (c != ';' && c != '{' && c != '}') continue;
        if (c == '}' && !scopes.empty()) scopes.pop_back();
        const std::string head = c == '}' ? "" : one_line(plain_head(one_line(code.substr(begin, i - begin))));
        if (c == '{' && kind_of(head) == Block::scope) {
            scopes.push_back(head);
        } else if (!head.empty()) {
            const bool hidden = std::find(scopes.begin(), scopes.end(), "namespace") != scopes.end();
            const std::string name = hidden ? "" : function_name(head);
            if (!name.empty()) functions.push_back({(scopes.empty() ? "" : class_of(scopes.back())) + name, c == '{'});
            if (c == '{') i = closing_brace(code, i);
        }
        begin = i + 1;
    }
    return functions;
}

std::vector<ClassSize> classes_of(const std::string& text) {
    const std::string code = code_only(text);
    std::vector<ClassSize> classes(1);
    std::vector<std::size_t> scopes{0};  // index into classes; 0: a namespace
    std::size_t begin = 0;               // of the head
    for (std::size_t i = 0; i < code.size(); ++i) {
        const char c = code[i];
        if (c != ';' && c != '{' && c != '}') continue;
        if (c == '}' && scopes.size() > 1) scopes.pop_back();
        const std::string head = c == '}' ? "" : one_line(plain_head(one_line(code.substr(begin, i - begin))));
        if (c == '{' && kind_of(head) == Block::scope) {
            const std::string name = class_of(head);
            scopes.push_back(name.empty() ? 0 : classes.size());
            if (!name.empty()) classes.push_back({name.substr(0, name.size() - 2), line_of(code, i), bases_of(head), {}});
        } else if (!head.empty()) {
            ClassSize& inside = classes[scopes.back()];
            if (std::string method = method_name(head, inside.name); !method.empty()) inside.methods.push_back(std::move(method));
            if (c == '{') i = closing_brace(code, i);
        }
        begin = i + 1;
    }
    classes.erase(classes.begin());
    return classes;
}

}  // namespace cvtflow::architecture
