#pragma once
/// The executors that programs use: one row each in catalogue.cpp and threaded_executors.cpp. A program may add rows, as the laboratory
/// does (bench/executor).

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/executor/executor.hpp"
#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine {

/// Setting that determines how an executor's threads wait for each other.
enum class Waiting {
    own,          ///< ExecutorOptions::wait
    environment,  ///< OMP_WAIT_POLICY and its relatives, read when the program is loaded
    fixed,        ///< the runtime, without a switch
};

struct ExecutorRow {
    std::string_view name;
    std::string_view description;  ///< one line for users
    bool parallel;                 ///< whether more than one thread is of use
    Waiting waiting;
    std::string_view needs = {};  ///< further requirements at build time; empty: none
    /// nullptr: what it needs was not found.
    /// @throws std::invalid_argument for less than one thread or a recorder with fewer tracks than threads
    std::unique_ptr<Executor> (*make)(const ExecutorOptions& options);
};

/// Executors that are in this program.
[[nodiscard]] std::span<const ExecutorRow> executors() noexcept;
/// Executors that are not, because a requirement was not found when the program was built.
[[nodiscard]] std::span<const ExecutorRow> absent_executors() noexcept;

/// Executors of the program that need threads, and with them a runtime; the core library has none (engine/alone). They follow `serial`.
[[nodiscard]] std::span<const ExecutorRow> threaded_executors() noexcept;

/// Adds rows to the catalogue, before anything else asks it: spans and rows that were handed out before are no longer valid.
void add_executors(std::span<const ExecutorRow> further);

/// The row of that name among executors(), or nullptr.
[[nodiscard]] const ExecutorRow* find_executor(std::string_view name) noexcept;

/// Whether only the laboratory's program has the executor of that name.
[[nodiscard]] bool executor_of_laboratory(std::string_view name) noexcept;
/// Reason why there is no executor of that name, as the end of a sentence: ": requires Taskflow …" for one that is absent, else the nearest
/// name: ` (did you mean "flow"?)`, or nothing. @param others words that are accepted instead of a name
[[nodiscard]] std::string missing_executor(std::string_view name, std::span<const std::string_view> others = {});

}  // namespace cvtflow::engine
