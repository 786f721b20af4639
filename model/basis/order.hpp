#pragma once
/// Polynomial orders of a pin's bending, for which kernels are compiled.

namespace cvtflow::model {

inline constexpr int max_order = 3;

/// What make.operator()<P>() gives for P = order.
/// @param order 0 … max_order [1]
template <class Make>
constexpr auto of_order(int order, Make make) noexcept {
    static_assert(max_order == 3);
    switch (order) {
        case 0: return make.template operator()<0>();
        case 1: return make.template operator()<1>();
        case 2: return make.template operator()<2>();
        default: return make.template operator()<3>();
    }
}

}  // namespace cvtflow::model
