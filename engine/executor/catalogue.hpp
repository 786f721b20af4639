#pragma once
/// The executors this program knows: one row each in catalogue.cpp.

#include <memory>
#include <span>
#include <string_view>

#include "engine/executor/executor.hpp"

namespace cvtflow::engine {

struct ExecutorRow {
    std::string_view name;
    std::string_view description;                    ///< one line for users
    bool parallel;                                   ///< whether more than one thread is of use
    std::unique_ptr<Executor> (*make)(int threads);  ///< threads ≥ 1, the calling thread included
};

[[nodiscard]] std::span<const ExecutorRow> executors() noexcept;

/// The row of that name, or nullptr.
[[nodiscard]] const ExecutorRow* find_executor(std::string_view name) noexcept;

}  // namespace cvtflow::engine
