/// Production kernels against the plain oracle: the same equations written twice.

#include "model/variator/variator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/plain_rhs.hpp"
#include "tests/oracle/random_state.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow {
namespace {

using oracle::Case;

/// Every combination of plates, pulleys and joint points; quick: nine that contain every pair of two of them.
std::vector<Case> detail_cases() {
    std::vector<Case> cases;
    for (const auto plates : {model::PlateDetail::each, model::PlateDetail::lumped}) {
        for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::rigid, model::PulleyDetail::absent}) {
            for (const int points : {1, 3, 8}) {
                const bool chosen = static_cast<int>(plates) == (points / 3 + static_cast<int>(pulleys)) % 2;
                if (!test::is_deep() && !chosen) continue;
                model::Parameters p;
                p.detail.plates = plates;
                p.detail.pulleys = pulleys;
                p.detail.joint_points = points;
                p.detail.friction = points == 8 ? model::FrictionLaw::smoothed : model::FrictionLaw::piecewise;
                p.detail.stick_slip = points == 1;
                p.joint.law = points == 3 ? model::JointLaw::palmgren : model::JointLaw::linear;
                p.start.layout = pulleys == model::PulleyDetail::absent ? model::StartLayout::ring : model::StartLayout::belt;
                p.control.enabled = pulleys == model::PulleyDetail::elastic && points == 1;
                p.ledger = points != 8 || plates == model::PlateDetail::each;
                if (points == 8) p.chain.pitch = {8.12e-3, 8.12e-3, 8.0e-3};
                cases.push_back({"plates " + std::to_string(static_cast<int>(plates)) + ", pulleys " +
                                     std::to_string(static_cast<int>(pulleys)) + ", joint points " + std::to_string(points),
                                 p});
            }
        }
    }
    return cases;
}

/// Largest difference relative to the largest value of its kind anywhere (link velocities, link accelerations, pulley accelerations):
/// forces of that size cancel at every link, so no single coordinate can be more exact than they are. Control and ledger are compared one
/// by one.
/// @param size slopes whose largest values count
double worst_difference(const model::ChainLayout& at, const std::vector<double>& a, const std::vector<double>& b,
                        const std::vector<double>& size) {
    struct Kind {
        double largest = 0.0, difference = 0.0;
        void compare(double x, double y, double scale) {
            largest = std::max(largest, std::abs(scale));
            difference = std::max(difference, std::abs(x - y));
        }
        [[nodiscard]] double relative() const { return largest > 0.0 ? difference / largest : difference; }
    };
    Kind velocities, accelerations, pulleys;
    double worst = 0.0;
    for (int k = 0; k < at.size(); ++k) {
        const double x = a[static_cast<std::size_t>(k)];
        const double y = b[static_cast<std::size_t>(k)];
        const double scale = size[static_cast<std::size_t>(k)];
        const bool of_link = k < at.pulley_begin();
        if (of_link) (k % at.link_block() < at.link_size() ? velocities : accelerations).compare(x, y, scale);
        if (!of_link && k < at.control_begin()) pulleys.compare(x, y, scale);
        if (k >= at.control_begin()) worst = std::max(worst, std::abs(x - y) / std::max(std::abs(y), 1e-300));
    }
    return std::max({worst, velocities.relative(), accelerations.relative(), pulleys.relative()});
}

/// Every law of tips, with and without an influence of pressure.
std::vector<Case> tip_law_cases() {
    std::vector<Case> cases;
    for (const auto& [law, temperature] : {std::pair{model::TipFriction::constant, 353.15},
                                           {model::TipFriction::table, 353.15},
                                           {model::TipFriction::lubricated, 313.15},
                                           {model::TipFriction::lubricated, 393.15}}) {
        model::Parameters p;
        p.oil.temperature = temperature;
        p.tip.friction_law = law;
        p.tip.friction_table = {{0.0, 0.01, 0.1, 0.5, 5.0}, {0.06, 0.09, 0.08, 0.02, 0.07}};
        p.tip.pressure_sensitivity = law == model::TipFriction::lubricated ? 0.0 : 0.3;
        p.tip.roughness = 5e-9;
        cases.push_back({"law_" + std::to_string(static_cast<int>(law)) + " at " + std::to_string(temperature), p});
    }
    return cases;
}

