#include "tests/oracle/random_state.hpp"

#include "tests/oracle/belt_path.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <algorithm>
#include <random>

namespace cvtflow::oracle {

using model::End;
using model::Phase;
using model::PulleyDetail;

namespace {

/// Uniform numbers, the same with every standard library.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : engine_(seed) {}
    Real within(Real low, Real high) { return low + (high - low) * static_cast<Real>(engine_() >> 11) * 0x1p-53L; }
    Real about_zero(Real magnitude) { return within(-magnitude, magnitude); }
    bool one_in(int count) { return within(0.0L, 1.0L) < 1.0L / count; }

private:
    std::mt19937_64 engine_;
};

/// Builds the state in full precision.
struct Builder {
    const model::Parameters& parameters;
    model::ChainLayout layout = model::layout_of(parameters);
    Dice dice;
    std::vector<Real> state = std::vector<Real>(static_cast<std::size_t>(layout.size()), 0.0L);
    LaidChain chain{};

    [[nodiscard]] bool has_pulleys() const { return layout.pulley_size != 0; }
    [[nodiscard]] Real& q(int link, int offset) { return state[layout.link_begin(link) + offset]; }
    [[nodiscard]] Real& v(int link, int offset) { return state[layout.link_begin(link) + layout.link_size() + offset]; }
    [[nodiscard]] const LaidHalf& laid(int link, End end) const { return end == End::rear ? chain.rear[link] : chain.front[link]; }

    /// Rigid pins roll without a gap: their middles are those of halves that touch each other on the bisector.
    void lay_pins() {
        ChainTargets targets;
        targets.depth.assign(static_cast<std::size_t>(layout.links), 0.0L);
        targets.lean = targets.depth;
        for (int i = 0; i < layout.links; ++i)
            targets.stretch.push_back(dice.one_in(8) ? dice.within(-8e-6L, -4e-6L) : dice.within(4e-6L, 12e-6L));
        chain = lay_chain(parameters, targets);
        for (int i = 0; i < layout.links; ++i) {
            Vec2& middle = chain.rear[i].point;
            middle = 0.5L * (chain.front[layout.previous(i)].point + middle);
            q(i, layout.x(End::rear, 0)) = middle.x;
            q(i, layout.y(End::rear, 0)) = middle.y;
        }
    }

    void lay() {
        if (layout.rigid) return lay_pins();
        ChainTargets targets;
        for (int i = 0; i < layout.links; ++i) {
            targets.depth.push_back(dice.within(2e-6L, 6e-6L));
            // An opening of u = lean · 2ρ; one joint in four goes beyond its clearance.
            const Real share = dice.one_in(4) ? dice.within(1.2L, 1.8L) : dice.about_zero(0.6L);
            const Real sign = dice.one_in(2) ? 1.0L : -1.0L;
            targets.lean.push_back(sign * share * parameters.joint.clearance / (2.0L * parameters.joint.radius));
            targets.stretch.push_back(dice.within(2e-6L, 6e-6L));
        }
        chain = lay_chain(parameters, targets);
        for_all_halves([&](int link, End end) {
            const Vec2 point = laid(link, end).point;
            q(link, layout.x(end, 0)) = point.x;
            q(link, layout.y(end, 0)) = point.y;
        });
    }

    /// Halves, or rigid pins as the rear halves of their links.
    template <class Action>
    void for_all_halves(const Action& action) const {
        for (int link = 0; link < layout.links; ++link) {
            action(link, End::rear);
            if (!layout.rigid) action(link, End::front);
        }
    }

    /// Speed of shaft 0 or 1 (or the ring) [rad/s].
    [[nodiscard]] Real shaft_speed(int shaft) const {
        if (!has_pulleys()) return parameters.start.ring_speed;
        const Real driving = parameters.drive.mode == model::DriveMode::speed ? Real{parameters.drive.speed.at(0.0)}
                                                                              : Real{parameters.control.reference_speed};
        return shaft == 0 ? driving : driving / parameters.start.ratio;
    }

