#include "tests/claims/smooth_motion_fixture.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::claims {

namespace {

void soften(model::Parameters& p) {
    p.detail.friction = model::FrictionLaw::smoothed;
    p.detail.smoothing = 0.5;
    for (model::Friction* friction : {&p.plate.friction, &p.joint.friction, &p.tip.friction}) friction->saturation_speed = 1e3;
    p.joint.clearance = 1e-3;  // the opening's spring begins beyond reach
}

/// Every coordinate of the chain gets a speed of its own.
void jolt(const model::ChainLayout& at, std::vector<double>& state) {
    for (int link = 0; link < at.links; ++link) {
        for (int k = 0; k < at.link_size(); ++k)
            state[static_cast<std::size_t>(at.link_begin(link) + at.link_size() + k)] += 0.02 * std::sin(1.0 + link + 3.0 * k);
    }
}

}  // namespace

Smooth disturbed_ring() {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.chain.pins = 24;
    p.start.ring_speed = 600.0;
    soften(p);
    Rig rig(p);
    Smooth scene{p, rig.state_copy(), rig.phases()};
    jolt(rig.variator().layout(), scene.state);
    return scene;
}

Smooth clamped_ring() {
    model::Parameters p;
    soften(p);
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 200.0;
    p.start.settling_time = p.start.ramp_time = 1e-3;
    p.chain.pins = 13;
    p.pulley.arc_position = 16.8e-3;
    p.pulley.innermost = 10e-3;
    p.drive.speed = model::TimeTable(200.0);
    p.load.torque = model::TimeTable(0.0);
    p.clamping = {model::TimeTable(15e3), model::TimeTable(0.0)};
    Rig rig(p);
    EXPECT_FALSE(rig.run({-1e-3, 0.0, 5e-8, 1e-3}));
    Smooth scene{p, rig.state_copy(), rig.phases()};
    for (const model::Phase phase : scene.phases) EXPECT_EQ(phase, model::Phase::touching);
    jolt(rig.variator().layout(), scene.state);
    return scene;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(square);
}

}  // namespace cvtflow::claims
