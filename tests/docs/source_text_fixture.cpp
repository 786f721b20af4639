#include "tests/docs/source_text_fixture.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace cvtflow::docs {
namespace {

namespace fs = std::filesystem;

bool is_in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Words of a name: "StepGraph", "step_graph_" → "step graph".
std::string words_of(std::string_view name) {
    std::string words;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const auto c = static_cast<unsigned char>(name[i]);
        const bool begins = std::isupper(c) != 0 && i > 0 && std::isupper(static_cast<unsigned char>(name[i - 1])) == 0;
        const bool word = begins || (i > 0 && name[i - 1] == '_');
        if (c == '_') continue;
        if (word && !words.empty()) words += ' ';
        words += static_cast<char>(std::tolower(c));
    }
    return words;
}

/// Removes code between backticks, and the space at both ends.
std::string comment_text(std::string_view text) {
    std::string kept;
    bool code = false;
    for (const char c : text) {
        if (!code && c != '`') kept += c;
        if (c == '`') code = !code;
    }
    const std::size_t begin = std::min(kept.find_first_not_of(' '), kept.size());
    return kept.substr(begin, kept.find_last_not_of(' ') + 1 - begin);
}

class Scanner {
public:
    explicit Scanner(std::string_view source) : source_(source) {}

    std::vector<SourceText> scan() {
        while (at_ < source_.size()) step();
        for (auto& [name, line] : names_) texts_.push_back({Place::name, line, words_of(name)});
        return std::move(texts_);
    }

private:
    void step() {
        const char c = source_[at_];
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (!space && !begins("//") && c != '"') joins_ = false;
        if (begins("//") || (c == '#' && line_is_empty_)) return comment();
        if (begins("/*")) return skip(source_.find("*/", at_) + 2);
        if (begins("R\"")) return raw_literal();
        if (c == '"') return literal('"');
        if (c == '\'') return literal('\'');
        if (is_in_name(c)) return name();
        if (c == '\n') ++line_;
        line_is_empty_ = c == '\n' || (line_is_empty_ && space);
        ++at_;
    }

    /// A comment of one line; a preprocessor line is skipped alike.
    void comment() {
        if (begins("///<") != std::exchange(after_code_, begins("///<"))) joins_ = false;
        const std::size_t begin = std::min(source_.find_first_not_of("/<", at_), source_.size());
        const std::size_t end = std::min(source_.find('\n', at_), source_.size());
        if (source_[at_] != '#') add(Place::comment, comment_text(source_.substr(std::min(begin, end), end - std::min(begin, end))), " ");
        skip(end);
    }

    void literal(char quote) {
        std::string text;
        std::size_t end = at_ + 1;
        for (; end < source_.size() && source_[end] != quote; ++end) {
            const bool escape = source_[end] == '\\';
            text += escape ? ' ' : source_[end];
            if (escape) ++end;
        }
        if (quote == '"') add(Place::literal, text, "");
        skip(end + 1);
    }

    void raw_literal() {
        const std::size_t open = source_.find('(', at_);
        const std::string close = ")" + std::string(source_.substr(at_ + 2, open - at_ - 2)) + "\"";
        const std::size_t end = source_.find(close, open);
        add(Place::literal, std::string(source_.substr(open + 1, end - open - 1)), "");
        skip(end + close.size());
    }

    /// A name or a number, whose digit separators are no quotes.
    void name() {
        const std::size_t begin = at_;
        const bool number = std::isdigit(static_cast<unsigned char>(source_[at_])) != 0;
        while (at_ < source_.size() && (is_in_name(source_[at_]) || (number && source_[at_] == '\''))) ++at_;
        line_is_empty_ = false;
        if (!number) names_.try_emplace(std::string(source_.substr(begin, at_ - begin)), line_);
    }

    /// Appends to the text before if only space is between them.
    void add(Place place, const std::string& text, const char* between) {
        const bool joined = joins_ && !texts_.empty() && texts_.back().place == place;
        if (joined) texts_.back().text += between + text;
        if (!joined) texts_.push_back({place, line_, text});
        joins_ = true;
    }

    [[nodiscard]] bool begins(std::string_view what) const { return source_.substr(at_, what.size()) == what; }

    void skip(std::size_t end) {
        end = std::min(end, source_.size());
        line_ += static_cast<int>(std::count(source_.begin() + static_cast<long>(at_), source_.begin() + static_cast<long>(end), '\n'));
        at_ = end;
        line_is_empty_ = false;
    }

    std::string_view source_;
    std::size_t at_ = 0;
    int line_ = 1;
    bool line_is_empty_ = true, joins_ = false, after_code_ = false;
    std::vector<SourceText> texts_;
    std::map<std::string, int> names_;
};

}  // namespace

std::vector<SourceText> texts_of(std::string_view source) { return Scanner(source).scan(); }

std::map<std::string, std::string> sources() {
    const fs::path top = CVTFLOW_SOURCE_DIR;
    std::map<std::string, std::string> found;
    for (const char* folder : {"model", "engine", "tasks", "api", "tools", "bench", "tests"}) {
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".cpp" && extension != ".hpp" && extension != ".c" && extension != ".h") continue;
            std::ifstream file(entry.path());
            found[entry.path().lexically_relative(top).generic_string()] = {std::istreambuf_iterator<char>(file), {}};
        }
    }
    return found;
}

}  // namespace cvtflow::docs
