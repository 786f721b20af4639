#include "tasks/batch/sweep/scalar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "engine/base/text.hpp"
#include "tasks/run/mean_curve.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

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

namespace {

constexpr std::string_view reductions[] = {"mean", "min", "max", "rms", "final", "at", "median"};

/// Reads one term; every way to be wrong is a message.
class TermReader {
public:
    explicit TermReader(const std::string& text) {
        std::istringstream words(text);
        words >> written_ >> how_;
        name_ = written_;
        for (std::string word; words >> word;) when_ += (when_.empty() ? "" : " ") + word;
    }

    /// Text of the scalar, white space tidied.
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
        for (const Channel& channel : channels()) {
            if (channel.name == name_) term_.channel = &channel;
        }
        if (term_.channel == nullptr) return fmt::format("unknown channel {}{}", toml_text(name_), channel_hint(name_));
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
        if (term_.reduction != Reduction::mean || term_.element != 0) return {};
        term_.integral = term_.channel->sums();
        term_.quotient = term_.integral != nullptr;
        if (!term_.quotient) term_.integral = term_.channel->integral();
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
    std::string name_;                  ///< name of the channel
    bool indexed_ = false;
    ScalarTerm term_;
};

/// Separates the terms of a quotient; channels have slashes without spaces.
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

bool Scalar::averages() const noexcept { return std::ranges::all_of(terms, &ScalarTerm::over_time); }

bool Scalar::is(std::string_view channel) const noexcept { return terms.size() == 1 && terms[0].channel->name == channel; }

double Scalar::error_scale(double value) const noexcept {
    const bool efficiency = is("efficiency") && terms[0].reduction == Reduction::mean;
    return efficiency ? std::max(share_of_efficiency, 1.0 - value) : std::abs(value);
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

bool TermSum::takes(const ScalarTerm& term, double instant, const Occasion& when) const noexcept {
    if (term.over_time()) return when.sample;
    if (term.reduction == Reduction::final) return when.last;
    return when.output && (term.reduction != Reduction::at || (count == 0 && instant >= term.time * (1.0 - 1e-12)));
}

/// Adds an interval by the trapezoidal rule if both its ends have a number.
void TermSum::integrate(const ScalarTerm& term, double instant, double number) noexcept {
    const bool undefined = term.channel->is(Channel::may_be_undefined) && (std::isnan(number) || std::isnan(last));
    if (count > 0 && !undefined) {
        value += term.integral != nullptr ? number - last : 0.5 * (instant - time) * (number + last);
        span += instant - time;
    }
    time = instant;
    last = number;
    ++count;
}

void TermSum::add_sums(double instant, std::span<const double> sums) {
    const bool first = count++ == 0;
    all.resize(2 * sums.size());
    for (std::size_t k = 0; k < sums.size(); ++k) {
        all[k] += first ? 0.0 : sums[k] - all[sums.size() + k];
        all[sums.size() + k] = sums[k];
    }
    span += first ? 0.0 : instant - time;
    time = instant;
}

void TermSum::add(const ScalarTerm& term, double instant, double number) {
    switch (term.reduction) {
        case Reduction::mean:
        case Reduction::rms: return integrate(term, instant, term.reduction == Reduction::rms ? number * number : number);
        case Reduction::min: value = count == 0 || number < value || std::isnan(number) ? number : value; break;
        case Reduction::max: value = count == 0 || number > value || std::isnan(number) ? number : value; break;
        case Reduction::final: value = number; break;
        case Reduction::median: all.push_back(number); break;
        case Reduction::at:
            if (instant < term.time * (1.0 - 1e-12) || count > 0) return;
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
        case Reduction::rms:
            value += later.value;
            span += later.span;
            time = later.time;
            last = later.last;
            all.resize(later.all.size());
            for (std::size_t k = 0; k < all.size(); ++k) all[k] = 2 * k < all.size() ? all[k] + later.all[k] : later.all[k];
            break;
        case Reduction::median: all.insert(all.end(), later.all.begin(), later.all.end()); break;
        case Reduction::at: value = before > 0 ? value : later.value; break;
        default: add(term, 0.0, later.value); break;
    }
    count = before + later.count;
}

TermSum TermSum::continued(const ScalarTerm& term) const {
    TermSum later;
    if (!term.over_time() || count == 0) return later;
    later.count = 1;
    later.time = time;
    later.last = last;
    if (term.quotient) {
        later.all = all;
        std::fill_n(later.all.begin(), all.size() / 2, 0.0);
    }
    return later;
}

void TermSum::begin_at(const ScalarTerm& term, double begin, const TermSum& before, const TermSum& after) noexcept {
    if (!term.over_time() || count == 0) return;
    const double apart = after.time - before.time, share = apart > 0.0 ? (begin - before.time) / apart : 0.0;
    const auto there = [share](double at_before, double at_after) { return at_before + share * (at_after - at_before); };
    value -= there(before.value, after.value);
    span -= there(before.span, after.span);
    for (std::size_t k = 0; term.quotient && 2 * k < all.size(); ++k) all[k] -= there(before.all[k], after.all[k]);
}

double TermSum::result(const ScalarTerm& term) const {
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    if (term.quotient) return quotient_of(std::span(all).first(all.size() / 2));
    if (term.over_time()) {
        const double instant = term.integral == nullptr ? last : std::numeric_limits<double>::quiet_NaN();
        const double mean = span > 0.0 ? value / span : instant;
        return term.reduction == Reduction::rms ? std::sqrt(mean) : mean;
    }
    if (term.reduction != Reduction::median) return value;
    std::vector<double> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t middle = sorted.size() / 2;
    return sorted.size() % 2 != 0 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

bool Reducer::needs_chain(const Scalar& scalar, double time, const Occasion& when, const Counters& counters) const noexcept {
    for (std::size_t term = 0; term < scalar.terms.size(); ++term) {
        const ScalarTerm& of = scalar.terms[term];
        if (sums[term].takes(of, time, when) && of.source().needs_chain(counters)) return true;
    }
    return false;
}

void Reducer::read(const Scalar& scalar, const Instant& now, const Occasion& when, std::vector<double>& memory) {
    for (std::size_t term = 0; term < scalar.terms.size(); ++term) {
        const ScalarTerm& of = scalar.terms[term];
        if (!sums[term].takes(of, now.observation.time, when)) continue;
        const int width = of.source().width(now.workspace.variator.chain());
        if (of.element >= width) throw SimulationError(fmt::format("{}: the channel has only {} elements", scalar.text, width));
        memory.resize(std::max(memory.size(), static_cast<std::size_t>(width)));
        of.source().read(now, memory.data());
        add(scalar, term, now.observation.time, {memory.data(), static_cast<std::size_t>(width)});
    }
}

void Reducer::add(const Scalar& scalar, std::size_t term, double time, std::span<const double> numbers) {
    const ScalarTerm& of = scalar.terms[term];
    if (of.quotient) return sums[term].add_sums(time, numbers);
    const bool one_output = of.reduction == Reduction::final || of.reduction == Reduction::at;
    if (of.over_time() && of.element == every_element) {
        const bool squares = of.reduction == Reduction::rms;
        double sum = 0.0;
        for (const double number : numbers) sum += squares ? number * number : number;
        return sums[term].integrate(of, time, sum / static_cast<double>(numbers.size()));
    }
    const bool left_out = of.channel->is(Channel::may_be_undefined) && !one_output && !of.over_time();
    if (left_out && std::isnan(numbers[0])) return;  // such channels have one number
    if (of.element != every_element) return sums[term].add(of, time, numbers[static_cast<std::size_t>(of.element)]);
    for (const double number : numbers) sums[term].add(of, time, number);
}

void Reducer::add(const Scalar& scalar, const Reducer& later) {
    for (std::size_t term = 0; term < scalar.terms.size(); ++term) sums[term].add(scalar.terms[term], later.sums[term]);
}

Reducer Reducer::continued(const Scalar& scalar) const {
    Reducer later;
    for (std::size_t term = 0; term < scalar.terms.size(); ++term) later.sums[term] = sums[term].continued(scalar.terms[term]);
    return later;
}

void Reducer::begin_at(const Scalar& scalar, double begin, const Reducer& before, const Reducer& after) noexcept {
    for (std::size_t term = 0; term < scalar.terms.size(); ++term)
        sums[term].begin_at(scalar.terms[term], begin, before.sums[term], after.sums[term]);
}

double Reducer::result(const Scalar& scalar) const {
    const double first = sums[0].result(scalar.terms[0]);
    return scalar.terms.size() == 1 ? first : first / sums[1].result(scalar.terms[1]);
}

void Reducer::clear() noexcept {
    for (TermSum& sum : sums) {
        sum.count = 0;
        sum.value = sum.span = sum.time = sum.last = 0.0;
        sum.all.clear();
    }
}

}  // namespace cvtflow::tasks
