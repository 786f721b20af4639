/// Pins of unequal length in a run: which pins press harder, at which order it shows, that energy closes; and bits, also with unbalance.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "model/machine/coefficients.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene imperfect_scene(const std::string& detail, const std::vector<std::string>& more) {
    return scene_of("tiny", detail, {"start.settling_time=6 ms", "start.ramp_time=3 ms", "run.method=auto", "run.output_interval=50 us"},
                    more);
}

/// Force of each pin on the sheaves while it touches, and place of a movable sheave over time.
class PressingObserver final : public RunObserver {
public:
    explicit PressingObserver(const Simulation& of) : observer_(of.workspace().variator), links_(of.workspace().layout().links) {
        sum_.resize(static_cast<std::size_t>(links_)), count_.resize(sum_.size());
    }
    void output(double time, const Workspace& workspace, const Counters&) override {
        const model::Observation& now = workspace.observed_by(observer_, time);
        times_.push_back(time), sheave_.push_back(now.sheave_position[0]), speed_ += now.chain_speed;
        tension_ += 0.5 * (now.tight + now.slack);
        for (std::size_t link = 0; link < sum_.size(); ++link) {
            const double force = 0.5 * (std::abs(now.tip_axial[4 * link]) + std::abs(now.tip_axial[4 * link + 1]));  // rear: of pin `link`
            if (force > 0.0) sum_[link] += force, ++count_[link];
        }
    }
    void transition(const TransitionRecord&) override {}

    void subtract(const PressingObserver& other) {
        for (std::size_t k = 0; k < sheave_.size(); ++k) sheave_[k] -= other.sheave_[k];
    }
    [[nodiscard]] double mean_force(std::size_t pin) const { return sum_[pin] / count_[pin]; }
    [[nodiscard]] double chain_speed() const { return speed_ / static_cast<double>(times_.size()); }
    [[nodiscard]] double tension() const { return tension_ / static_cast<double>(times_.size()); }
    /// Amplitude of the sheave's place at a frequency, under Hann's window: the drift of the ratio is not periodic. [Hz]
    [[nodiscard]] double amplitude(double frequency) const {
        double mean = 0.0;
        for (const double place : sheave_) mean += place / static_cast<double>(sheave_.size());
        const double radian = 2.0 * std::numbers::pi;
        std::complex<double> sum;
        for (std::size_t k = 0; k < times_.size(); ++k)
            sum += (1.0 - std::cos(radian * (static_cast<double>(k) + 0.5) / static_cast<double>(times_.size()))) * (sheave_[k] - mean) *
                   std::polar(1.0, -radian * frequency * times_[k]);
        return 2.0 * std::abs(sum) / static_cast<double>(times_.size());
    }

private:
    model::Observer observer_;
    int links_;
    std::vector<double> sum_, count_, times_, sheave_;
    double speed_ = 0.0, tension_ = 0.0;
};

struct Line {
    double slope;        ///< slope of force over λ [N/m]
    double correlation;  ///< correlation of force and λ
};
Line regression(const std::vector<double>& x, const std::vector<double>& y) {
    const double n = static_cast<double>(x.size());
    double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) mx += x[k] / n, my += y[k] / n;
    for (std::size_t k = 0; k < x.size(); ++k)
        xx += (x[k] - mx) * (x[k] - mx), xy += (x[k] - mx) * (y[k] - my), yy += (y[k] - my) * (y[k] - my);
    return {xy / xx, xy / std::sqrt(xx * yy)};
}

constexpr double turn = 58.3e-3;  ///< turn of the chain of `tiny`, about [s]

class UnequalPins : public testing::TestWithParam<std::string> {
protected:
    [[nodiscard]] static Scene scene(const std::string& spread, const std::string& settling) {
        return imperfect_scene(GetParam(), {"start.settling_time=" + settling, "imperfection.pin_length_spread=" + spread});
    }
};

