#include "tasks/batch/sweep/scalar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "engine/base/text.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::string_view reductions[] = {"mean", "min", "max", "rms", "final", "at", "median"};

/// Letters and digits; every run of others one underscore.
std::string column_name(std::string_view text) {
    std::string name;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (plain)
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    while (!name.empty() && name.back() == '_') name.pop_back();
    return name;
}

/// Reads one term; every way to be wrong is a message.
class TermReader {
public:
    explicit TermReader(const std::string& text) {
        std::istringstream words(text);
        words >> written_ >> how_;
        name_ = written_;
        for (std::string word; words >> word;) when_ += (when_.empty() ? "" : " ") + word;
    }

    /// As written, white space tidied.
    [[nodiscard]] std::string text() const { return written_ + (how_.empty() ? "" : " " + how_) + (when_.empty() ? "" : " " + when_); }

    /// Defect of the text; empty: none.
    std::string read(ScalarTerm& out) {
        std::string wrong = read_element();
        if (wrong.empty()) wrong = read_channel();
        if (wrong.empty()) wrong = read_reduction();
        if (wrong.empty()) wrong = read_time();
        if (wrong.empty()) out = term_;
        return wrong;
    }

private:
    std::string read_element() {
        const auto bracket = name_.find('[');
        if (bracket == std::string::npos) return {};
        indexed_ = true;
        if (name_.substr(bracket) == "[*]") {
            term_.element = every_element;
        } else {
            const char* end = name_.data() + name_.size();
            const auto [stop, error] = std::from_chars(name_.data() + bracket + 1, end, term_.element);
            if (error != std::errc() || std::string_view(stop, end) != "]" || term_.element < 0)
                return fmt::format("{} is not a channel's element such as links/tension[0] or links/tension[*]", name_);
        }
        name_.resize(bracket);
        return {};
    }

    std::string read_channel() {
        std::vector<std::string> names;
        for (const Channel& channel : channels()) {
            names.emplace_back(channel.name);
            if (channel.name == name_) term_.channel = &channel;
        }
        if (term_.channel == nullptr)
            return fmt::format("unknown channel {}{}", toml_text(name_), engine::did_you_mean(engine::closest(name_, names)));
        const bool several = !term_.channel->axis.empty();
        if (several != indexed_)
            return several ? fmt::format("{0} has several numbers; write {0}[0] … or {0}[*] for all of them", name_)
                           : fmt::format("{} is a scalar without elements", name_);
        return {};
    }

    std::string read_reduction() {
        const auto found = std::find(std::begin(reductions), std::end(reductions), how_);
        if (found == std::end(reductions)) {
            const std::string near = engine::closest(how_, {std::begin(reductions), std::end(reductions)});
            return fmt::format("{} is not one of {}{}", toml_text(how_), fmt::join(reductions, ", "), engine::did_you_mean(near));
        }
        term_.reduction = static_cast<Reduction>(found - std::begin(reductions));
        const bool one_output = term_.reduction == Reduction::final || term_.reduction == Reduction::at;
        if (one_output && term_.element == every_element)
            return fmt::format("{} belongs to one output; name an element of {}", how_, name_);
        return {};
    }

    std::string read_time() {
        if (term_.reduction != Reduction::at) return when_.empty() ? "" : fmt::format("{} has no time argument", how_);
        const auto parsed = parse_quantity(when_);
        const auto* quantity = std::get_if<Quantity>(&parsed);
        if (quantity == nullptr || !(quantity->dimension == dimension_of("s")) || !quantity->has_unit)
            return fmt::format("{} is not a time", toml_text(when_));
        term_.time = quantity->value;
        return {};
    }

    std::string written_, how_, when_;  ///< the channel with its element, the reduction, the time
    std::string name_;                  ///< of the channel
    bool indexed_ = false;
    ScalarTerm term_;
};

/// Between the terms of a quotient; channels have slashes without spaces.
constexpr std::string_view divided_by = " / ";

}  // namespace

std::string Scalar::unit() const {
    const std::string_view over = terms.front().channel->unit;
    if (terms.size() == 1) return std::string(over);
    const std::string_view under = terms.back().channel->unit;
    return over == under ? "1" : under == "1" ? std::string(over) : fmt::format("{}/{}", over, under);
}

std::string Scalar::description() const {
    if (terms.size() == 1) return fmt::format("{}: {}", text, terms.front().channel->description);
    return fmt::format("{}: {} over {}", text, terms.front().channel->description, terms.back().channel->description);
}

