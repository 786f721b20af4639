#pragma once
/// Hook for a further force element of links, in kernels of both chains and in the exact Jacobian: CVTFLOW_FURTHER_ELEMENT names a header
/// that defines FurtherElement. The product has none, and compiles to the same instructions as without this hook. The worked example of the
/// recipe uses it (tests/recipes/damper.hpp, which states the functions of an element).

#ifdef CVTFLOW_FURTHER_ELEMENT
#include CVTFLOW_FURTHER_ELEMENT
#else
namespace cvtflow::model {
namespace {

struct FurtherElement {
    template <class... Given>
    static void of_halves(const Given&...) noexcept {}
    template <class... Given>
    static void of_rigid_pins(const Given&...) noexcept {}
};

}  // namespace
}  // namespace cvtflow::model
#endif
