#include "engine/executor/catalogue.hpp"

#include <algorithm>
#include <array>

#include "engine/executor/serial.hpp"

namespace cvtflow::engine {

namespace {

constexpr std::array all{
    ExecutorRow{"serial", "one task after the other, on the calling thread", false,
                [](int) -> std::unique_ptr<Executor> { return std::make_unique<Serial>(); }},
};

}  // namespace

std::span<const ExecutorRow> executors() noexcept { return all; }

const ExecutorRow* find_executor(std::string_view name) noexcept {
    const auto found = std::find_if(all.begin(), all.end(), [&](const ExecutorRow& row) { return row.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace cvtflow::engine
