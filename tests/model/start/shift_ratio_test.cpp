/// Another ratio in a state that runs.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/force/pulley_inputs.hpp"
#include "model/start/shift_ratio.hpp"
#include "model/start/start_state.hpp"

namespace cvtflow::model {
namespace {

/// Distances between a pin's rear half and the one behind it [pins].
std::vector<double> pitches(const ChainLayout& at, const std::vector<double>& state) {
    std::vector<double> lengths;
    for (int link = 0; link < at.links; ++link) {
        const double* here = state.data() + at.link_begin(link);
        const double* next = state.data() + at.link_begin(at.next(link));
        const int x = at.x(End::rear, 0), y = at.y(End::rear, 0);
        lengths.push_back(std::hypot(next[x] - here[x], next[y] - here[y]));
    }
    return lengths;
}

/// The state of a geometric start, numbered from the pin that is next to the middle of the upper strand.
std::vector<double> running(const Parameters& p) {
    const ChainLayout at = layout_of(p);
    const std::vector<double> start = start_state(p).state;
    int first = 0;
    double nearest = 1.0;
    for (int link = 0; link < at.links; ++link) {
        const double* q = start.data() + at.link_begin(link);
        const double off = std::abs(q[at.x(End::rear, 0)] - 0.5 * p.pulley.centre_distance);
        if (q[at.y(End::rear, 0)] > 0.0 && off < nearest) first = link, nearest = off;
    }
    std::vector<double> state = start;
    for (int link = 0; link < at.links; ++link)
        std::copy_n(start.begin() + at.link_begin(at.wrapped(first + link)), at.link_block(), state.begin() + at.link_begin(link));
    return state;
}

class ShiftRatio : public testing::TestWithParam<PinDetail> {};

/// A chain on other radii: pins follow, no pitch stretches, and the way back leads back.
TEST_P(ShiftRatio, MovesAStateToTheRadiiOfAnotherRatio) {
    Parameters p;
    p.detail.pins = GetParam();
    p.drive.speed = TimeTable(200.0);
    p.start.ratio = 1.3;
    const ChainLayout at = layout_of(p);
    const std::vector<double> before = running(p);
    std::vector<double> after = before;
    ASSERT_TRUE(shift_ratio(p, 1.3, 1.3 * 1.01, after.data()));
    const auto old_pitches = pitches(at, before), new_pitches = pitches(at, after);
    for (std::size_t k = 0; k < old_pitches.size(); ++k) EXPECT_NEAR(new_pitches[k], old_pitches[k], 5e-4 * old_pitches[k]) << k;
    PulleyCoordinates coordinates;
    coordinates.adopt(p);
    const auto was = chain_radii(p, 1.3), is = chain_radii(p, 1.3 * 1.01);
    const double *here = after.data() + at.pulley_begin(), *there = before.data() + at.pulley_begin();
    const double wider = is->driving - was->driving;
    EXPECT_NEAR(coordinates.running_radius(here, 0) - coordinates.running_radius(there, 0), wider, 1e-12);
    EXPECT_NEAR(coordinates.running_radius(here, 1) - coordinates.running_radius(there, 1), is->driven - was->driven, 1e-12);
    EXPECT_NEAR(coordinates.shaft_speed(here, 1), coordinates.shaft_speed(there, 1) / 1.01, 1e-9);
    for (int link = 0; link < at.links; ++link) {
        const auto x = static_cast<std::size_t>(at.link_begin(link) + at.x(End::rear, 0)), half = static_cast<std::size_t>(at.link_size());
        const auto y = static_cast<std::size_t>(at.link_begin(link) + at.y(End::rear, 0)), vx = x + half, vy = y + half;
        EXPECT_NEAR(std::hypot(after[vx], after[vy]) / std::hypot(before[vx], before[vy]), is->driving / was->driving, 1e-3) << link;
        if (before[x] > -0.01) continue;  // on the driving arc
        EXPECT_NEAR(std::hypot(after[x], after[y]) - std::hypot(before[x], before[y]), wider, 0.05 * std::abs(wider)) << link;
    }
    ASSERT_TRUE(shift_ratio(p, 1.3 * 1.01, 1.3, after.data()));
    const auto motion = static_cast<std::size_t>(at.links * at.link_block());
    for (std::size_t k = 0; k < motion; ++k) {
        const bool place = static_cast<int>(k) % at.link_block() < at.link_size();
        EXPECT_NEAR(after[k], before[k], place ? 1e-6 : 1e-3 * 200.0 * was->driving) << k;
    }
}

INSTANTIATE_TEST_SUITE_P(OfPins, ShiftRatio, testing::Values(PinDetail::rigid, PinDetail::halves));

}  // namespace
}  // namespace cvtflow::model