std::vector<Case> imperfect_cases() {
    std::vector<Case> cases;
    for (const auto sheave : {model::Sheave::driven_movable, model::Sheave::driving_fixed}) {
        for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::rigid}) {
            model::Parameters p;
            p.detail.pulleys = pulleys;
            p.imperfection.misalignment = 3e-6;  // random states are microns deep
            p.imperfection.sheave = sheave;
            p.imperfection.runout = 5e-6;
            p.imperfection.attachment = pulleys == model::PulleyDetail::elastic ? 0.5 : 1.0;
            p.imperfection.unbalance = pulleys == model::PulleyDetail::elastic ? 0.02 : 0.0;
            const std::string name = std::string(sheave == model::Sheave::driven_movable ? "driven_" : "driving_") +
                                     (pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid");
            cases.push_back({name, p});
            cases.push_back({name + "_rigid_pins", oracle::with_rigid_pins(p)});
        }
    }
    model::Parameters p;
    p.imperfection.pin_length_spread = 2e-6;
    cases.push_back({"unequal_pins", p});
    cases.push_back({"unequal_rigid_pins", oracle::with_rigid_pins(p)});
    return cases;
}

/// Rails without play, so that both sides of both strands are touched, some pins at their ends.
std::vector<Case> guide_cases() {
    std::vector<Case> cases;
    for (const double ratio : {0.6, 1.7}) {
        model::Parameters p;
        p.ledger = true;
        p.start.ratio = ratio;
        p.guide = {.stiffness = 5e7, .damping = 0.2, .clearance = 0.0, .offset = 1e-6, .friction = 0.3, .begin = 0.1, .end = 0.7};
        const std::string name = ratio < 1.0 ? "overdrive_" : "low_";
        cases.push_back({name + "halves", p});
        cases.push_back({name + "rigid_pins", oracle::with_rigid_pins(p)});
    }
    return cases;
}

/// All details of rigid pins, for 84 pins with one and with two pitches, and for few pins; quick: three for each, one of each pulleys.
std::vector<Case> rigid_pin_cases() {
    std::vector<Case> cases;
    const auto add = [&](const std::string& name, const model::Parameters& base) {
        const std::size_t group = cases.size() / 3;
        std::size_t number = 0;
        for (const Case& one : oracle::rigid_details(base)) {
            if (test::is_deep() || number % 4 == (group + number / 4) % 4) cases.push_back({name + ", " + one.name, one.parameters});
            ++number;
        }
    };
    model::Parameters p;
    p.ledger = true;
    p.control.enabled = true;
    add("84_pins", p);
    p.chain.pitch = {8.12e-3, 8.12e-3, 8.0e-3};
    p.start.ratio = 1.7;
    add("two_pitches", p);
    p = oracle::small_scene();
    p.ledger = true;
    p.chain.pins = 12;
    p.chain.pitch = {40e-3, 39.9e-3};
    add("12_pins", p);
    p.chain.pins = 8;
    p.chain.pitch = {60e-3, 60e-3, 59.8e-3};
    add("8_pins", p);
    return cases;
}

/// Uncommon rigid pins: a ring of five, one plate per link, halves that yield more or less than their tips, heavy damping, an overdrive.
std::vector<Case> rare_rigid_pin_cases() {
    const model::Parameters base = oracle::with_rigid_pins({});
    std::vector<Case> cases{{"ring_of_5", base},    {"one_plate", base},     {"soft_halves", base},
                            {"stiff_halves", base}, {"heavy_damping", base}, {"overdrive", base}};
    cases[0].parameters.detail.pulleys = model::PulleyDetail::absent;
    cases[0].parameters.start.layout = model::StartLayout::ring;
    cases[0].parameters.chain.pins = 5;
    cases[0].parameters.chain.pitch = {30e-3};
    cases[1].parameters.plate.count = 1;
    cases[1].parameters.plate.stiffness = 8e8;
    cases[2].parameters.half.area /= 8.0;
    cases[3].parameters.half.area *= 100.0;
    cases[4].parameters.chain.damping_ratio = 20.0;
    cases[5].parameters.start.ratio = 0.5;
    for (Case& one : cases) one.parameters.ledger = true;
    return cases;
}

void expect_agreement_with_the_oracle(const model::Parameters& parameters) {
    const model::Variator variator(parameters);
    model::EvaluationScratch scratch(variator.layout());
    for (unsigned seed = 1; seed <= test::depth(1U, 3U); ++seed) {
        const auto random = oracle::random_state(parameters, seed);
        const auto expected = oracle::right_hand_side(parameters, 1e-3, random.state, random.phases);
        std::vector<double> slope(expected.slope.size());
        ASSERT_EQ(static_cast<int>(slope.size()), variator.layout().size());
        model::right_hand_side(variator, 1e-3, random.state.data(), random.phases.data(), slope.data(), scratch);
        // Rounding of forces that cancel: some thousand ulps of the largest.
        EXPECT_LT(worst_difference(variator.layout(), slope, expected.slope, expected.slope), 1e-12) << "seed " << seed;
    }
}

