#pragma once
/// x^(10/9), Palmgren's law, from basic operations: the same bits on every processor, which the C library's pow is not.

#include <cstdint>
#include <cstring>

namespace cvtflow::model {
namespace {

/// x ≥ 0; below 1e-290 nothing. Within two units of the last place, where the result is no denormal number. x [1]
[[nodiscard]] inline double ten_ninths(double x) noexcept {
    if (!(x >= 1e-290)) return x < 1e-290 ? 0.0 : x;  // not a number stays one
    // The ninth root: a ninth of the number's bits is within 3.4 %; Halley's method then takes an error e to 20/3 e³.
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits = bits / 9 + 0x38d4b17e4b17e55cu;  // eight ninths of the bits of 1, moved so that errors of both signs are equal
    double root;                            ///< the ninth root [1]
    std::memcpy(&root, &bits, sizeof root);
    for (int iteration = 0; iteration < 3; ++iteration) {
        const double square = root * root, fourth = square * square, ninth = fourth * fourth * root;
        root += root * ((x - ninth) / (5.0 * ninth + 4.0 * x));
    }
    return x * root;
}

}  // namespace
}  // namespace cvtflow::model
