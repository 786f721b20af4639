#include "model/machine/heat_balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cvtflow::model {

void HeatBalance::restart(const Parameters& parameters, bool steady) noexcept {
    constexpr double settles = 3e-3;  // time constant of one capacity in a search for steady temperatures; of both together 8 ms [s]
    heat_ = parameters.heat;
    const double conductance = std::min(heat_.pulley_conductance, heat_.ambient_conductance);  // without one nothing is steady
    if (steady && conductance > 0.0)
        for (double* capacity : {&heat_.pulley_capacity, &heat_.oil_capacity}) *capacity = std::min(*capacity, settles * conductance);
    start_ = parameters.oil.temperature;
    m_ = {};
    m_.time = -1.0;
    m_.pulleys = m_.oil = start_;
}

/// Backward Euler, so that steps may be longer than a time constant, with temperatures at the end of the step in every flow: the heat of
/// the losses is stored or has gone to ambient, to rounding.
void HeatBalance::advance(double time, const std::array<double, loss_kinds>& lost) noexcept {
    if (!heat_.enabled) return;
    const double all = std::accumulate(lost.begin(), lost.end(), 0.0);
    const double tips = lost[static_cast<std::size_t>(Loss::tip_friction)] + lost[static_cast<std::size_t>(Loss::tip_damping)];
    const double heat_tips = tips - m_.lost_by_tips, heat_else = all - tips - m_.lost_else, dt = time - m_.time;
    const bool runs = m_.time >= 0.0 && dt > 0.0;
    m_.time = time;
    m_.lost_by_tips = tips;
    m_.lost_else = all - tips;
    if (!runs) return;
    const double exchange = dt * heat_.pulley_conductance, loss = dt * heat_.ambient_conductance;
    const double a = heat_.pulley_capacity + exchange, d = heat_.oil_capacity + exchange + loss;
    const double of_pulleys = heat_.pulley_capacity * m_.pulleys + heat_tips;
    const double of_oil = heat_.oil_capacity * m_.oil + heat_else + loss * heat_.ambient;
    const double determinant = a * d - exchange * exchange;
    m_.pulleys = (d * of_pulleys + exchange * of_oil) / determinant;
    m_.oil = (exchange * of_pulleys + a * of_oil) / determinant;
    m_.given += heat_tips + heat_else;
    m_.taken += loss * (m_.oil - heat_.ambient);
}

double HeatBalance::stored() const noexcept {
    return heat_.pulley_capacity * (m_.pulleys - start_) + heat_.oil_capacity * (m_.oil - start_);
}

bool HeatBalance::valid() const noexcept {
    return !heat_.enabled || (std::isfinite(m_.pulleys) && std::isfinite(m_.oil) && m_.pulleys > 0.0 && m_.oil > 0.0);
}

}  // namespace cvtflow::model
