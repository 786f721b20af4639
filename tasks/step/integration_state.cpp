#include "tasks/step/integration_state.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/hash.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::int64_t max_count = std::int64_t{1} << 53;  // up to here a double holds every count exactly

/// Reason why a field is invalid by itself.
struct FieldCheck {
    const char* reason = nullptr;

    void operator()(const char* /*name*/, long count) {
        if (count < 0 || count > max_count) reason = "it contains an invalid count";
    }
    void operator()(const char* /*name*/, const std::vector<model::Phase>& phases) {
        if (std::any_of(phases.begin(), phases.end(), [](model::Phase phase) { return phase > model::Phase::slip; }))
            reason = "it contains an invalid tip phase";
    }
    template <class Field>
    void operator()(const char* /*name*/, const Field& /*field*/) {}
};

/// Adds fields to a hash.
struct FieldHash {
    engine::Hash hash;

    void operator()(const char* /*name*/, bool flag) { hash.add(static_cast<std::uint64_t>(flag)); }
    void operator()(const char* /*name*/, long count) { hash.add(static_cast<std::uint64_t>(count)); }
    void operator()(const char* /*name*/, double number) { hash.add(std::span<const double>(&number, 1)); }
    void operator()(const char* /*name*/, const std::vector<double>& numbers) { hash.add(std::span<const double>(numbers)); }
    void operator()(const char* /*name*/, const std::vector<model::Phase>& phases) {
        hash.add(std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(phases.data()), phases.size()));
    }
    void operator()(const char* /*name*/, const std::vector<model::TipIndicator>& tips) {
        for (const model::TipIndicator& tip : tips) {
            const double pair[] = {tip.depth, tip.slip};
            hash.add(std::span<const double>(pair));
        }
    }
};

}  // namespace

const char* IntegrationState::invalid_reason() const noexcept {
    FieldCheck check;
    visit_fields(*this, check);
    if (check.reason != nullptr) return check.reason;
    if (!std::isfinite(time)) return "its time is not finite";
    const auto finite = [](double value) { return std::isfinite(value); };
    if ((!couplings.empty() && couplings.size() != 6 && couplings.size() != 10) || !std::all_of(couplings.begin(), couplings.end(), finite))
        return "its couplings have no valid reference";
    if (!started) return nullptr;
    const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
    if (!std::isfinite(begin) || !is_length(output_interval) || !(std::isfinite(step) && step >= 0.0) || grid_steps == 0)
        return "its step or output interval is invalid";
    if (!(static_cast<double>(outputs + 2) * std::max({1.0, static_cast<double>(grid_steps), step > 0.0 ? output_interval / step : 1.0}) <=
          static_cast<double>(max_count)))
        return "it has too many steps to count";
    if (std::abs(time - begin - static_cast<double>(outputs) * output_interval) > 2.0 * output_interval + 1e-6 * std::abs(time))
        return "its outputs do not fit its time";
    return nullptr;
}

std::uint64_t IntegrationState::hash() const noexcept {
    FieldHash fields;
    visit_fields(*this, fields);
    return fields.hash.value();
}

}  // namespace cvtflow::tasks