TEST(EveryDetail, TheKernelsAgreeWithTheOracleOnRandomStates) {
    for (const auto cases : {detail_cases, rigid_pin_cases, rare_rigid_pin_cases, imperfect_cases, tip_law_cases, guide_cases}) {
        ASSERT_FALSE(cases().empty());
        for (const Case& one : cases()) {
            SCOPED_TRACE(one.name);
            expect_agreement_with_the_oracle(one.parameters);
        }
    }
}

/// Both shafts coupled; or shaft 2 held by its governor, and clamped by the torque that acts.
std::vector<model::Parameters> coupled_cases() {
    std::vector<model::Parameters> cases;
    for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::rigid}) {
        for (const auto load : {model::LoadMode::coupling, model::LoadMode::speed}) {
            model::Parameters p;
            p.detail.pulleys = pulleys;
            p.drive.mode = load == model::LoadMode::coupling ? model::DriveMode::coupling : model::DriveMode::speed;
            p.drive.coupling = {500.0, 3.0};
            p.load.mode = load;
            p.load.linear = 0.1;
            p.load.speed = model::TimeTable(179.0);
            p.load.coupling = {400.0, 2.0};
            p.clamping.safety = load == model::LoadMode::speed ? 1.5 : 0.0;
            p.drag = {.driving = {0.2, 1e-3, 3e-6}, .driven = {0.3, 2e-3, 1e-6}, .bearing_friction = 0.0015};
            cases.push_back(p);
        }
    }
    return cases;
}

/// Cylinders by forces and both controllers; by pressures, with springs, compensation and a motor; with a pump that is short of flow.
std::vector<model::Parameters> hydraulic_cases() {
    std::vector<model::Parameters> cases(4);
    for (model::Parameters& p : cases) {
        p.hydraulics.mode = model::HydraulicMode::force;
        p.detail.plates = model::PlateDetail::lumped;
        p.control.enabled = true;
        p.control.driven = model::DrivenControl::slip;
    }
    cases[1].hydraulics.mode = model::HydraulicMode::pressure;
    cases[1].control.enabled = false;
    cases[1].control.driven = model::DrivenControl::none;
    cases[1].clamping.safety = 1.3;
    cases[1].hydraulics.driving.compensation = 0.01;
    cases[1].hydraulics.driven.spring = 2e3;
    cases[1].hydraulics.driven.spring_rate = 3e4;
    cases[1].hydraulics.pump_ratio = 0.0;
    cases[1].hydraulics.pump_speed = model::TimeTable(300.0);
    cases[2].hydraulics.pump_displacement = 1e-8;
    cases[3].detail.pulleys = model::PulleyDetail::rigid;
    cases[3].drag = {.driving = {50.0, 1.0, 1e-3}, .driven = {80.0, 2.0, 1e-3}, .bearing_friction = 0.1};
    return cases;
}

/// Couplings and hydraulics take over at one state; slopes are compared at another, as they were before and as they are then.
TEST(Variator, AgreesWithTheOracleOnceCouplingsAndHydraulicsHaveTakenOver) {
    for (const auto& cases : {hydraulic_cases(), coupled_cases()}) {
        for (const model::Parameters& parameters : cases) {
            for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
                model::Variator variator(parameters);
                model::EvaluationScratch scratch(variator.layout());
                const auto start = oracle::random_state(parameters, seed), later = oracle::random_state(parameters, seed + 1);
                variator.couple(0.0, start.state.data() + variator.layout().pulley_begin());
                const oracle::FarEnds far = oracle::far_ends(parameters, start.state, start.phases);
                const auto expected = oracle::right_hand_side(parameters, 1e-3, later.state, later.phases, &far);
                const auto before = oracle::right_hand_side(parameters, 1e-3, later.state, later.phases);
                std::vector<double> slope(expected.slope.size());
                model::right_hand_side(variator, 1e-3, later.state.data(), later.phases.data(), slope.data(), scratch);
                EXPECT_LT(worst_difference(variator.layout(), slope, expected.slope, expected.slope), 1e-12) << seed;
                EXPECT_GT(worst_difference(variator.layout(), slope, before.slope, expected.slope), 1e-6) << "they act";
            }
        }
    }
}

/// A sweep takes the variator of the case before where the machine is the same.
TEST(Variator, IsOfAnotherMachineWithOtherGuidesOrOthersPlace) {
    model::Parameters p;
    p.guide.stiffness = 1e6;
    model::Parameters softer = p, elsewhere = p;
    softer.guide.stiffness = 1e5;
    elsewhere.start.ratio = 1.2;
    EXPECT_FALSE(model::Variator::same_machine(p, softer));
    EXPECT_FALSE(model::Variator::same_machine(p, elsewhere));
    p.guide = elsewhere.guide = {};
    EXPECT_TRUE(model::Variator::same_machine(p, elsewhere)) << "start.ratio places guides alone";
}

}  // namespace
}  // namespace cvtflow
