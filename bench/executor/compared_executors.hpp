#pragma once
/// Executors that the laboratory compares with those of the program. A source has the runtime's ways to run a graph, and their rows; where
/// the runtime is not installed, their rows without a function.

#include <memory>
#include <string>
#include <vector>

#include "engine/executor/catalogue.hpp"
#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// A name, and how it runs a graph: `execute` as RunningExecutor::execute().
struct Way {
    std::string_view name;
    void (*execute)(engine::Run& run, const engine::ExecutorOptions& options, int first);
    void (*release)() noexcept = nullptr;  ///< Executor::release_threads(), if there is anything to do
};

class ComparedExecutor final : public engine::RunningExecutor {
public:
    ComparedExecutor(const Way& way, const engine::ExecutorOptions& options) : engine::RunningExecutor(options), way_(way) {}
    [[nodiscard]] std::string_view name() const noexcept override { return way_.name; }
    void release_threads() noexcept override {
        if (way_.release != nullptr) way_.release();
    }

private:
    void execute(engine::Run& run, int first) override { way_.execute(run, options(), first); }
    const Way& way_;
};

/// For ExecutorRow::make.
template <const Way& way>
std::unique_ptr<engine::Executor> make(const engine::ExecutorOptions& options) {
    return std::make_unique<ComparedExecutor>(way, options);
}

/// A runtime's version and rows.
struct Runtime {
    std::string version;  ///< "OpenMP 201511 of libgomp.so.1"; empty: not installed, or stated elsewhere
    std::vector<engine::ExecutorRow> rows;
};
[[nodiscard]] Runtime openmp_runtime();
[[nodiscard]] Runtime barrier_runtime();
[[nodiscard]] Runtime tbb_runtime();
[[nodiscard]] Runtime asio_runtime();
[[nodiscard]] Runtime taskflow_runtime();

}  // namespace cvtflow::bench
