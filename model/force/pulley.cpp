
#include "model/force/pulley.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"
#include "model/force/pulley_inputs.hpp"

namespace cvtflow::model {
namespace {

/// Whether it is the sheave that imperfections name.
[[nodiscard]] bool is_imperfect(const Imperfection& of, int shaft, int side) noexcept {
    return 2 * shaft + side == static_cast<int>(of.sheave);
}

/// Freedom 0 of that sheave, of elastic pulleys.
[[nodiscard]] int imperfect_freedom(const Imperfection& of) noexcept {
    const int sheave = static_cast<int>(of.sheave);
    return body_freedom(sheave_body(sheave / 2, sheave % 2), 0);
}

}  // namespace

PulleyModel::PulleyModel(const Parameters& p) { adopt(p); }

void PulleyModel::adopt(const Parameters& p) {
    inputs_.adopt(p);
    pulley_ = p.pulley;
    imperfection_ = p.imperfection;
    half_length_ = 0.5 * p.half.length;
    add_inertia({p.drive.inertia, p.load.inertia});
    supports_.adopt(p);
}

void PulleyModel::add_inertia(const std::array<double, 2>& added) {
    inertia_.clear();
    if (coordinates().size() == 0) return;
    if (!coordinates().elastic()) {
        for (const double of_shaft : added) inertia_.push_back(shaft_inertia(pulley_, of_shaft));
        inertia_.insert(inertia_.end(), 2, pulley_.sheave_mass);
        return;
    }
    for (int body = 0; body < 6; ++body) {
        const bool shaft = body < 2;
        const double mass = shaft ? pulley_.shaft_mass : pulley_.sheave_mass;
        const double tilt = shaft ? pulley_.shaft_tilt_inertia : pulley_.sheave_tilt_inertia;
        const double polar = shaft ? pulley_.shaft_polar_inertia + added[body] : pulley_.sheave_polar_inertia;
        inertia_.insert(inertia_.end(), {mass, mass, tilt, tilt, mass, polar});
    }
}

void PulleyModel::motions(const double* block, SheaveMotion* sheaves) const noexcept {
    const PulleyCoordinates& at = coordinates();
    const double* q = block;
    const double* v = block + at.size();
    for (int shaft = 0; shaft < 2; ++shaft) {
        const double axis = shaft * pulley_.centre_distance;
        for (int side = 0; side < 2; ++side) {
            const double plane = (side == 0 ? -half_length_ : half_length_) + shaft * imperfection_.misalignment;
            SheaveMotion& s = sheaves[2 * shaft + side];
            if (at.elastic()) {
                const int b = body_freedom(sheave_body(shaft, side), 0);
                s = {axis + q[b + ux], q[b + uy],    plane + q[b + axial], q[b + tilt_x], q[b + tilt_y], v[b + ux],
                     v[b + uy],        v[b + axial], v[b + tilt_x],        v[b + tilt_y], v[b + turn]};
            } else {
                const bool moves = sheave_body(shaft, side) == movable_body(shaft);
                s = {axis, 0.0, plane + (moves ? q[2 + shaft] : 0.0), 0.0, 0.0, 0.0, 0.0, moves ? v[2 + shaft] : 0.0, 0.0, 0.0, v[shaft]};
            }
            if (imperfection_.runout == 0.0 || !is_imperfect(imperfection_, shaft, side)) continue;
            const auto [x, y] = eccentricity(q[at.sheave_rotation(shaft, side)]);
            s.x += x;
            s.y += y;
            s.vx -= y * s.spin_z;
            s.vy += x * s.spin_z;
        }
    }
}

std::array<double, 2> PulleyModel::eccentricity(double angle) const noexcept {
    return {imperfection_.runout * portable_cos(angle), imperfection_.runout * portable_sin(angle)};
}

WorkRates input_powers(const PulleyCoordinates& at, const double* block, const Inputs& inputs) noexcept {
    const std::array<double, 2> torque = inputs.on_shafts();
    WorkRates rates{torque[0] * at.shaft_speed(block, 0), torque[1] * at.shaft_speed(block, 1), 0.0};
    for (int shaft = 0; shaft < 2; ++shaft) rates[2] -= movable_side(shaft) * inputs.clamping[shaft] * at.opening(block + at.size(), shaft);
    return rates;
}

WorkRates input_work(const PulleyCoordinates& at, const double* from, const double* to, const Inputs& inputs) noexcept {
    const auto turned = [&](int shaft) { return to[at.rotation(shaft)] - from[at.rotation(shaft)]; };
    const std::array<double, 2> torque = inputs.on_shafts();
    WorkRates done{torque[0] * turned(0), torque[1] * turned(1), 0.0};
    for (int shaft = 0; shaft < 2; ++shaft)
        done[2] -= movable_side(shaft) * inputs.clamping[shaft] * (at.opening(to, shaft) - at.opening(from, shaft));
    return done;
}

double PulleyModel::momentum(const double* block, int shaft) const noexcept {
    const PulleyCoordinates& at = coordinates();
    const double* v = block + at.size();
    double sum = inertia_[at.rotation(shaft)] * v[at.rotation(shaft)];
    if (!at.elastic()) return sum;
    for (int side = 0; side < 2; ++side) {
        const int freedom = at.sheave_rotation(shaft, side);
        sum += inertia_[freedom] * v[freedom];
    }
    return sum;
}

void PulleyModel::add_gyroscopic(const double* v, double* force) const noexcept {
    if (!coordinates().elastic()) return;
    for (int body = 0; body < 6; ++body) {
        const int b = body_freedom(body, 0);
        const double momentum = inertia_[b + turn] * v[b + turn];
        force[b + tilt_x] -= momentum * v[b + tilt_y];
        force[b + tilt_y] += momentum * v[b + tilt_x];
    }
}

void PulleyModel::add_clamping(const double* block, const Inputs& inputs, double* force, Account* account) const noexcept {
    const PulleyCoordinates& at = coordinates();
    for (int shaft = 0; shaft < 2; ++shaft) {
        const double rate = at.opening(block + at.size(), shaft);
        const double push = -movable_side(shaft) * inputs.clamping[shaft] - pulley_.cylinder_damping * rate;
        force[at.movable(shaft)] += push;
        if (at.elastic()) force[body_freedom(shaft, axial)] -= push;
        if (account != nullptr) account->lose(Loss::cylinder, pulley_.cylinder_damping * rate * rate);
    }
}

/// Virtual work of a force on an eccentric flank, whose displacement (x, y) turns with its sheave: x F_y - y F_x on the angle.
void PulleyModel::add_chain(const double* block, const SheaveForces& chain, double* force) const noexcept {
    const PulleyCoordinates& at = coordinates();
    for (int shaft = 0; shaft < 2; ++shaft) {
        for (int side = 0; side < 2; ++side) {
            const auto& load = chain[2 * shaft + side];
            if (at.elastic()) {
                for (int freedom = 0; freedom < 6; ++freedom) force[body_freedom(sheave_body(shaft, side), freedom)] += load[freedom];
            } else {
                force[shaft] += load[turn];
                if (sheave_body(shaft, side) == movable_body(shaft)) force[2 + shaft] += load[axial];
            }
            if (imperfection_.runout == 0.0 || !is_imperfect(imperfection_, shaft, side)) continue;
            const auto [x, y] = eccentricity(block[at.sheave_rotation(shaft, side)]);
            force[at.sheave_rotation(shaft, side)] += x * load[uy] - y * load[ux];
        }
    }
}

/// [m 0 -s; 0 m c; -s c J] (u_x, u_y, φ)'' = (F_x + c φ'², F_y + s φ'², M) with (c, s) = U (cos φ, sin φ): M is solved for first.
void PulleyModel::add_unbalance(const double* block, double* force) const noexcept {
    const int b = imperfect_freedom(imperfection_);
    const double mass = inertia_[b + ux], polar = inertia_[b + turn], spin = block[coordinates().size() + b + turn];
    const double c = imperfection_.unbalance * portable_cos(block[b + turn]), s = imperfection_.unbalance * portable_sin(block[b + turn]);
    force[b + ux] += c * spin * spin;
    force[b + uy] += s * spin * spin;
    const double free_polar = polar - imperfection_.unbalance * imperfection_.unbalance / mass;
    const double turning = (force[b + turn] + (s * force[b + ux] - c * force[b + uy]) / mass) / free_polar;
    force[b + ux] += s * turning;
    force[b + uy] -= c * turning;
    force[b + turn] = polar * turning;
}

void PulleyModel::slope(const double* block, const Inputs& inputs, const SheaveForces& chain, double* slope,
                        Account* account) const noexcept {
    const double* v = block + coordinates().size();
    double* force = slope + coordinates().size();
    std::copy(v, v + coordinates().size(), slope);
    std::fill(force, force + coordinates().size(), 0.0);
    supports_.add(block, v, force, account);
    add_gyroscopic(v, force);
    add_clamping(block, inputs, force, account);
    add_chain(block, chain, force);
    for (int shaft = 0; shaft < 2; ++shaft) force[coordinates().rotation(shaft)] += inputs.on_shafts()[static_cast<std::size_t>(shaft)];
    if (imperfection_.unbalance != 0.0) add_unbalance(block, force);
    for (int k = 0; k < coordinates().size(); ++k) force[k] /= inertia_[k];
}

void PulleyModel::account(const double* block, Account& account) const noexcept {
    std::array<double, 36> unused{};
    supports_.add(block, block + coordinates().size(), unused.data(), &account);
    add_clamping(block, {}, unused.data(), &account);
    account.store(Energy::kinetic, kinetic(block));
}

double PulleyModel::kinetic(const double* block) const noexcept {
    const PulleyCoordinates& at = coordinates();
    double energy = 0.0;
    for (int k = 0; k < at.size(); ++k) energy += 0.5 * inertia_[k] * block[at.size() + k] * block[at.size() + k];
    if (imperfection_.unbalance == 0.0) return energy;
    const int b = imperfect_freedom(imperfection_);
    const double *v = block + at.size() + b, angle = block[b + turn];
    return energy + imperfection_.unbalance * v[turn] * (portable_cos(angle) * v[uy] - portable_sin(angle) * v[ux]);
}

/// Virtual work: a sheave at z_s follows its shaft by u_x + τ_y z_s, u_y - τ_x z_s and τ. The cylinder pushes the movable sheave and the
/// shaft apart.
BearingLoad PulleyModel::held_bearing(const double* block, int shaft, const Inputs& inputs, const SheaveForces& chain) const noexcept {
    BearingLoad load;
    for (int side = 0; side < 2; ++side) {
        const auto& [fx, fy, about_x, about_y, along, about_z] = chain[2 * shaft + side];
        const double z = side == 0 ? -half_length_ : half_length_;
        load.force[0] += fx;
        load.force[1] += fy;
        load.moment[0] += about_x - z * fy;
        load.moment[1] += about_y + z * fx;
        if (sheave_body(shaft, side) != movable_body(shaft)) load.force[2] += along;
    }
    const double rate = coordinates().opening(block + coordinates().size(), shaft);
    load.force[2] += movable_side(shaft) * inputs.clamping[shaft] + pulley_.cylinder_damping * rate;
    return load;
}

std::array<BearingLoad, 2> PulleyModel::bearings(const double* block, const Inputs& inputs, const SheaveForces& chain) const noexcept {
    const double* v = block + coordinates().size();
    if (coordinates().elastic()) return {supports_.bearing(block, v, 0), supports_.bearing(block, v, 1)};
    return {held_bearing(block, 0, inputs, chain), held_bearing(block, 1, inputs, chain)};
}

void ShaftSupports::adopt(const Parameters& p) {
    damping_ratio_ = p.pulley.damping_ratio;
    supports_.clear();
    if (p.detail.pulleys != PulleyDetail::elastic) return;
    for (int shaft = 0; shaft < 2; ++shaft) {
        add_bearings(p.pulley, shaft);
        for (int side = 0; side < 2; ++side) add_attachment(p, shaft, side);
    }
}

void ShaftSupports::spring(std::array<int, 3> index, std::array<double, 3> factor, double stiffness, double mass) {
    std::size_t terms = factor.size();
    while (terms > 1 && factor[terms - 1] == 0.0) --terms;
    supports_.push_back({index, factor, damped_spring(stiffness, mass, damping_ratio_), terms});
}

void ShaftSupports::add_bearings(const Pulley& pulley, int shaft) {
    using enum PulleyCoordinates::Freedom;
    const auto on = [&](int freedom) { return std::array<int, 3>{body_freedom(shaft, freedom), 0, 0}; };
    constexpr std::array<double, 3> one{1.0, 0.0, 0.0};
    spring(on(ux), one, pulley.bearing_radial, pulley.shaft_mass);
    spring(on(uy), one, pulley.bearing_radial, pulley.shaft_mass);
    spring(on(axial), one, pulley.bearing_axial, pulley.shaft_mass);
    spring(on(tilt_x), one, pulley.bearing_tilt, pulley.shaft_tilt_inertia);
    spring(on(tilt_y), one, pulley.bearing_tilt, pulley.shaft_tilt_inertia);
}

void ShaftSupports::add_attachment(const Parameters& p, int shaft, int side) {
    using enum PulleyCoordinates::Freedom;
    const Pulley& pulley = p.pulley;
    const bool imperfect = is_imperfect(p.imperfection, shaft, side);
    const int body = sheave_body(shaft, side);
    const double z = (side == 0 ? -0.5 : 0.5) * p.half.length;
    const auto between = [&](int freedom) { return std::array<int, 3>{body_freedom(body, freedom), body_freedom(shaft, freedom), 0}; };
    constexpr std::array<double, 3> difference{1.0, -1.0, 0.0};
    auto radial_x = between(ux);
    radial_x[2] = body_freedom(shaft, tilt_y);
    spring(radial_x, {1.0, -1.0, -z}, pulley.attachment_radial, pulley.sheave_mass);
    auto radial_y = between(uy);
    radial_y[2] = body_freedom(shaft, tilt_x);
    spring(radial_y, {1.0, -1.0, z}, pulley.attachment_radial, pulley.sheave_mass);
    if (body != movable_body(shaft)) spring(between(axial), difference, pulley.attachment_axial, pulley.sheave_mass);
    const double against_tilt = imperfect ? p.imperfection.attachment * pulley.attachment_tilt : pulley.attachment_tilt;
    spring(between(tilt_x), difference, against_tilt, pulley.sheave_tilt_inertia);
    spring(between(tilt_y), difference, against_tilt, pulley.sheave_tilt_inertia);
    spring(between(turn), difference, pulley.attachment_torsion, pulley.sheave_polar_inertia);
}

void ShaftSupports::add(const double* q, const double* v, double* force, Account* account) const noexcept {
    double stored = 0.0, lost = 0.0;
    for (const Support& s : supports_) {
        double u = 0.0;
        double rate = 0.0;
        for (std::size_t k = 0; k < s.terms; ++k) {
            u += s.factor[k] * q[s.index[k]];
            rate += s.factor[k] * v[s.index[k]];
        }
        const double f = s.spring.stiffness * u + s.spring.damping * rate;
        for (std::size_t k = 0; k < s.terms; ++k) force[s.index[k]] -= s.factor[k] * f;
        stored += 0.5 * s.spring.stiffness * u * u;
        lost += s.spring.damping * rate * rate;
    }
    if (account == nullptr) return;
    account->store(Energy::supports, stored);
    account->lose(Loss::supports, lost);
}

/// A bearing is a support with one body alone.
BearingLoad ShaftSupports::bearing(const double* q, const double* v, int shaft) const noexcept {
    constexpr std::size_t radial_x = 0, radial_y = 1, tilt_about_x = 2, tilt_about_y = 3, along = 4;
    std::array<double, 6> load{};
    for (const Support& s : supports_) {
        const int freedom = s.index[0] - body_freedom(shaft, 0);
        if (s.factor[1] != 0.0 || freedom < 0 || freedom >= 6) continue;
        load[static_cast<std::size_t>(freedom)] += s.spring.stiffness * q[s.index[0]] + s.spring.damping * v[s.index[0]];
    }
    return {{load[radial_x], load[radial_y], load[along]}, {load[tilt_about_x], load[tilt_about_y]}};
}

}  // namespace cvtflow::model
