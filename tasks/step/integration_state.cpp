#include "tasks/step/integration_state.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

namespace {

constexpr std::int64_t max_count = std::int64_t{1} << 53U;  // up to here a double holds every count exactly

/// Energies, then temperatures.
void visit_sums(Workspace& w, engine::Archive& archive) {
    w.energy.visit(archive);
    w.heat.visit(archive);
    if (!w.heat.valid()) archive.refuse("temperature_oil");
}

}  // namespace

/// What a start needs comes first.
void IntegrationState::visit(engine::Archive& archive) {
    archive("time", time), archive("state", state), archive("phases", phases);
    archive("started", started), archive("settling", settling), archive("begin", begin), archive("output_interval", output_interval);
    archive("step", step), archive("grid_number", grid_number), archive("grid_steps", grid_steps), archive("outputs", outputs);
    visit_counters(counters, archive);
    archive("changed", changed), archive("before", before);
    archive("settling_error_ratio", settling_balance_error_ratio), archive("settling_residual", settling_residual);
    held.visit(archive);
    archive("energy", energy), archive("method", method);
}

const char* IntegrationState::invalid_reason() const noexcept {
    bool counts = true;
    const auto check = [&counts](const char* /*name*/, long count) { counts = counts && count >= 0 && count <= max_count; };
    visit_counters(counters, check);
    for (const long count : {grid_number, grid_steps, outputs}) check("", count);
    if (!counts) return "it contains an invalid count";
    if (std::any_of(phases.begin(), phases.end(), [](model::Phase phase) { return phase > model::Phase::slip; }))
        return "it contains an invalid tip phase";
    if (!std::isfinite(time)) return "its time is not finite";
    for (const model::ReferenceAngle& from : held.reference)
        if (!std::isfinite(from.since + from.angle + from.zero)) return "its couplings have no valid reference";
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

void write_sums(Workspace& w, std::vector<std::byte>& fields) {
    engine::write_fields(fields, [&w](auto& archive) { visit_sums(w, archive); });
}

void read_sums(Workspace& w, std::span<const std::byte> fields) {
    if (!fields.empty()) engine::read_fields(fields, [&w](auto& archive) { visit_sums(w, archive); });
}

}  // namespace cvtflow::tasks
