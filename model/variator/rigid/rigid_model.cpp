#include "model/variator/rigid/rigid_model.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "model/start/start_state.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] RigidKernels compiled_for(Isa isa) {
    for (const CompiledRigidKernels& compiled : compiled_rigid_kernels()) {
        if (compiled.isa == isa) return compiled.kernels();
    }
    throw std::invalid_argument("instruction set \"" + std::string(name_of(isa)) + "\" is not compiled in");
}

[[nodiscard]] RigidLayout rigid_layout(const Parameters& p) noexcept {
    return {p.chain.pins, layout_of(p).pulley_size, layout_of(p).controls};
}

/// The start of `parameters` with whole pins that tilt.
[[nodiscard]] Parameters for_start(Parameters p) {
    p.detail.pins = PinDetail::whole;
    p.detail.order = 1;
    p.detail.plates = PlateDetail::lumped;
    p.ledger = false;
    return p;
}

}  // namespace

RigidModel::RigidModel(const Parameters& parameters, Isa isa)
    : parameters_(parameters),
      coefficients_(parameters),
      pulleys_(parameters),
      kernels_(compiled_for(isa)),
      layout_(rigid_layout(parameters)) {}

RigidColumns RigidModel::columns() const {
    RigidColumns columns(layout_.pins);
    coefficients_.fill(parameters_, columns);
    return columns;
}

void RigidModel::accelerate(double t, const double* tail, const RigidKick& kick, RigidColumns& columns, RigidForces& f) const noexcept {
    f.account = {};
    f.reaction = {};
    columns.wrap(Column::x, Column::vq);
    kernels_.lines(columns);
    columns.wrap(Column::line_x, Column::line_turn);
    kernels_.roll(coefficients_, columns);
    columns.wrap(Column::bisector_x, Column::part_vy);
    kernels_.links(coefficients_, kick, columns, f.account);
    columns.wrap(Column::pull_x, Column::tension);
    kernels_.lean(coefficients_, kick, columns, f.account);
    columns.wrap(Column::lean_x, Column::rolling);
    kernels_.gather(columns);
    columns.wrap(Column::force_z, Column::force_z);
    kernels_.rub(coefficients_, kick, columns, f.account);
    columns.wrap(Column::rub, Column::rub);
    if (layout_.pulley_size != 0) {
        SheaveMotion sheaves[4];
        pulleys_.motions(tail, sheaves);
        f.inputs = pulleys_.inputs(t, tail);
        kernels_.tips(coefficients_, sheaves, kick, columns, f.reaction, f.account);
        columns.wrap(Column::tip_lean_x, Column::tip_rear);
        columns.wrap(Column::tip_z, Column::tip_z);
    }
    kernels_.moments(columns);
    columns.wrap(Column::tip_moment, Column::tip_moment_before);
    kernels_.accelerate(coefficients_, columns);
}

void RigidModel::tail_slope(const double* tail, RigidForces& f, double* slope) const noexcept {
    if (layout_.pulley_size == 0) return;
    pulleys_.slope(tail, f.inputs, f.reaction.sheaves, slope, &f.account);
    for (int k = 0; k < layout_.controls; ++k) slope[2 * layout_.pulley_size + k] = f.inputs.control_rate[static_cast<std::size_t>(k)];
}

void RigidModel::slope(double t, const double* y, double* slope, RigidColumns& columns, RigidForces& forces) const noexcept {
    read(y, columns);
    std::fill_n(columns[Column::tip_moment] - 1, columns.padded() + 2, 0.0);
    accelerate(t, y + layout_.pulley_begin(), {}, columns, forces);
    for (int k = 0; k < rigid_coordinates; ++k) {
        std::copy_n(columns[Column::vx + k], layout_.pins, slope + layout_.coordinate(k));
        std::copy_n(columns[Column::force_x + k], layout_.pins, slope + layout_.velocity(k));
    }
    tail_slope(y + layout_.pulley_begin(), forces, slope + layout_.pulley_begin());
}

double RigidModel::kinetic(const double* y) const noexcept {
    double energy = 0.0;
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double* v = y + layout_.velocity(k);
        const double mass = k < 3 ? coefficients_.mass : coefficients_.tilt_mass;
        for (int pin = 0; pin < layout_.pins; ++pin) energy += 0.5 * mass * v[pin] * v[pin];
    }
    return layout_.pulley_size != 0 ? energy + pulleys_.kinetic(y + layout_.pulley_begin()) : energy;
}

void RigidModel::read(const double* y, RigidColumns& columns) const noexcept {
    for (int k = 0; k < 2 * rigid_coordinates; ++k) std::copy_n(y + k * layout_.pins, layout_.pins, columns[Column::x + k]);
}

void RigidModel::write(const RigidColumns& columns, double* y) const noexcept {
    for (int k = 0; k < 2 * rigid_coordinates; ++k) std::copy_n(columns[Column::x + k], layout_.pins, y + k * layout_.pins);
}

std::vector<double> rigid_start(const Parameters& parameters) {
    const Parameters p = for_start(parameters);
    const ChainLayout from = layout_of(p);
    const StartState start = start_state(p);
    const RigidLayout to = rigid_layout(parameters);
    std::vector<double> y(static_cast<std::size_t>(to.size()), 0.0);
    const int place[] = {from.x(End::rear, 0), from.y(End::rear, 0), from.z(End::rear), from.x(End::rear, 1), from.y(End::rear, 1)};
    for (int pin = 0; pin < to.pins; ++pin) {
        const double* block = start.state.data() + from.link_begin(pin);
        for (int k = 0; k < rigid_coordinates; ++k) {
            y[static_cast<std::size_t>(to.coordinate(k) + pin)] = block[place[k]];
            y[static_cast<std::size_t>(to.velocity(k) + pin)] = block[from.link_size() + place[k]];
        }
    }
    std::copy(start.state.begin() + from.pulley_begin(), start.state.begin() + from.pulley_begin() + to.tail(),
              y.begin() + to.pulley_begin());
    return y;
}

}  // namespace cvtflow::model
