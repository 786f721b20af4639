#include "tests/oracle/random_state.hpp"

#include "model/start/start_state.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <algorithm>
#include <cmath>
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
    std::vector<Real> state{};

    [[nodiscard]] bool has_pulleys() const { return layout.pulley_size != 0; }
    [[nodiscard]] Real& q(int link, int offset) { return state[layout.link_begin(link) + offset]; }
    [[nodiscard]] Real& v(int link, int offset) { return state[layout.link_begin(link) + layout.link_size() + offset]; }

    /// Halves, or rigid pins as the rear halves of their links.
    template <class Action>
    void for_all_halves(const Action& action) const {
        for (int link = 0; link < layout.links; ++link) {
            action(link, End::rear);
            if (!layout.rigid) action(link, End::front);
        }
    }

    /// Index of the w of a movable sheave.
    [[nodiscard]] int movable_axial(int shaft) const {
        const int sheave = model::sheave_body(shaft, shaft == 0 ? 1 : 0);
        const int offset = parameters.detail.pulleys == PulleyDetail::rigid ? 2 + shaft : model::body_freedom(sheave, 4);
        return layout.pulley_begin() + offset;
    }

    /// A geometric start at the machine's speed, but with the joints' depths and the plates' stretch of one that is pre-tensioned by 4 kN.
    void start() {
        const model::StartState moving = model::start_state(parameters);
        const double pitch = model::chain_length(parameters.chain) / parameters.chain.pins;
        const double faster = std::sqrt(4e3 * pitch / model::link_mass(parameters)) / moving.speed;
        model::Parameters tight = parameters;
        for (double& speed : tight.drive.speed.value) speed *= faster;
        tight.control.reference_speed *= faster;
        tight.start.ring_speed *= faster;
        const std::vector<double> placed = model::start_state(tight).state;
        state.assign(moving.state.begin(), moving.state.end());
        for (int link = 0; link < layout.links; ++link)
            std::copy_n(placed.begin() + layout.link_begin(link), layout.link_size(), state.begin() + layout.link_begin(link));
        std::fill_n(state.begin() + layout.pulley_begin(), layout.pulley_size, 0.0L);
        if (!has_pulleys()) return;
        for (const int shaft : {0, 1}) state[movable_axial(shaft)] = placed[movable_axial(shaft)];
    }

    /// Moves the chain into the fixed sheaves, which it touches, and the movable ones as far into the chain.
    void clamp(Real depth) {
        const Real shift = depth / std::cos(Real{parameters.tip.angle});
        for_all_halves([&](int link, End end) {
            const bool driving = q(link, layout.x(end, 0)) < parameters.pulley.centre_distance / 2.0L;
            q(link, layout.z(end)) += driving ? -shift : shift;
        });
        for (const int shaft : {0, 1}) state[movable_axial(shaft)] += 2.0L * (shaft == 0 ? -shift : shift);
    }

    /// Opens joints sideways, one in four beyond its clearance.
    void open_joints() {
        for (int link = 0; link < layout.links; ++link) {
            const Real share = dice.one_in(4) ? dice.within(1.2L, 1.8L) : dice.about_zero(0.4L), sign = dice.one_in(2) ? 1.0L : -1.0L;
            const int x = layout.x(End::front, 0), y = layout.y(End::front, 0), rear_x = layout.x(End::rear, 0),
                      rear_y = layout.y(End::rear, 0);
            const Vec2 travel = unit(Vec2{q(link, x) - q(link, rear_x), q(link, y) - q(link, rear_y)});
            const Vec2 aside = sign * share * Real{parameters.joint.clearance} * left_of(travel);
            q(link, x) += aside.x;
            q(link, y) += aside.y;
        }
    }

    /// Rigid pins move along the chain, tilt and stand aside enough for links to push and tips to leave their sheave, and many of their
    /// contacts slide slower than the saturation speed.
    void disturb_chain() {
        const Real along = layout.rigid ? 8e-6L : 1e-6L, tilting = layout.rigid ? 5e-5L : 3e-6L, aside = layout.rigid ? 8e-6L : 1e-6L;
        const Real speed = layout.rigid ? 0.02L : 0.05L;
        for_all_halves([&](int link, End end) {
            const Vec2 moving{v(link, layout.x(end, 0)), v(link, layout.y(end, 0))};
            const Vec2 forward = dice.about_zero(along) * unit(moving);
            q(link, layout.x(end, 0)) += forward.x;
            q(link, layout.y(end, 0)) += forward.y;
            for (int m = 0; m < layout.lateral(); ++m) {
                const Real distance = m == 0 ? 1e-6L : m == 1 ? tilting : 2e-6L;
                for (const int row : {layout.x(end, m), layout.y(end, m)}) {
                    q(link, row) += dice.about_zero(distance);
                    v(link, row) += dice.about_zero(speed);
                }
            }
            q(link, layout.z(end)) += dice.about_zero(aside);
            q(link, layout.e(end)) += dice.about_zero(2e-6L);
            v(link, layout.z(end)) = dice.about_zero(speed);
            v(link, layout.e(end)) = dice.about_zero(speed);
        });
    }

    void disturb_pulleys() {
        for (int k = 0; k < layout.pulley_size; ++k) {
            state[layout.pulley_begin() + k] += dice.about_zero(1e-6L);
            state[layout.pulley_begin() + layout.pulley_size + k] += dice.about_zero(0.02L);
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
        result.phases.assign(static_cast<std::size_t>(layout.links) * model::tips_per_link, Phase::free);
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
    builder.start();
    if (builder.has_pulleys()) builder.clamp(11e-6L);
    if (!builder.layout.rigid) builder.open_joints();
    builder.disturb_pulleys();
    builder.disturb_chain();
    for (int k = 0; k < builder.layout.controls; ++k) builder.state[builder.layout.control_begin() + k] = builder.dice.about_zero(1e-4L);
    for (int k = builder.layout.ledger_begin(); k < builder.layout.size(); ++k) builder.state[k] = builder.dice.about_zero(1.0L);
    return builder.finish();
}

}  // namespace cvtflow::oracle
