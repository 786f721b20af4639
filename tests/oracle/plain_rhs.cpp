#include "tests/oracle/plain_rhs.hpp"

#include "tests/oracle/system.hpp"

#include <algorithm>

namespace cvtflow::oracle {

namespace {

Totals all_forces(const System& system) {
    Totals totals = empty_totals(system);
    if (system.layout.rigid) {
        add_rigid_pins(system, totals);
    } else {
        add_inner_elements(system, totals);
        add_plates(system, totals);
        add_joints(system, totals);
    }
    if (system.parameters.detail.pulleys == model::PulleyDetail::absent) return totals;
    if (!system.layout.rigid) add_tips(system, totals);
    add_guides(system, totals);
    add_supports(system, totals);
    add_gyroscopic(system, totals);
    add_inputs(system, totals);
    return totals;
}

/// One block of the slope: rates copied from the state, then accelerations.
void write_block(std::vector<Real>& slope, std::span<const Real> state, int begin, int size, std::span<const Real> acceleration) {
    for (int k = 0; k < size; ++k) {
        slope[begin + k] = state[begin + size + k];
        slope[begin + size + k] = acceleration[k];
    }
}

std::vector<Real> slope_of(const System& system, std::span<const Real> state, const Totals& totals, std::span<const Real> forces) {
    const auto& layout = system.layout;
    const auto acceleration = accelerations(system, forces);
    const std::span<const Real> all{acceleration};
    std::vector<Real> slope(layout.size(), 0.0L);
    const int size = layout.link_size();
    for (int i = 0; i < layout.links; ++i) write_block(slope, state, layout.link_begin(i), size, all.subspan(i * size, size));
    write_block(slope, state, layout.pulley_begin(), layout.pulley_size, all.subspan(layout.links * size));
    std::copy_n(totals.control_rate, layout.controls, slope.begin() + layout.control_begin());
    if (layout.ledger) {
        const auto works = std::copy(totals.powers.losses.begin(), totals.powers.losses.end(), slope.begin() + layout.ledger_begin());
        std::copy(totals.powers.works.begin(), totals.powers.works.end(), works);
    }
    return slope;
}

std::vector<double> rounded(std::span<const Real> values) {
    std::vector<double> result;
    for (const Real value : values) result.push_back(static_cast<double>(value));
    return result;
}

template <std::size_t n>
std::array<double, n> rounded(const std::array<Real, n>& values) {
    std::array<double, n> result;
    for (std::size_t k = 0; k < n; ++k) result[k] = static_cast<double>(values[k]);
    return result;
}

}  // namespace

ResultOf<Real> exact_right_hand_side(const model::Parameters& parameters, double t, std::span<const Real> state,
                                     std::span<const model::Phase> phases, bool with_slope, const FarEnds* far) {
    System system = unpack(parameters, t, state, phases);
    system.far = far;
    Totals totals = all_forces(system);
    totals.energies.kinetic = kinetic_energy(system, state);
    ResultOf<Real> result;
    result.forces = pack_forces(system, totals);
    if (with_slope) result.slope = slope_of(system, state, totals, result.forces);
    result.powers = totals.powers;
    result.energies = totals.energies;
    return result;
}

Result right_hand_side(const model::Parameters& parameters, double t, std::span<const double> state, std::span<const model::Phase> phases,
                       const FarEnds* far) {
    const std::vector<Real> exact_state(state.begin(), state.end());
    const auto exact = exact_right_hand_side(parameters, t, exact_state, phases, true, far);
    const auto& e = exact.energies;
    const auto round = [](Real value) { return static_cast<double>(value); };
    return {rounded(exact.slope),
            {rounded(exact.powers.losses), rounded(exact.powers.works)},
            {round(e.kinetic), round(e.inner), round(e.pack), round(e.plates), round(e.joints), round(e.tips), round(e.supports)},
            rounded(exact.forces)};
}

}  // namespace cvtflow::oracle
