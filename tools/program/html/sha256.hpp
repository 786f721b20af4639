#pragma once
/// SHA-256 (FIPS 180-4), by which a page's policy names the scripts that may run.

#include <array>
#include <cstddef>
#include <span>

namespace cvtflow::tools {

[[nodiscard]] std::array<std::byte, 32> sha256(std::span<const std::byte> bytes);

}  // namespace cvtflow::tools
