#pragma once
/// The reference executor: one task after the other.

#include "engine/executor/executor.hpp"

namespace cvtflow::engine {

/// Runs every cycle in its topological order, on the calling thread.
class Serial final : public Executor {
public:
    void run(const TaskGraph& graph, void* context, Controller& controller) override;
    [[nodiscard]] std::string_view name() const noexcept override { return "serial"; }
};

}  // namespace cvtflow::engine
