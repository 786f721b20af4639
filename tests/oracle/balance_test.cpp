#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

namespace cvtflow::oracle {
namespace {

/// Total force and moment about the origin's z axis on the chain [N, N·m], and the sum of magnitudes that makes up each.
struct Sum {
    Vec3 force;
    Real moment = 0.0L;
    Real magnitude = 0.0L;
};

Sum sum_over_chain(const model::ChainLayout& layout, const std::vector<Real>& state, const std::vector<Real>& forces) {
    Sum sum;
    for (int link = 0; link < layout.links; ++link) {
        const Real* q = &state[layout.link_begin(link)];
        const Real* f = &forces[link * layout.link_size()];
        for (int body = 0; body < layout.bodies(); ++body) {
            const auto end = static_cast<model::End>(body);
            sum.force += Vec3{f[layout.x(end, 0)], f[layout.y(end, 0)], f[layout.z(end)]};
            for (int m = 0; m < layout.lateral(); ++m) {
                const Vec2 place{q[layout.x(end, m)], q[layout.y(end, m)]};
                const Vec2 force{f[layout.x(end, m)], f[layout.y(end, m)]};
                sum.moment += cross(place, force);
                sum.magnitude += norm(force);
            }
        }
    }
    return sum;
}

double rounding(const Sum& sum) { return 1e-15 * static_cast<double>(sum.magnitude); }

void expect_no_force(const Sum& sum) {
    for (const Real component : {sum.force.x, sum.force.y, sum.force.z}) EXPECT_NEAR(static_cast<double>(component), 0.0, rounding(sum));
}

/// Halves; and rigid pins without pulleys, as their tips have no phases.
std::vector<Case> chains_by_themselves() {
    std::vector<Case> cases = all_details(small_scene());
    for (Case& one : rigid_details(small_scene()))
        if (one.parameters.detail.pulleys == model::PulleyDetail::absent) cases.push_back(std::move(one));
    return cases;
}

TEST(ChainBalance, InternalForcesOfTheChainSumToZeroForceAndMoment) {
    std::uint64_t seed = 500;
    for (const Case& one : chains_by_themselves()) {
        SCOPED_TRACE(one.name);
        ExactState at = exact_random_state(one.parameters, seed++);
        std::fill(at.phases.begin(), at.phases.end(), model::Phase::free);
        const auto layout = model::layout_of(one.parameters);
        const auto result = exact_right_hand_side(one.parameters, 0.0, at.state, at.phases, false);
        const Sum sum = sum_over_chain(layout, at.state, result.forces);
        ASSERT_GT(sum.magnitude, 1e3L);
        expect_no_force(sum);
        EXPECT_NEAR(static_cast<double>(sum.moment), 0.0, rounding(sum));
    }
}

/// Forces on the six bodies without bearings: only attachments, tips and clamping, which all act between bodies and chain.
TEST(ChainBalance, ChainAndPulleysTogetherAreOnlyPushedByBearingsDriveAndLoad) {
    model::Parameters sticking = small_scene();
    sticking.detail.stick_slip = true;
    for (model::Parameters parameters : {small_scene(), sticking, with_rigid_pins(small_scene())}) {
        parameters.pulley.bearing_radial = 0.0;
        parameters.pulley.bearing_axial = 0.0;
        const ExactState at = exact_random_state(parameters, 40);
        const auto layout = model::layout_of(parameters);
        const auto result = exact_right_hand_side(parameters, 0.0, at.state, at.phases, false);
        Sum sum = sum_over_chain(layout, at.state, result.forces);
        const Real* q = &at.state[layout.pulley_begin()];
        const Real* f = &result.forces[layout.links * layout.link_size()];
        for (int b = 0; b < 6; ++b) {
            const auto k = [b](int freedom) { return model::body_freedom(b, freedom); };
            const Vec3 force{f[k(0)], f[k(1)], f[k(4)]};
            sum.force += force;
            const bool driven = b == 1 || b >= 4;
            const Vec2 place{q[k(0)] + (driven ? parameters.pulley.centre_distance : 0.0), q[k(1)]};
            sum.moment += cross(place, in_plane(force)) + f[k(5)];
            sum.magnitude += norm(force);
        }
        expect_no_force(sum);
        // About z only to first order of the tilts (1e-6): the normal force has no moment about the tilted axis, not about z; nor do
        // radial attachments balance at second order of the displacements.
        const Real drive = result.powers.works[0] / at.state[layout.pulley_begin() + 36 + model::body_freedom(0, 5)];
        EXPECT_NEAR(static_cast<double>(sum.moment), static_cast<double>(drive) - parameters.load.torque.at(0.0),
                    1e-6 * static_cast<double>(sum.magnitude));
    }
}

ExactState moved(ExactState at, const std::vector<Real>& slope, Real time) {
    for (std::size_t k = 0; k < slope.size(); ++k) at.state[k] += time * slope[k];
    return at;
}

Real energy_after(const model::Parameters& parameters, const ExactState& start, const std::vector<Real>& slope, Real time) {
    const ExactState at = moved(start, slope, time);
    const auto energies = exact_right_hand_side(parameters, 0.0, at.state, at.phases, false).energies;
    return energies.potential() + energies.kinetic;
}

/// The energy differenced along the slope against works and losses. A step of 1e-12 s moves contacts by picometres to ångströms;
/// rounding of ~2 kJ at 1e-19 leaves 2e-4 W, of the 1e4 W at work.
void expect_balance(const model::Parameters& parameters, double t, std::uint64_t seed) {
    const ExactState at = exact_random_state(parameters, seed);
    const auto result = exact_right_hand_side(parameters, t, at.state, at.phases);
    const Real step = 1e-12L;
    const Real after = energy_after(parameters, at, result.slope, step);
    const Real rate = (after - energy_after(parameters, at, result.slope, -step)) / (2.0L * step);
    const auto& losses = result.powers.losses;
    const auto& works = result.powers.works;
    const Real lost = std::accumulate(losses.begin(), losses.end(), 0.0L);
    const Real put_in = std::accumulate(works.begin(), works.end(), 0.0L);
    EXPECT_NEAR(static_cast<double>(rate), static_cast<double>(put_in - lost), 1e-2 + 1e-8 * static_cast<double>(lost));
    for (int k = 0; k < model::loss_kinds; ++k) EXPECT_GE(losses[k], 0.0L) << "loss " << k;

    const auto layout = model::layout_of(parameters);
    const auto rates = rate_indices(layout);
    Real power = 0.0L;
    for (int k = 0; k < layout.coordinates(); ++k) power += result.forces[k] * at.state[rates[k]];
    std::vector<Real> flow(at.state.size(), 0.0L);
    const auto coordinates = coordinate_indices(layout);
    for (int k = 0; k < layout.coordinates(); ++k) flow[coordinates[k]] = at.state[rates[k]];
    // Potential energy alone (~1 J) along the velocities: a longer step and far less rounding, for the small terms.
    const Real drift = 3e-11L;
    const Real above = potential_energy(parameters, moved(at, flow, drift));
    const Real stored = (above - potential_energy(parameters, moved(at, flow, -drift))) / (2.0L * drift);
    EXPECT_NEAR(static_cast<double>(power), static_cast<double>(put_in - lost - stored), 1e-4 + 1e-9 * static_cast<double>(lost));
}

/// A machine at an instant [s].
struct Instant {
    std::string name;
    model::Parameters parameters;
    double t = 0.0;
};

/// Both chains at every detail, also with damping so heavy that contacts let go.
void add_details(std::vector<Instant>& all) {
    for (const double damping : {0.02, 50.0}) {
        model::Parameters base = small_scene();
        base.control.enabled = true;
        base.chain.damping_ratio = damping;
        for (const auto& cases : {all_details(base), rigid_details(base)})
            for (const Case& one : cases) all.push_back({one.name + ", damping " + std::to_string(damping), one.parameters});
    }
}

/// Every friction law, phase and input, while the ramp rises, before and after t = 0.
void add_laws_and_inputs(std::vector<Instant>& all) {
    for (const auto law : {model::FrictionLaw::piecewise, model::FrictionLaw::smoothed}) {
        for (const bool stick_slip : {false, true}) {
            for (const auto mode : {model::DriveMode::speed, model::DriveMode::torque}) {
                for (const double t : {-0.018, -0.001, 0.003}) {
                    model::Parameters p = small_scene();
                    p.detail.friction = law;
                    p.detail.stick_slip = stick_slip;
                    p.drive.mode = mode;
                    p.drive.torque = p.load.torque = model::TimeTable({0.0, 0.01}, {100.0, 200.0});
                    all.push_back({"law " + std::to_string(static_cast<int>(law)) + " at " + std::to_string(t), p, t});
                }
            }
        }
    }
}

TEST(PowerBalance, EnergyChangesByWorksMinusLossesAndEveryLossIsPositive) {
    std::vector<Instant> all;
    add_details(all);
    add_laws_and_inputs(all);
    for (const double ratio : {0.6, 1.0, 1.7}) {
        all.push_back({"baseline at ratio " + std::to_string(ratio), {}});
        all.back().parameters.start.ratio = ratio;
    }
    for (const bool rigid : {false, true}) {
        model::Parameters p = rigid ? with_rigid_pins({}) : model::Parameters{};
        p.guide = {.stiffness = 5e7, .damping = 0.2, .clearance = 0.0, .friction = 0.3, .begin = 0.1, .end = 0.7};
        all.push_back({rigid ? "guides of rigid pins" : "guides", p});
    }
    std::uint64_t seed = 100;
    for (const Instant& one : all) {
        SCOPED_TRACE(one.name);
        expect_balance(one.parameters, one.t, seed++);
    }
}

TEST(PowerBalance, TheLedgerGrowsWithThePowers) {
    model::Parameters parameters = small_scene();
    parameters.ledger = true;
    parameters.control.enabled = true;
    parameters.guide = {.stiffness = 1e6, .clearance = 0.0};
    const RandomState at = random_state(parameters, 4);
    const Result result = right_hand_side(parameters, 0.0, at.state, at.phases);
    const auto layout = model::layout_of(parameters);
    for (int k = 0; k < model::loss_kinds; ++k) EXPECT_EQ(result.slope[layout.ledger_begin() + k], result.powers.losses[k]);
    for (int k = 0; k < model::work_kinds; ++k) {
        EXPECT_EQ(result.slope[layout.ledger_begin() + model::loss_kinds + k], result.powers.works[k]);
    }
    for (const double loss : result.powers.losses) EXPECT_GT(loss, 0.0);
}

TEST(Inertia, LumpedPlatesKeepMassStiffnessAndSecondMomentOfThePack) {
    model::Parameters parameters;
    const auto each = plate_springs(parameters);
    parameters.detail.plates = model::PlateDetail::lumped;
    const auto lumped = plate_springs(parameters);
    ASSERT_EQ(each.size(), 14u);
    ASSERT_EQ(lumped.size(), 2u);
    const auto moment = [](const std::vector<PlateSpring>& plates, int power) {
        Real sum = 0.0L;
        for (const auto& plate : plates) sum += plate.stiffness * std::pow(plate.xi, power);
        return static_cast<double>(sum);
    };
    for (const int power : {0, 1, 2}) EXPECT_NEAR(moment(lumped, power), moment(each, power), 1e-6) << power;
    EXPECT_NEAR(static_cast<double>(lumped[0].mass + lumped[1].mass), 14 * 0.65e-3, 1e-15);
}

/// Shafts and sheaves that are free to tilt and spin, with no springs against tilting, no tips, everything else at rest.
TEST(GyroscopicForce, KeepsTheAngularMomentumOfAFreeRotor) {
    model::Parameters p = small_scene();
    make_conservative(p);
    p.pulley.bearing_tilt = p.pulley.attachment_tilt = p.pulley.attachment_radial = 0.0;
    const auto layout = model::layout_of(p);
    ExactState at = exact_random_state(p, 3);
    for (const int index : rate_indices(layout)) at.state[index] = 0.0L;
    std::fill(at.phases.begin(), at.phases.end(), model::Phase::free);
    const Real spin = 200.0L, step = 2e-5L;
    for (const int body : {0, model::sheave_body(0, 1)}) {
        const bool shaft = body == 0;
        const Real polar = shaft ? p.pulley.shaft_polar_inertia + p.drive.inertia : p.pulley.sheave_polar_inertia,
                   tilting = shaft ? p.pulley.shaft_tilt_inertia : p.pulley.sheave_tilt_inertia;
        const auto acceleration = [&](Vec2 rate) {
            ExactState now = at;
            const int first = layout.pulley_begin() + layout.pulley_size + model::body_freedom(body, 2);
            now.state[first] = rate.x;
            now.state[first + 1] = rate.y;
            now.state[first + 3] = spin;
            const auto slope = exact_right_hand_side(p, 0.0, now.state, now.phases).slope;
            return Vec2{slope[first], slope[first + 1]};
        };
        Vec2 tau, rate{0.1L, 0.0L};
        for (int k = 0; k < 300; ++k) {  // midpoint rule
            const Vec2 middle = rate + (step / 2.0L) * acceleration(rate);
            tau += step * middle;
            rate += step * acceleration(middle);
        }
        // H = J_t τ' + J_p φ' (axis), axis = (τ_y, -τ_x): conserved from the kick J_t (0.1, 0).
        const double kick = static_cast<double>(tilting * 0.1L);
        EXPECT_NEAR(static_cast<double>(tilting * rate.x + polar * spin * tau.y), kick, 1e-6 * kick) << body;
        EXPECT_NEAR(static_cast<double>(tilting * rate.y - polar * spin * tau.x), 0.0, 1e-6 * kick) << body;
        EXPECT_GT(norm(tau), 0.0L) << body;
    }
}

}  // namespace
}  // namespace cvtflow::oracle
