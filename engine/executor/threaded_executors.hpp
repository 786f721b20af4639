#pragma once
/// Executors that need threads, and with them a runtime. The core library has none (engine/alone).

#include <span>

#include "engine/executor/catalogue.hpp"

namespace cvtflow::engine {

/// In the order of the catalogue, after `serial`; those whose runtime was not found have no `make`.
[[nodiscard]] std::span<const ExecutorRow> threaded_executors() noexcept;

}  // namespace cvtflow::engine
