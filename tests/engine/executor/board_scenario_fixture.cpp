#include "board_scenario_fixture.hpp"

namespace cvtflow::engine::test {

int BoardCase::add(int cycle, const std::vector<int>& predecessors) {
    const int task = graph.add({"t" + std::to_string(graph.size()), cycle, BoardScenario::body, graph.size(), {}});
    for (const int each : predecessors) graph.order(each, task);
    before.push_back(predecessors);
    return task;
}

BoardCase layers(const std::vector<int>& widths, std::size_t times) {
    BoardCase result{"layers", std::vector<int>(times, 0)};
    std::vector<int> before;
    for (const int width : widths) {
        result.name += " " + std::to_string(width);
        std::vector<int> level;
        for (int i = 0; i < width; ++i) level.push_back(result.add(0, before));
        before = level;
    }
    result.name += ", " + std::to_string(times) + " times";
    result.graph.freeze();
    return result;
}

BoardCase turns() {
    BoardCase result{"turns", {1, 0}};
    result.add(0, {});
    const int one = result.add(1, {}), other = result.add(1, {});
    result.add(1, {one, other});
    result.graph.freeze();
    return result;
}

BoardScenario::BoardScenario(const BoardCase& what)
    : run_(what.graph, this, *this, nullptr), what_(what), left_(what.cycles.size() - 1), epochs_(what.before.size()) {
    for (std::size_t cell = 0; cell <= what.before.size(); ++cell) static_cast<void>(Interleavings::memory().add_cell());
}

std::string BoardScenario::fault() {
    const std::string wrong = wrong_;
    return wrong.empty() && !over_ ? "cycles are missing:" : wrong;
}

int BoardScenario::next() noexcept {
    for (const int task : what_.graph.topological(cycle())) {
        Interleavings::memory().touch(task, false);
        if (epochs_[static_cast<std::size_t>(task)] != epoch_) wrong_ = "the controller was asked before all tasks had run:";
    }
    Interleavings::memory().touch(controller(), true);
    if (over_) wrong_ = "the controller was asked after it had said stop:";
    over_ = left_ == 0;
    if (over_) return stop;
    --left_, ++epoch_;
    return cycle();
}

void BoardScenario::run_task(int task) noexcept {
    Interleavings::memory().touch(controller(), false);
    if (what_.graph.task(task).cycle != cycle()) wrong_ = "a task of another cycle ran:";
    for (const int before : what_.before[static_cast<std::size_t>(task)]) {
        Interleavings::memory().touch(before, false);
        if (epochs_[static_cast<std::size_t>(before)] != epoch_) wrong_ = "a task ran before its predecessor:";
    }
    Interleavings::memory().touch(task, true);
    long& epoch = epochs_[static_cast<std::size_t>(task)];
    if (epoch == epoch_) wrong_ = "a task ran twice:";
    epoch = epoch_;
}

}  // namespace cvtflow::engine::test