bool Scalar::averages() const noexcept {
    return std::ranges::all_of(
        terms, [](const ScalarTerm& term) { return term.reduction == Reduction::mean || term.reduction == Reduction::rms; });
}

Scalar parse_scalar(const std::string& text, Position position, std::vector<Problem>& problems) {
    Scalar scalar;
    std::string rest = text;
    for (bool more = true; more;) {
        const auto at = rest.find(divided_by);
        more = at != std::string::npos;
        TermReader reader(rest.substr(0, at));
        ScalarTerm term;
        std::string wrong = reader.read(term);
        if (wrong.empty() && scalar.terms.size() == 2) wrong = "a quotient has two parts";
        if (!wrong.empty()) {
            problems.push_back({position, fmt::format("outputs.scalars: {}: {}", toml_text(text), wrong)});
            return {};
        }
        scalar.terms.push_back(term);
        scalar.text += (scalar.text.empty() ? "" : std::string(divided_by)) + reader.text();
        if (more) rest = rest.substr(at + divided_by.size());
    }
    scalar.column = column_name(scalar.text);
    return scalar;
}

void TermSum::add(const ScalarTerm& term, double time, double number) {
    switch (term.reduction) {
        case Reduction::mean: value += number; break;
        case Reduction::rms: value += number * number; break;
        case Reduction::min: value = count == 0 || number < value || std::isnan(number) ? number : value; break;
        case Reduction::max: value = count == 0 || number > value || std::isnan(number) ? number : value; break;
        case Reduction::final: value = number; break;
        case Reduction::median: all.push_back(number); break;
        case Reduction::at:
            if (time < term.time * (1.0 - 1e-12) || count > 0) return;
            value = number;
            break;
    }
    ++count;
}

void TermSum::add(const ScalarTerm& term, const TermSum& later) {
    if (later.count == 0) return;
    const long before = count;
    switch (term.reduction) {
        case Reduction::mean:
        case Reduction::rms: value += later.value; break;
        case Reduction::median: all.insert(all.end(), later.all.begin(), later.all.end()); break;
        case Reduction::at: value = before > 0 ? value : later.value; break;
        default: add(term, 0.0, later.value); break;
    }
    count = before + later.count;
}

double TermSum::result(const ScalarTerm& term) const {
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    const double n = static_cast<double>(count);
    if (term.reduction == Reduction::mean) return value / n;
    if (term.reduction != Reduction::median) return term.reduction == Reduction::rms ? std::sqrt(value / n) : value;
    std::vector<double> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t middle = sorted.size() / 2;
    return sorted.size() % 2 != 0 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

void Reducer::add(const Scalar& scalar, std::size_t term, double time, std::span<const double> numbers) {
    const ScalarTerm& of = scalar.terms[term];
    const bool one_output = of.reduction == Reduction::final || of.reduction == Reduction::at;
    if (of.channel->is(Channel::may_be_undefined) && !one_output && std::isnan(numbers[0])) return;  // such channels have one number
    if (of.element != every_element) return sums[term].add(of, time, numbers[static_cast<std::size_t>(of.element)]);
    for (const double number : numbers) sums[term].add(of, time, number);
}

void Reducer::add(const Scalar& scalar, const Reducer& later) {
    for (std::size_t term = 0; term < scalar.terms.size(); ++term) sums[term].add(scalar.terms[term], later.sums[term]);
}

double Reducer::result(const Scalar& scalar) const {
    const double first = sums[0].result(scalar.terms[0]);
    return scalar.terms.size() == 1 ? first : first / sums[1].result(scalar.terms[1]);
}

void Reducer::clear() noexcept {
    for (TermSum& sum : sums) {
        sum.count = 0;
        sum.value = 0.0;
        sum.all.clear();
    }
}

void Reducer::save(std::vector<double>& memory) const {
    for (const TermSum& sum : sums) {
        memory.insert(memory.end(), {static_cast<double>(sum.count), sum.value, static_cast<double>(sum.all.size())});
        memory.insert(memory.end(), sum.all.begin(), sum.all.end());
    }
}

std::span<const double> Reducer::load(std::span<const double> memory) {
    constexpr int most = std::numeric_limits<int>::max();
    for (TermSum& sum : sums) {
        sum.count = pop_integer(memory, 0, most);
        sum.value = pop_front(memory, 1)[0];
        const auto numbers = pop_front(memory, static_cast<std::size_t>(pop_integer(memory, 0, most)));
        sum.all.assign(numbers.begin(), numbers.end());
    }
    return memory;
}

}  // namespace cvtflow::tasks
