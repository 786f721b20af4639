#pragma once
/// What a step method answers when it is asked what comes next.

namespace cvtflow::tasks {

/// A cycle of the step's graph, or none: the step is taken, or cannot be.
class NextCycle {
public:
    /// A cycle, by its number in the graph.
    constexpr NextCycle(int cycle) noexcept : cycle_(cycle) {}  // methods return their cycles' enumerators

    [[nodiscard]] static constexpr NextCycle done() noexcept { return {Answer::done, 0}; }
    [[nodiscard]] static constexpr NextCycle failed() noexcept { return {Answer::failed, 0}; }

    [[nodiscard]] constexpr bool is_cycle() const noexcept { return answer_ == Answer::cycle; }
    [[nodiscard]] constexpr bool is_done() const noexcept { return answer_ == Answer::done; }
    [[nodiscard]] constexpr bool has_failed() const noexcept { return answer_ == Answer::failed; }
    /// The number of the cycle, if there is one.
    [[nodiscard]] constexpr int cycle() const noexcept { return cycle_; }
    bool operator==(const NextCycle&) const = default;

private:
    enum class Answer { cycle, done, failed };
    constexpr NextCycle(Answer answer, int cycle) noexcept : answer_(answer), cycle_(cycle) {}

    Answer answer_ = Answer::cycle;
    int cycle_;
};

}  // namespace cvtflow::tasks
