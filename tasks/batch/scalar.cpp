#include "tasks/batch/scalar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "tasks/scene/spelling.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::string_view reductions[] = {"mean", "min", "max", "rms", "final", "at"};

/// Letters and digits; every run of others one underscore.
std::string column_name(std::string_view text) {
    std::string name;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (plain) name += c;
        else if (!name.empty() && name.back() != '_') name += '_';
    }
    while (!name.empty() && name.back() == '_') name.pop_back();
    return name;
}

/// Reads one scalar; every way to be wrong is a message.
class ScalarReader {
public:
    explicit ScalarReader(const std::string& text) {
        std::istringstream words(text);
        std::string rest;
        words >> name_ >> how_;
        for (std::string word; words >> word;) when_ += (when_.empty() ? "" : " ") + word;
        scalar_.text = name_ + (how_.empty() ? "" : " " + how_) + (when_.empty() ? "" : " " + when_);
        scalar_.column = column_name(scalar_.text);
    }

    /// What is wrong, or nothing.
    std::string read(Scalar& out) {
        std::string wrong = read_element();
        if (wrong.empty()) wrong = read_channel();
        if (wrong.empty()) wrong = read_reduction();
        if (wrong.empty()) wrong = read_time();
        if (wrong.empty()) out = scalar_;
        return wrong;
    }

private:
    std::string read_element() {
        const auto bracket = name_.find('[');
        if (bracket == std::string::npos) return {};
        const char* end = name_.data() + name_.size();
        const auto [stop, error] = std::from_chars(name_.data() + bracket + 1, end, scalar_.element);
        if (error != std::errc() || std::string_view(stop, end) != "]" || scalar_.element < 0) return fmt::format("{} is not a channel's element such as links/tension[0]", name_);
        name_.resize(bracket);
        indexed_ = true;
        return {};
    }

    std::string read_channel() {
        std::vector<std::string> names;
        for (const Channel& channel : channels()) {
            names.emplace_back(channel.name);
            if (channel.name == name_) scalar_.channel = &channel;
        }
        if (scalar_.channel == nullptr) return fmt::format("there is no channel {}{}", toml_text(name_), did_you_mean(closest(name_, names)));
        const bool several = !scalar_.channel->axis.empty();
        if (several != indexed_) return several ? fmt::format("{0} has several numbers; write {0}[0] …", name_) : fmt::format("{} has one number, no element {}", name_, scalar_.element);
        return {};
    }

    std::string read_reduction() {
        const auto found = std::find(std::begin(reductions), std::end(reductions), how_);
        if (found == std::end(reductions)) {
            const std::string near = closest(how_, {std::begin(reductions), std::end(reductions)});
            return fmt::format("{} is not one of {}{}", toml_text(how_), fmt::join(reductions, ", "), did_you_mean(near));
        }
        scalar_.reduction = static_cast<Reduction>(found - std::begin(reductions));
        return {};
    }

    std::string read_time() {
        if (scalar_.reduction != Reduction::at) return when_.empty() ? "" : fmt::format("{} takes no time", how_);
        const auto parsed = parse_quantity(when_);
        const auto* quantity = std::get_if<Quantity>(&parsed);
        if (quantity == nullptr || !(quantity->dimension == dimension_of("s")) || !quantity->has_unit) return fmt::format("{} is not a time", toml_text(when_));
        scalar_.time = quantity->value;
        return {};
    }

    std::string name_, how_, when_;
    bool indexed_ = false;
    Scalar scalar_;
};

}  // namespace

Scalar parse_scalar(const std::string& text, Position position, std::vector<Problem>& problems) {
    Scalar scalar;
    const std::string wrong = ScalarReader(text).read(scalar);
    if (!wrong.empty()) problems.push_back({position, fmt::format("outputs.scalars: {}: {}", toml_text(text), wrong)});
    return scalar;
}

void Reducer::add(const Scalar& scalar, double time, double number) noexcept {
    switch (scalar.reduction) {
        case Reduction::mean: value += number; break;
        case Reduction::rms: value += number * number; break;
        case Reduction::min: value = count == 0 || number < value || std::isnan(number) ? number : value; break;
        case Reduction::max: value = count == 0 || number > value || std::isnan(number) ? number : value; break;
        case Reduction::final: value = number; break;
        case Reduction::at:
            if (time < scalar.time * (1.0 - 1e-12) || count > 0) return;
            value = number;
            break;
    }
    ++count;
}

double Reducer::result(const Scalar& scalar) const noexcept {
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    const double n = static_cast<double>(count);
    if (scalar.reduction == Reduction::mean) return value / n;
    return scalar.reduction == Reduction::rms ? std::sqrt(value / n) : value;
}

}  // namespace cvtflow::tasks
