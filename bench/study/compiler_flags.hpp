#pragma once
#include <string>

namespace cvtflow::bench {

/// Flags that this program was compiled with.
[[nodiscard]] std::string compiler_flags();

}  // namespace cvtflow::bench
