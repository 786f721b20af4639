#pragma once
/// A controller that can be left between two steps and taken up again, by another executor, with other segments.

#include <chrono>

#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

/// Decides whether a run rests. Called between cycles: allocates nothing, throws nothing.
class RestJudge {
public:
    virtual ~RestJudge() = default;
    /// Time after which to ask [s].
    [[nodiscard]] virtual double window() const noexcept = 0;
    /// @param seconds since the last question or since the run was taken up   @param per_cycle without the first steps [s]
    [[nodiscard]] virtual bool rest(double seconds, double per_cycle) noexcept = 0;

protected:
    RestJudge() = default;
    RestJudge(const RestJudge&) = default;
    RestJudge& operator=(const RestJudge&) = default;
};

/// Passes the step controller's decisions on. At the end of every fourth step it reads the clock, and at the end of a window it asks the
/// judge. To rest, it holds back the next step's first cycle and returns stop; the next Executor::run() begins with that cycle. What the
/// step controller has prepared for it lies in the workspace and knows nothing of segments, so results are bitwise those of an unbroken
/// run.
class RestingController final : public engine::Controller {
public:
    RestingController(StepController& whole, RestJudge& judge) : whole_(whole), judge_(judge) {}

    [[nodiscard]] int next() noexcept override;
    /// Whether the step controller has returned stop: the run is complete.
    [[nodiscard]] bool over() const noexcept { return over_; }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr int stride = 4;  ///< steps between readings of the clock; the first stride is not counted because threads start then

    [[nodiscard]] bool rests() noexcept;

    StepController& whole_;
    RestJudge& judge_;
    bool over_ = false;
    int held_ = stop;             ///< cycle kept back
    long steps_ = 0, looks_ = 0;  ///< steps seen; looks since the run was taken up
    long cycles_ = 0;             ///< since `counted_`
    Clock::time_point taken_up_ = Clock::now(), counted_ = taken_up_;
};

}  // namespace cvtflow::tasks
