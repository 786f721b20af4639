#include "engine/executor/run.hpp"

#include <stdexcept>
#include <string>

namespace cvtflow::engine {

namespace {

/// Marks beginning and end of a run, however it ends.
class RunMarks {
public:
    explicit RunMarks(StampRecorder* recorder) noexcept : recorder_(recorder) {
        if (recorder_ != nullptr) recorder_->mark_all(span_enter);
    }
    ~RunMarks() {
        if (recorder_ != nullptr) recorder_->mark_all(span_exit);
    }
    RunMarks(const RunMarks&) = delete;
    RunMarks& operator=(const RunMarks&) = delete;

private:
    StampRecorder* recorder_;
};

}  // namespace

int Run::decide(int thread) noexcept {
    for (;;) {
        const std::int64_t begin = recorder_ == nullptr ? 0 : ticks();
        const int cycle = controller_.next();
        if (recorder_ != nullptr) recorder_->add(thread, span_controller, begin, ticks());
        if (cycle == Controller::stop) return cycle;
        if (cycle < 0 || cycle >= graph_.cycles()) {
            rejected_ = cycle;
            return Controller::stop;
        }
        if (!graph_.topological(cycle).empty()) return cycle;
    }
}

void Run::reject() const {
    if (rejected_ == Controller::stop) return;
    throw std::out_of_range("executor: the controller asked for cycle " + std::to_string(rejected_) + " of " +
                            std::to_string(graph_.cycles()));
}

RunningExecutor::RunningExecutor(const ExecutorOptions& options) : options_(options) {
    if (options.threads < 1) throw std::invalid_argument("executor: needs at least one thread");
    if (options.recorder != nullptr && options.recorder->threads() < options.threads) {
        throw std::invalid_argument("executor: the recorder has fewer tracks than there are threads");
    }
}

void RunningExecutor::run(const TaskGraph& graph, void* context, Controller& controller) {
    if (!graph.frozen()) throw std::logic_error("executor: the graph is not frozen");
    Run run(graph, context, controller, options_.recorder);
    {
        const RunMarks marks(options_.recorder);
        const int first = run.decide(0);
        if (first != Controller::stop) execute(run, first);
    }
    run.reject();
}

}  // namespace cvtflow::engine
