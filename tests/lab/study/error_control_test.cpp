/// Steps by error, reused slopes and methods that follow the spectrum, by the errors and the spectrum that the laboratory measures.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/study/error_measure.hpp"
#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/frozen_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using test::settled_tiny;

const engine::Cancellation not_cancelled;

std::vector<std::string> with(const std::string& method, const std::string& step, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"run.method=" + method, "run.step=" + step});
    return more;
}

/// Against steps that evaluate every stage, with the phases held. Times of stages differ in the last digit.
TEST(ReusedSlopes, AreThoseThatWouldBeEvaluated) {
    Simulation simulation(settled_tiny(with("dumka3-p1", "50ns", {"run.output_interval=1us", "run.state_interval=1us"})));
    SilentObserver silent;
    FrozenStart start = bench::frozen_start(simulation);
    ASSERT_FALSE(simulation.advance({.until = simulation.time() + 1e-6, .new_part = true}, silent, not_cancelled));
    for (int window = 0; simulation.counters().truncated > 0 && window < 40; ++window) {  // until one has no transition
        start = bench::frozen_start(simulation);
        ASSERT_FALSE(simulation.advance({.until = simulation.time() + 1e-6, .new_part = true}, silent, not_cancelled));
    }
    ASSERT_EQ(simulation.counters().truncated, 0);
    ASSERT_EQ(simulation.counters().steps, 20);
    bench::FrozenStepper stepper(simulation.workspace().variator, *engine::find_method("dumka3-p1"), start.phases);
    stepper.advance(start.time, 5e-8, 20, start.state);
    for (std::size_t k = 0; k < start.state.size(); ++k)
        EXPECT_NEAR(simulation.workspace().state()[k], start.state[k], 1e-10 * std::abs(start.state[k]) + 1e-12) << k;
}

TEST(ErrorControl, TighterTolerancesAreMoreExact) {
    bench::MeasureSettings settings;
    settings.duration = 24e-6;
    const bench::ErrorMeasure measure(settled_tiny(), settings, not_cancelled);
    for (const char* method : {"dopri54", "dumka3-p3", "rkc-s10"}) {
        double last = 1e300;
        for (const char* tolerance : {"1", "1e-2", "1e-4"}) {
            const bench::Trajectory run =
                measure.run(with(method, "1us", {"run.step_control=error", std::string("run.tolerance=") + tolerance}));
            ASSERT_FALSE(run.fault) << method << ": " << run.fault.message();
            const double error = measure.errors(run).overall.axial_force;
            EXPECT_LT(error, last) << method << ' ' << tolerance;
            last = error;
        }
        EXPECT_LT(last, 1e-4) << method;
    }
}

/// The dense spectrum of the same state. Power iteration comes from below.
TEST(SpectralBound, IsTheExtentOfTheSpectrum) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = bench::frozen_start(simulation);
    SpectralBound bound(simulation.workspace().variator);
    const int evaluations = bound.estimate(start.time, start.state.data(), start.phases.data());
    EXPECT_LE(evaluations, 301);
    double real = 0.0, imaginary = 0.0;
    for (const auto& value : bench::spectrum(simulation.workspace().variator, start.time, start.state, start.phases)) {
        real = std::max(real, -value.real());
        imaginary = std::max(imaginary, std::abs(value.imag()));
    }
    RecordProperty("real", std::to_string(bound.real() / real));
    RecordProperty("imaginary", std::to_string(bound.imaginary() / imaginary));
    EXPECT_GT(bound.real(), 0.85 * real);
    EXPECT_LT(bound.real(), 1.1 * real);
    EXPECT_GT(bound.imaginary(), 0.8 * imaginary);
    EXPECT_LT(bound.imaginary(), 1.5 * imaginary);
    EXPECT_LE(bound.estimate(start.time, start.state.data(), start.phases.data()), 31) << "a warm start is cheap";
}

TEST(SpectralMethods, StayStableAtStepsFarBeyondThoseOfRk4) {
    bench::MeasureSettings settings;
    settings.duration = 24e-6;
    const bench::ErrorMeasure measure(settled_tiny(), settings, not_cancelled);
    for (const char* method : {"dumka3", "rkc", "fitted"}) {
        const bench::Trajectory run = measure.run(with(method, "500ns"));
        ASSERT_FALSE(run.fault) << method << ": " << run.fault.message();
        EXPECT_LT(measure.errors(run).overall.tension, 1e-2) << method;
    }
}

}  // namespace
}  // namespace cvtflow::tasks
