#include "tasks/scene/toml/toml_limits.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/input_file.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int max_parts = 32, deepest = 32, longest_key = 256;

/// Walks through a document outside of its texts and comments.
class Walk {
public:
    explicit Walk(const std::string& text) : text_(text) {}

    std::optional<Problem> excess() {
        for (at_ = 0; at_ < text_.size(); ++at_) {
            step(text_[at_]);
            if (dots_ >= max_parts) return here(fmt::format("not valid TOML: a key of more than {} parts", max_parts));
            if (depth_ > deepest) return here(fmt::format("not valid TOML: values nested more than {} deep", deepest));
            if (length_ > longest_key) return here(fmt::format("not valid TOML: a key or number of more than {} characters", longest_key));
        }
        return {};
    }

private:
    void step(char c) {
        if (c == '"' || c == '\'') {
            skip_text(c);
            length_ = 0;
            return;
        }
        if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
        const bool word = c == '_' || c == '-' || c == '+' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                          (c & 0x80) != 0;
        length_ = word ? length_ + 1 : 0;
        if (c == '[' || c == '{') ++depth_;
        if (c == ']' || c == '}') --depth_;
        if (c == '\n' && depth_ < 0) depth_ = 0;
        if (c == '.')
            ++dots_;
        else if (!word && c != ' ' && c != '\t')
            dots_ = 0;
    }

    /// To the last quote of a text, of one line or several.
    void skip_text(char quote) {
        const std::string three(3, quote);
        const bool lines = text_.compare(at_, 3, three) == 0;
        at_ += lines ? 3 : 1;
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\\' && quote == '"')
                ++at_;
            else if (lines ? text_.compare(at_, 3, three) == 0 : text_[at_] == quote)
                break;
            else if (!lines && text_[at_] == '\n')
                return;  // not closed: an error of its own
        }
        if (lines) at_ += 2;
    }

    /// Present position of the scan.
    [[nodiscard]] Problem here(std::string message) const {
        const std::size_t begin = at_ == 0 ? std::string::npos : text_.rfind('\n', at_ - 1);
        const std::size_t line = begin == std::string::npos ? 0 : begin + 1;
        const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(line), '\n');
        return {{static_cast<int>(lines) + 1, static_cast<int>(at_ - line) + 1}, std::move(message)};
    }

    const std::string& text_;
    std::size_t at_ = 0;
    int dots_ = 0, depth_ = 0, length_ = 0;
};

}  // namespace

std::optional<Problem> beyond_limits(const std::string& text) {
    if (text.size() > longest_toml) return Problem{{}, fmt::format("not valid TOML: longer than {} bytes", longest_toml)};
    return Walk(text).excess();
}

std::string read_toml_text(const std::filesystem::path& path) {
    try {
        return engine::read_text_input(path.string(), longest_toml);
    } catch (const engine::InputError& reason) {
        throw SceneError(fmt::format("{}: cannot be read: {}", path.string(), reason.what()));
    }
}

}  // namespace cvtflow::tasks
