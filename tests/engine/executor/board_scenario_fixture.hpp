#pragma once
/// A graph on a board of resident workers of the model machine (interleaving_fixture.hpp), with a check of everything that may go wrong.

#include <memory>
#include <string>
#include <vector>

#include "engine/executor/run.hpp"
#include "interleaving_fixture.hpp"

namespace cvtflow::engine::test {

/// A graph, and its cycles to run one after the other.
struct BoardCase {
    std::string name;
    std::vector<int> cycles;
    TaskGraph graph{};
    std::vector<std::vector<int>> before{};  ///< [task] its predecessors

    /// Adds a task to the last cycle, or to a new one.
    int add(int cycle, const std::vector<int>& predecessors);
};
/// Widths of the levels of one cycle, every task waiting for all of the level before; run `times` times.
[[nodiscard]] BoardCase layers(const std::vector<int>& widths, std::size_t times);
/// Two cycles in turns: of a task, and of two tasks and one behind them.
[[nodiscard]] BoardCase turns();

/// Tasks write a cell of their own and read those of their predecessors and the controller's; the controller reads all and writes its own:
/// whatever runs too early, twice, or without seeing what it should is a race or is counted.
class BoardScenario : public Scenario, public Controller {
public:
    [[nodiscard]] std::string fault() final;
    int next() noexcept final;
    /// Body of all tasks; the context of their run is the scenario.
    static void body(void* scenario, int task) noexcept { static_cast<BoardScenario*>(scenario)->run_task(task); }

protected:
    explicit BoardScenario(const BoardCase& what);
    Run run_;
    const BoardCase& what_;

private:
    [[nodiscard]] int controller() const { return static_cast<int>(what_.before.size()); }
    [[nodiscard]] int cycle() const { return what_.cycles[static_cast<std::size_t>(epoch_ - 1)]; }
    void run_task(int task) noexcept;

    std::size_t left_;
    std::vector<long> epochs_;  ///< [task] in which it ran last
    long epoch_ = 1;
    bool over_ = false;
    const char* wrong_ = "";
};

template <class Board>
class ScenarioOf final : public BoardScenario {
public:
    ScenarioOf(const BoardCase& what, int workers) : BoardScenario(what), board_(run_, {.threads = workers}, what.cycles.front()) {}
    void work(int worker) noexcept override { board_.work(worker); }

private:
    Board board_;
};

/// All interleavings of a case on a board. The last `missing` of the `options.workers` workers that the board expects never come.
template <class Board>
[[nodiscard]] Interleavings::Outcome explore(const BoardCase& what, Interleavings::Options options, int missing = 0) {
    const int expected = options.workers;
    options.workers -= missing;
    return Interleavings::explore(options, [&] { return std::make_unique<ScenarioOf<Board>>(what, expected); });
}

}  // namespace cvtflow::engine::test
