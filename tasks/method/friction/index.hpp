#pragma once
/// Stages and slots are counted in int, as everywhere; the standard library indexes by size_t.

#include <cstddef>

namespace cvtflow::tasks {

[[nodiscard]] inline std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }

}  // namespace cvtflow::tasks