    /// Velocity of a half that travels with the belt [m/s].
    [[nodiscard]] Vec2 travel_velocity(const LaidHalf& half) const {
        if (half.place.part == BeltPath::Part::driving_arc) return shaft_speed(0) * left_of(half.point);
        if (half.place.part == BeltPath::Part::driven_arc) {
            return shaft_speed(1) * left_of(half.point - Vec2{parameters.pulley.centre_distance, 0.0L});
        }
        return (shaft_speed(0) * chain.radius) * half.place.tangent;
    }

    void set_axial(Real at_driving, Real at_driven) {
        for_all_halves([&](int link, End end) {
            const auto& place = laid(link, end).place;
            const Real share = place.part == BeltPath::Part::driven_arc          ? 1.0L
                               : place.part == BeltPath::Part::strand_to_driven  ? place.fraction
                               : place.part == BeltPath::Part::strand_to_driving ? 1.0L - place.fraction
                                                                                 : 0.0L;
            q(link, layout.z(end)) = at_driving + share * (at_driven - at_driving);
        });
    }

    /// Index of the w of a movable sheave.
    [[nodiscard]] int movable_axial(int shaft) const {
        const int sheave = model::sheave_body(shaft, shaft == 0 ? 1 : 0);
        const int offset = parameters.detail.pulleys == PulleyDetail::rigid ? 2 + shaft : model::body_freedom(sheave, 4);
        return layout.pulley_begin() + offset;
    }

    [[nodiscard]] Real deepest_pin(const System& system, int shaft, int side) const {
        const PinChain pins(system);
        Real depth = -1.0L;
        for (int pin = 0; pin < layout.links; ++pin) {
            for (const End end : {End::rear, End::front}) {
                const TipContact contact = pins.tip(pins.half(pin, end), side);
                if (contact.shaft == shaft) depth = std::max(depth, contact.depth);
            }
        }
        return depth;
    }

    /// Greatest depth of all tips in an arc on one side [m].
    [[nodiscard]] Real deepest(int shaft, int side) const {
        const System system = unpack(parameters, 0.0, state, {});
        if (layout.rigid) return deepest_pin(system, shaft, side);
        const auto arc = shaft == 0 ? BeltPath::Part::driving_arc : BeltPath::Part::driven_arc;
        Real depth = -1.0L;
        for_all_halves([&](int link, End end) {
            if (laid(link, end).place.part != arc) return;
            const TipContact contact = tip_contact(system, system.links[link], end, side);
            if (contact.shaft == shaft) depth = std::max(depth, contact.depth);
        });
        return depth;
    }

    /// Moves the chain against the fixed sheave, then the movable sheave against the chain, until the deepest tip is `target` deep.
    void clamp(int shaft, Real target, Real (&axial)[2]) {
        const int fixed = shaft == 0 ? 0 : 1;
        const Real toward_fixed = fixed == 0 ? -1.0L : 1.0L;
        Real low = -2e-2L;
        Real high = 2e-2L;
        for (int step = 0; step < 50; ++step) {
            const Real shift = (low + high) / 2.0L;
            axial[shaft] = toward_fixed * shift;
            set_axial(axial[0], axial[1]);
            (deepest(shaft, fixed) > target ? high : low) = shift;
        }
        low = -4e-2L;
        high = 4e-2L;
        for (int step = 0; step < 50; ++step) {
            const Real shift = (low + high) / 2.0L;
            state[movable_axial(shaft)] = toward_fixed * shift;
            (deepest(shaft, 1 - fixed) > target ? high : low) = shift;
        }
    }

    void disturb_chain() {
        // Rigid pins tilt and stand aside enough for tips to leave their sheave, and many of their contacts slide slower than the
        // saturation speed.
        const Real tilting = layout.rigid ? 5e-5L : 3e-6L, aside = layout.rigid ? 8e-6L : 1e-6L, speed = layout.rigid ? 0.02L : 0.05L;
        for_all_halves([&](int link, End end) {
            const Vec2 travel = travel_velocity(laid(link, end));
            for (int m = 0; m < layout.lateral(); ++m) {
                const Real distance = m == 0 ? 1e-6L : m == 1 ? tilting : 2e-6L;
                q(link, layout.x(end, m)) += dice.about_zero(distance);
                q(link, layout.y(end, m)) += dice.about_zero(distance);
                v(link, layout.x(end, m)) = (m == 0 ? travel.x : 0.0L) + dice.about_zero(speed);
                v(link, layout.y(end, m)) = (m == 0 ? travel.y : 0.0L) + dice.about_zero(speed);
            }
            q(link, layout.z(end)) += dice.about_zero(aside);
            q(link, layout.e(end)) += dice.about_zero(2e-6L);
            v(link, layout.z(end)) = dice.about_zero(speed);
            v(link, layout.e(end)) = dice.about_zero(speed);
        });
    }

