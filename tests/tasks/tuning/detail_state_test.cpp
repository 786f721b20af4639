#include "tasks/tuning/point_measure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using model::ChainLayout;
using model::End;

constexpr unsigned char phase(model::Phase of) { return static_cast<unsigned char>(of); }
constexpr unsigned char untouched = phase(model::Phase::free), touching = phase(model::Phase::touching);

/// Parameters of `tiny` with other detail.
model::Parameters tiny_with(model::PinDetail pins, int order) {
    model::Parameters parameters = tiny_parameters();
    parameters.detail.pins = pins;
    parameters.detail.order = order;
    return parameters;
}

/// Pins on a circle of 30 mm, and something of its own in every other coordinate and velocity.
engine::SavedState ring(const model::Parameters& parameters) {
    const ChainLayout at = model::layout_of(parameters);
    engine::SavedState saved;
    saved.state.resize(static_cast<std::size_t>(at.control_begin()));
    for (std::size_t k = 0; k < saved.state.size(); ++k) saved.state[k] = 1e-4 * std::sin(static_cast<double>(k));
    const auto put = [&](int link, End end, double angle) {
        double* q = saved.state.data() + at.link_begin(link);
        q[at.x(end, 0)] = 0.03 * std::cos(angle);
        q[at.y(end, 0)] = 0.03 * std::sin(angle);
    };
    for (int link = 0; link < at.links; ++link) {
        const double pitch = 2.0 * M_PI / at.links;
        put(link, End::rear, -pitch * link);
        if (!at.rigid) put(link, End::front, -pitch * (link + 0.9));
    }
    saved.phases.assign(static_cast<std::size_t>(model::tips_per_link * at.links), untouched);
    return saved;
}

TEST(DetailState, OfHigherOrderBeginsWithTheCoordinatesThatTheLowerOneHas) {
    const model::Parameters low = tiny_with(model::PinDetail::halves, 1), high = tiny_with(model::PinDetail::halves, 3);
    const engine::SavedState saved = ring(low), over = convert_state(saved, low, high);
    EXPECT_EQ(over.state[static_cast<std::size_t>(model::layout_of(high).y(End::front, 1))],
              saved.state[static_cast<std::size_t>(model::layout_of(low).y(End::front, 1))]);
    EXPECT_EQ(over.state[static_cast<std::size_t>(model::layout_of(high).y(End::front, 2))], 0.0);
    EXPECT_EQ(convert_state(over, high, low).state, saved.state);
}

TEST(DetailState, PutsARigidPinInTheMiddleBetweenItsHalves) {
    const model::Parameters halves = tiny_with(model::PinDetail::halves, 1), rigid = tiny_with(model::PinDetail::rigid, 2);
    const ChainLayout from = model::layout_of(halves), to = model::layout_of(rigid);
    engine::SavedState saved = ring(halves);
    saved.phases[7] = touching;
    const engine::SavedState over = convert_state(saved, halves, rigid);
    ASSERT_EQ(over.state.size(), static_cast<std::size_t>(to.control_begin()));
    EXPECT_EQ(over.phases, saved.phases) << "four tips, as before";
    for (int pin = 0; pin < to.links; ++pin) {
        const double* rear = saved.state.data() + from.link_begin(pin);
        const double* front = saved.state.data() + from.link_begin(from.previous(pin));
        const double* q = over.state.data() + to.link_begin(pin);
        EXPECT_DOUBLE_EQ(q[to.x(End::rear, 0)], 0.5 * (rear[from.x(End::rear, 0)] + front[from.x(End::front, 0)])) << pin;
        const double* v = q + to.link_size();
        const double before = front[from.link_size() + from.z(End::front)], behind = rear[from.link_size() + from.z(End::rear)];
        EXPECT_DOUBLE_EQ(v[to.z(End::rear)], 0.5 * (behind + before)) << pin;
        EXPECT_DOUBLE_EQ(v[to.e(End::rear)], before - behind) << pin;
    }
}

/// A rigid pin refers to the middle of its plates, and its halves slide on each other: their mean and difference along z.
TEST(DetailState, OfRigidPinsComesBackFromHalves) {
    const model::Parameters halves = tiny_with(model::PinDetail::halves, 3), rigid = tiny_with(model::PinDetail::rigid, 2);
    const ChainLayout from = model::layout_of(rigid), to = model::layout_of(halves);
    const engine::SavedState saved = ring(rigid), over = convert_state(saved, rigid, halves), back = convert_state(over, halves, rigid);
    ASSERT_EQ(back.state.size(), saved.state.size());
    for (std::size_t k = 0; k < saved.state.size(); ++k) EXPECT_NEAR(back.state[k], saved.state[k], 1e-17 + 1e-14 * 0.03) << k;
    for (int pin = 0; pin < from.links; ++pin) {
        const double* rear = over.state.data() + to.link_begin(pin);
        const double* front = over.state.data() + to.link_begin(to.previous(pin));
        const double* q = saved.state.data() + from.link_begin(pin);
        EXPECT_NEAR(front[to.z(End::front)] - rear[to.z(End::rear)], q[from.e(End::rear)], 1e-18) << pin;
        EXPECT_EQ(rear[to.x(End::rear, 2)], q[from.x(End::rear, 2)]) << pin;
        const double x = 0.5 * (rear[to.x(End::rear, 0)] + front[to.x(End::front, 0)]);
        EXPECT_NEAR(x, q[from.x(End::rear, 0)] - model::Coefficients(rigid).plate_bow * q[from.x(End::rear, 2)], 1e-17) << pin;
    }
}

}  // namespace
}  // namespace cvtflow::tasks
