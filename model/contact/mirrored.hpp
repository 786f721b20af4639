#pragma once
/// Products with the inverse of a mass matrix by its symmetries, over lanes.

#include "model/basis/lanes.hpp"
#include "model/contact/contact_field.hpp"

namespace cvtflow::model {
namespace {

/// product = inverse force: `size` modes of the rear pin, then those of the front pin.
template <int size, class Number, class V>
inline void multiply_ends(const MirroredInverseOf<Number>& inverse, const V* force, V* product) noexcept {
    V both[size], apart[size];
    for (int m = 0; m < size; ++m) {
        both[m] = force[m] + force[size + m];
        apart[m] = force[m] - force[size + m];
    }
    for (int m = 0; m < size; ++m) {
        const Number* sum = inverse.sum.data() + m * max_lateral;
        const Number* difference = inverse.difference.data() + m * max_lateral;
        V together = sum[m % 2] * both[m % 2], opposed = difference[m % 2] * apart[m % 2];
        for (int k = m % 2 + 2; k < size; k += 2) {
            together += sum[k] * both[k];
            opposed += difference[k] * apart[k];
        }
        product[m] = together + opposed;
        product[size + m] = together - opposed;
    }
}

}  // namespace
}  // namespace cvtflow::model