/// A pin that is longer by λ at both ends climbs by λ/tan β, out of the line of its neighbours: the tension T of the strands pulls it back
/// with T/p for each of both, a string's stiffness, and it presses the flanks apart by as much over 2 tan β at each end, which two halves
/// share. Bending of the links adds to that. Against the same run with equal pins, whose forces differ because the ratio drifts.
TEST_P(UnequalPins, PressWhereTheyStandOutOfLine) {
    const Scene unequal = scene("1 um", "60 ms"), equal = scene("0", "60 ms");
    Simulation with(unequal), without(equal);
    PressingObserver seen(with), before(without);
    settle_and_go(with, 1.1 * turn, seen);
    settle_and_go(without, 1.1 * turn, before);
    const std::vector<double> longer = model::longer_halves(unequal.parameters);
    const std::size_t pins = longer.size();
    std::vector<double> force, out;
    for (std::size_t pin = 0; pin < pins; ++pin) {
        force.push_back(seen.mean_force(pin) - before.mean_force(pin));
        out.push_back(2.0 * longer[pin] - longer[(pin + 1) % pins] - longer[(pin + pins - 1) % pins]);
    }
    const Line line = regression(out, force);
    const double tangent = std::tan(unequal.parameters.tip.angle),
                 pitch = model::chain_length(unequal.parameters.chain) / static_cast<double>(pins);
    const double string = seen.tension() / (4.0 * pitch * tangent * tangent);
    RecordProperty("slope", std::to_string(line.slope / string));
    RecordProperty("correlation", std::to_string(line.correlation));
    EXPECT_GT(line.correlation, 0.7);
    EXPECT_GT(line.slope, 0.7 * string);
    EXPECT_LT(line.slope, 3.0 * string);
    EXPECT_LE(with.workspace().energy.balance_error_ratio(), 1.0);
}

TEST_P(UnequalPins, AndUnbalanceContinueBitForBitAndAreDrawnByTheirSeed) {
    const auto scene = [](const std::string& seed) {
        return imperfect_scene(GetParam(), {"imperfection.pin_length_spread=1 um", "imperfection.unbalance=1 g*m",
                                            "start.settling_time=1 ms", "start.ramp_time=0.5 ms", "imperfection.pin_length_seed=" + seed});
    };
    EXPECT_NE(expect_continued(scene("1"), 2e-4, 4e-4).state, expect_continued(scene("2"), 2e-4, 4e-4).state);
}

/// Equal pins repeat with every pin, others with every turn of the chain: they move the sheaves apart by their mean over the arc. (Force
/// does not show that, as cylinders hold it.) What lengths change shows at whole orders of the chain's turns, and not between them.
TEST(UnequalPinsOfAChain, MoveTheSheavesOnceAroundTheChain) {
    const auto scene = [](const std::string& spread) {
        return imperfect_scene("rigid", {"start.settling_time=60 ms", "imperfection.pin_length_spread=" + spread});
    };
    const Scene unequal = scene("1 um"), equal = scene("0");
    Simulation with(unequal), without(equal);
    PressingObserver seen(with), before(without);
    settle_and_go(with, 4.0 * turn, seen);
    settle_and_go(without, 4.0 * turn, before);
    seen.subtract(before);
    const double once = seen.chain_speed() / model::chain_length(unequal.parameters.chain);
    double at_orders = 0.0, between = 0.0;
    for (const double order : {2.0, 3.0, 4.0}) {
        at_orders += std::pow(seen.amplitude(order * once), 2);
        between += std::pow(seen.amplitude((order + 0.5) * once), 2);
    }
    RecordProperty("orders", std::to_string(1e9 * std::sqrt(at_orders)));
    RecordProperty("between", std::to_string(1e9 * std::sqrt(between)));
    EXPECT_GT(std::sqrt(at_orders), 5.0 * std::sqrt(between));
    EXPECT_GT(std::sqrt(at_orders), 0.05e-6) << "lengths deviate by 1 um";
}

INSTANTIATE_TEST_SUITE_P(Levels, UnequalPins, testing::Values("rigid", "fine"), [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace cvtflow::tasks
