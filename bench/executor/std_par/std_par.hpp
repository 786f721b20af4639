#pragma once
/// The standard library's parallel algorithms: the plainest thing that a C++ programmer can write.

#include "engine/executor/run.hpp"

namespace cvtflow::bench {

/// One std::for_each(std::execution::par) per level. libstdc++ runs it as a parallel_for of oneTBB, whose own choice of chunks it takes;
/// for that it has to stay in our arena and below our context, about which the standard's algorithms know nothing.
class StdPar final : public engine::RunningExecutor {
public:
    explicit StdPar(const engine::ExecutorOptions& options) : engine::RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "std_par"; }

private:
    void execute(engine::Run& run, int first) override;
};

}  // namespace cvtflow::bench
