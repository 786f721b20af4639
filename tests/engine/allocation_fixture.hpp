#pragma once
/// Counts all calls of malloc and its relatives.

namespace cvtflow::engine::test {

/// Calls so far by the whole program, or -1 where a sanitizer owns malloc and nothing can be counted.
[[nodiscard]] long allocation_count() noexcept;

}  // namespace cvtflow::engine::test
