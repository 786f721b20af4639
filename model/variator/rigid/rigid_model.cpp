#include "model/variator/rigid/rigid_model.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace cvtflow::model {

namespace {

[[nodiscard]] RigidKernels compiled_for(Isa isa) {
    for (const CompiledRigidKernels& compiled : compiled_rigid_kernels()) {
        if (compiled.isa == isa) return compiled.kernels();
    }
    throw std::invalid_argument("instruction set \"" + std::string(name_of(isa)) + "\" is not compiled in");
}

}  // namespace

RigidModel::RigidModel(const Parameters& parameters, Isa isa)
    : parameters_(parameters), layout_(layout_of(parameters)), coefficients_(parameters), kernels_(compiled_for(isa)) {}

RigidColumns RigidModel::columns() const {
    RigidColumns columns(layout_.links);
    coefficients_.fill(parameters_, columns);
    return columns;
}

void RigidModel::accelerate(const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns, RigidForces& f) const noexcept {
    f.account = {};
    f.reaction = {};
    columns.wrap(Column::x, Column::vbend_y);
    kernels_.lines(columns);
    columns.wrap(Column::line_x, Column::line_turn);
    kernels_.roll(coefficients_, columns);
    columns.wrap(Column::bisector_x, Column::part_vy);
    kernels_.links(coefficients_, kick, columns, f.account);
    columns.wrap(Column::pull_x, Column::bow_y);
    kernels_.lean(coefficients_, kick, columns, f.account);
    columns.wrap(Column::lean_x, Column::bend_moment);
    kernels_.gather(columns);
    if (sheaves != nullptr && !kick.implicit()) kernels_.lengthen(coefficients_, sheaves, columns);
    columns.wrap(Column::lengthening, Column::lengthening);
    kernels_.rub(coefficients_, kick, columns, f.account);
    columns.wrap(Column::joint, Column::joint);
    if (sheaves != nullptr) {
        kernels_.tips(coefficients_, sheaves, kick, columns, f.reaction, f.account);
        columns.wrap(Column::tip_lean_x, Column::tip_rear);
    }
    kernels_.settle(coefficients_, kick, columns, f.account);
    kernels_.moments(columns);
    columns.wrap(Column::tip_moment, Column::tip_moment_before);
    kernels_.accelerate(coefficients_, columns);
}

void RigidModel::accelerate(const SheaveMotion* sheaves, RigidColumns& columns, RigidForces& forces) const noexcept {
    std::fill_n(columns[Column::tip_moment] - 1, columns.padded() + 2, 0.0);
    accelerate(sheaves, {}, columns, forces);
}

void RigidModel::read(const double* blocks, RigidColumns& columns) const noexcept {
    for (int k = 0; k < rigid_coordinates; ++k) {
        double *x = columns[Column::x + k], *v = columns[Column::vx + k];
        const double* from = blocks + rigid_place(layout_, k);
        for (int pin = 0; pin < layout_.links; ++pin, from += layout_.link_block()) {
            x[pin] = scale(k) * from[0];
            v[pin] = scale(k) * from[layout_.link_size()];
        }
    }
}

void RigidModel::write(const RigidColumns& columns, double* blocks) const noexcept {
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double *x = columns[Column::x + k], *v = columns[Column::vx + k];
        double* to = blocks + rigid_place(layout_, k);
        for (int pin = 0; pin < layout_.links; ++pin, to += layout_.link_block()) {
            to[0] = x[pin] / scale(k);
            to[layout_.link_size()] = v[pin] / scale(k);
        }
    }
}

void RigidModel::acceleration(const RigidColumns& columns, int pin, double* of_pin) const noexcept {
    for (int k = 0; k < rigid_coordinates; ++k) of_pin[rigid_place(layout_, k)] = columns[Column::force_x + k][pin] / scale(k);
}

}  // namespace cvtflow::model
