#pragma once
/// Counts calls of malloc and its relatives, whoever makes them.

namespace cvtflow::engine::test {

/// Calls so far by the whole program, or -1 where a sanitizer owns malloc and nothing can be counted.
[[nodiscard]] long allocation_count() noexcept;

}  // namespace cvtflow::engine::test
