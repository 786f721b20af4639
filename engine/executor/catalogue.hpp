#pragma once
/// The executors this program knows: one row each in catalogue.cpp.

#include <memory>
#include <span>
#include <string_view>

#include "engine/executor/executor.hpp"
#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine {

struct ExecutorRow {
    std::string_view name;
    std::string_view description;  ///< one line for users
    bool parallel;                 ///< whether more than one thread is of use
    /// @throws std::invalid_argument for less than one thread or a recorder with fewer tracks than threads
    std::unique_ptr<Executor> (*make)(const ExecutorOptions& options);
};

/// Without OpenMP at compile time its rows are missing.
[[nodiscard]] std::span<const ExecutorRow> executors() noexcept;

/// The row of that name, or nullptr.
[[nodiscard]] const ExecutorRow* find_executor(std::string_view name) noexcept;

}  // namespace cvtflow::engine
