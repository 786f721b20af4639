#pragma once
/// Accelerations of a link from its generalized forces. (model/EQUATIONS.md section 2)

#include <cstring>

#include "model/basis/lanes.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Replaces `blocks` vectors of N numbers, N apart, by their products with the inverse: its columns times the vector's numbers, summed in
/// their order. Each column is loaded once for all blocks.
template <int N, int blocks>
inline void multiply(const SmallInverse& inverse, double* f) noexcept {
    constexpr int width = padded(N);
    std::array<Lanes<width>, blocks> total;
    for (int k = 0; k < N; ++k) {
        const auto column = load<width>(inverse.column.data() + k * width);
        for (std::size_t block = 0; block < blocks; ++block) {
            const auto term = f[static_cast<int>(block) * N + k] * column;
            total[block] = k == 0 ? term : total[block] + term;
        }
    }
    for (std::size_t block = 0; block < blocks; ++block) {
        alignas(64) double buffer[width];
        total[block].copy_to(buffer);
        std::memcpy(f + block * N, buffer, N * sizeof(double));
    }
}

/// Accelerations of a link from its generalized forces, in place. f [in: N, N·m; out: m/s², rad/s²]
template <int P>
inline void accelerate(const LinkInertia& inertia, double* f) noexcept {
    multiply<2 * (P + 1), 2>(inertia.lateral, f);
    multiply<4, 1>(inertia.axial, f + 4 * (P + 1));
}

}  // namespace
}  // namespace cvtflow::model