    void disturb_pulleys() {
        const auto at = [&](int offset) -> Real& { return state[layout.pulley_begin() + offset]; };
        for (int k = 0; k < layout.pulley_size; ++k) {
            at(k) += dice.about_zero(1e-6L);
            at(layout.pulley_size + k) = dice.about_zero(0.02L);
        }
        for (const int shaft : {0, 1}) {
            if (parameters.detail.pulleys == PulleyDetail::rigid) {
                at(layout.pulley_size + shaft) += shaft_speed(shaft);
                continue;
            }
            for (const int body : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)}) {
                at(layout.pulley_size + model::body_freedom(body, 5)) += shaft_speed(shaft);
            }
        }
    }

    [[nodiscard]] Phase phase_of(const System& system, int link, End end, int side) {
        const TipContact contact = tip_contact(system, system.links[link], end, side);
        const bool touching = (contact.depth > 0.0L) != dice.one_in(10);
        if (!touching) return Phase::free;
        if (!parameters.detail.stick_slip || dice.one_in(4)) return Phase::touching;
        const Real speed = norm(tip_sliding(system, system.links[link], end, contact).tangential);
        const bool slow = speed <= parameters.tip.friction.saturation_speed;
        return slow != dice.one_in(10) ? Phase::stick : Phase::slip;
    }

    void set_pin_phases(const System& system, std::vector<Phase>& phases) const {
        const PinChain pins(system);
        for (int pin = 0; pin < layout.links; ++pin) {
            for (const End end : {End::rear, End::front}) {
                const int link = end == End::rear ? pin : layout.previous(pin);
                for (const int side : {0, 1}) {
                    const bool touches = pins.tip(pins.half(pin, end), side).depth > 0.0L;
                    if (touches) phases[model::tips_per_link * link + 2 * static_cast<int>(end) + side] = Phase::touching;
                }
            }
        }
    }

    [[nodiscard]] RandomState finish() {
        RandomState result;
        for (const Real value : state) result.state.push_back(static_cast<double>(value));
        const std::vector<Real> rounded(result.state.begin(), result.state.end());
        result.phases.assign(static_cast<std::size_t>(layout.links * model::tips_per_link), Phase::free);
        if (!has_pulleys()) return result;
        const System system = unpack(parameters, 0.0, rounded, {});
        if (layout.rigid) {
            set_pin_phases(system, result.phases);
            return result;
        }
        for_all_halves([&](int link, End end) {
            for (const int side : {0, 1}) {
                result.phases[model::tips_per_link * link + 2 * static_cast<int>(end) + side] = phase_of(system, link, end, side);
            }
        });
        return result;
    }
};

}  // namespace

RandomState random_state(const model::Parameters& parameters, std::uint64_t seed) {
    Builder builder{.parameters = parameters, .dice = Dice{seed}};
    builder.lay();
    if (builder.has_pulleys()) {
        Real axial[2] = {0.0L, 0.0L};
        builder.clamp(0, 12e-6L, axial);
        builder.clamp(1, 12e-6L, axial);
        builder.disturb_pulleys();
    }
    builder.disturb_chain();
    for (int k = 0; k < builder.layout.controls; ++k) builder.state[builder.layout.control_begin() + k] = builder.dice.about_zero(1e-4L);
    for (int k = builder.layout.ledger_begin(); k < builder.layout.size(); ++k) builder.state[k] = builder.dice.about_zero(1.0L);
    return builder.finish();
}

}  // namespace cvtflow::oracle
