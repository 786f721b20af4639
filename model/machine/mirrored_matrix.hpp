#pragma once
/// Matrices of a link by its symmetries: both ends are alike, and so are both halves of the pins' length.

#include <array>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Matrix [[a, b], [b, a]]: acts on the sum of both ends as a + b, on their difference as a - b; modes of even and odd order do not couple.
template <class Number>
struct MirroredMatrix {
    std::array<Number, axis_terms * axis_terms> sum{}, difference{};  ///< (a ± b)/2, rows axis_terms apart; where m + k is odd: 0
};

namespace {

/// Multiplies `size` modes of the rear pin, then those of the front pin. Product and vector may be the same.
template <int size, class Number, class V>
inline void multiply_ends(const MirroredMatrix<Number>& matrix, const V* vector, V* product) noexcept {
    V both[size], apart[size];
    for (int m = 0; m < size; ++m) {
        both[m] = vector[m] + vector[size + m];
        apart[m] = vector[m] - vector[size + m];
    }
    for (int m = 0; m < size; ++m) {
        const Number* sum = matrix.sum.data() + m * axis_terms;
        const Number* difference = matrix.difference.data() + m * axis_terms;
        V together = sum[m % 2] * both[m % 2], opposed = difference[m % 2] * apart[m % 2];
        for (int k = m % 2 + 2; k < size; k += 2) {
            together += sum[k] * both[k];
            opposed += difference[k] * apart[k];
        }
        product[m] = together + opposed;
        product[size + m] = together - opposed;
    }
}

/// Multiplies x, then y of a link along t = (tx, ty): one matrix acts along it, the other one across. They may be the same, too.
template <class Number, class V>
inline void multiply_turned(const MirroredMatrix<Number>& along, const MirroredMatrix<Number>& across, const V& tx, const V& ty,
                            const V* vector, V* product) noexcept {
    constexpr int size = 2 * axis_terms;
    V parallel[size], normal[size];
    for (int k = 0; k < size; ++k) {
        parallel[k] = tx * vector[k] + ty * vector[size + k];
        normal[k] = tx * vector[size + k] - ty * vector[k];
    }
    multiply_ends<axis_terms>(along, parallel, parallel);
    multiply_ends<axis_terms>(across, normal, normal);
    for (int k = 0; k < size; ++k) {
        product[k] = tx * parallel[k] - ty * normal[k];
        product[size + k] = ty * parallel[k] + tx * normal[k];
    }
}

}  // namespace
}  // namespace cvtflow::model
