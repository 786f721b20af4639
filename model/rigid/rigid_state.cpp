#include "model/rigid/rigid_state.hpp"

#include <algorithm>

namespace cvtflow::model {

RigidState::RigidState(const RigidModel& of)
    : model(of),
      columns(of.columns()),
      tail(static_cast<std::size_t>(of.layout().pulley_block() + of.layout().controls), 0.0),
      tail_slope(tail.size(), 0.0),
      ledger(of.layout().ledger ? static_cast<std::size_t>(of.layout().size() - of.layout().ledger_begin()) : 0, 0.0) {}

void RigidState::read(const double* y) {
    const ChainLayout& at = model.layout();
    lead = 0.0;
    model.read(y, columns);
    std::copy_n(y + at.pulley_begin(), tail.size(), tail.begin());
    std::copy_n(y + (at.size() - static_cast<int>(ledger.size())), ledger.size(), ledger.begin());
}

void RigidState::write(double* y) const noexcept {
    const ChainLayout& at = model.layout();
    model.write(columns, y);
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double* acceleration = columns[Column::acceleration_x + k];
        double* v = y + at.link_size() + rigid_place(at, k);
        for (int pin = 0; pin < at.links; ++pin) v[at.link_begin(pin)] -= lead * acceleration[pin] / model.scale(k);
    }
    double* behind = y + at.pulley_begin();
    std::copy(tail.begin(), tail.end(), behind);
    for (std::size_t k = static_cast<std::size_t>(at.pulley_size), end = kicked_end(); k < end; ++k)
        behind[k] = tail[k] - lead * tail_slope[k];
    std::copy(ledger.begin(), ledger.end(), behind + tail.size());
}

std::size_t RigidState::kicked_end() const noexcept {
    return tail.size() - (model.layout().hydraulic() ? static_cast<std::size_t>(hydraulic_unknowns) : 0);
}

double RigidState::acceleration_energy() const noexcept {
    const RigidCoefficients& c = model.coefficients();
    double sum = 0.0;
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double *a = columns[Column::acceleration_x + k], mass = c.inertia(k);
        for (int pin = 0; pin < c.pins; ++pin) sum += 0.5 * mass * a[pin] * a[pin];
    }
    return sum;
}

std::size_t RigidState::bytes() const noexcept {
    return sizeof(*this) + columns.bytes() + (tail.size() + tail_slope.size() + ledger.size()) * sizeof(double);
}

}  // namespace cvtflow::model
