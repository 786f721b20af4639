#include "tests/oracle/oracle_cases.hpp"

#include "tests/sample_fixture.hpp"

namespace cvtflow::oracle {

model::Parameters small_scene() {
    model::Parameters p;
    p.chain.pins = 16;
    p.chain.pitch = {30e-3, 29.9e-3};
    p.plate.count = 5;
    p.pulley.centre_distance = 0.1;
    p.pulley.arc_position = 44e-3;
    p.start.ratio = 1.1;
    p.drive.inertia = 0.01;
    p.load.inertia = 0.02;
    return p;
}

std::vector<Case> all_details(const model::Parameters& base) {
    std::vector<Case> cases;
    for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::rigid, model::PulleyDetail::absent}) {
        for (const auto law : {model::JointLaw::linear, model::JointLaw::palmgren}) {
            for (const auto plates : {model::PlateDetail::each, model::PlateDetail::lumped}) {
                for (const int points : {1, 3, 8}) {
                    const bool chosen = static_cast<int>(plates) == (points / 3 + static_cast<int>(pulleys)) % 2 &&
                                        static_cast<int>(law) == (points / 6 + static_cast<int>(pulleys)) % 2;
                    if (!test::is_deep() && !chosen) continue;
                    Case one{"", base};
                    one.parameters.detail.pulleys = pulleys;
                    one.parameters.detail.plates = plates;
                    one.parameters.detail.joint_points = points;
                    one.parameters.joint.law = law;
                    one.name = std::string("pulleys ") + std::to_string(static_cast<int>(pulleys)) + ", joint law " +
                               std::to_string(static_cast<int>(law)) + ", plates " + std::to_string(static_cast<int>(plates)) +
                               ", joint points " + std::to_string(points);
                    cases.push_back(one);
                }
            }
        }
    }
    return cases;
}

model::Parameters with_rigid_pins(model::Parameters parameters) {
    parameters.detail.pins = model::PinDetail::rigid;
    parameters.detail.plates = model::PlateDetail::lumped;
    parameters.detail.stick_slip = false;
    parameters.joint.law = model::JointLaw::linear;
    return parameters;
}

std::vector<Case> rigid_details(const model::Parameters& base) {
    std::vector<Case> cases;
    for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::rigid, model::PulleyDetail::absent}) {
        for (const auto law : {model::FrictionLaw::piecewise, model::FrictionLaw::smoothed}) {
            for (const auto tips : {model::TipFriction::table, model::TipFriction::lubricated}) {
                Case one{"rigid pins, pulleys " + std::to_string(static_cast<int>(pulleys)) + ", friction " +
                             std::to_string(static_cast<int>(law)) + ", tips " + std::to_string(static_cast<int>(tips)),
                         with_rigid_pins(base)};
                model::Parameters& p = one.parameters;
                p.detail.pulleys = pulleys;
                p.detail.friction = law;
                if (law == model::FrictionLaw::piecewise && pulleys != model::PulleyDetail::absent) {
                    p.tip.friction_law = tips;
                    p.tip.friction_table = {{0.0, 0.01, 0.02, 0.05}, {0.07, 0.09, 0.06, 0.08}};
                    p.tip.roughness = 5e-9;
                    p.tip.pressure_sensitivity = 0.3;
                }
                cases.push_back(std::move(one));
            }
        }
    }
    return cases;
}

void make_conservative(model::Parameters& p) {
    p.chain.damping_ratio = 0.0;
    p.pulley.damping_ratio = 0.0;
    p.pulley.cylinder_damping = 0.0;
    p.plate.friction.coefficient = 0.0;
    p.joint.friction.coefficient = 0.0;
    p.tip.friction.coefficient = 0.0;
    p.tip.friction_law = model::TipFriction::constant;
}

ExactState exact_random_state(const model::Parameters& parameters, std::uint64_t seed) {
    const RandomState random = random_state(parameters, seed);
    return {{random.state.begin(), random.state.end()}, random.phases};
}

std::vector<int> coordinate_indices(const model::ChainLayout& layout) {
    std::vector<int> indices;
    for (int link = 0; link < layout.links; ++link) {
        for (int k = 0; k < layout.link_size(); ++k) indices.push_back(layout.link_begin(link) + k);
    }
    for (int k = 0; k < layout.pulley_size; ++k) indices.push_back(layout.pulley_begin() + k);
    return indices;
}

std::vector<int> rate_indices(const model::ChainLayout& layout) {
    std::vector<int> indices;
    for (int link = 0; link < layout.links; ++link) {
        for (int k = 0; k < layout.link_size(); ++k) indices.push_back(layout.link_begin(link) + layout.link_size() + k);
    }
    for (int k = 0; k < layout.pulley_size; ++k) indices.push_back(layout.pulley_begin() + layout.pulley_size + k);
    return indices;
}

Real potential_energy(const model::Parameters& parameters, const ExactState& at) {
    return exact_right_hand_side(parameters, 0.0, at.state, at.phases, false).energies.potential();
}

}  // namespace cvtflow::oracle
