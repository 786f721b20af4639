#include "model/basis/order.hpp"
#include "model/contact/slip/slip_chain.hpp"
#include "model/contact/slip/slip_geometry.hpp"
#include "model/contact/slip/slip_newton.hpp"
#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

namespace {

template <int Points>
void gather(const SlipSpace& space, const ContactField& field, const Phase* phases, double g, SlipGroup& group) noexcept {
    SlipRows<Points>(space, group).gather(field, phases);
    SlipCoupling<Points>(space, group).couple(g);
}

template <int P, int Points>
void slips(const SlipSpace& space, double time, SlipGroup& group, LaneRows& own) noexcept {
    SlipGeometry<P, Points>(space, group).slips(time, own);
}

template <int Points>
void forces(const SlipSpace& space, SlipGroup& group) noexcept {
    SlipNewton<Points, true>(space, group).forces();
}

template <int P, int Points>
void accelerate(const SlipSpace& space, SlipGroup& group) noexcept {
    SlipGeometry<P, Points>(space, group).accelerate();
}

/// Calls body with the group's Newton step; whether any of its tips touches is a constant for the compiler.
template <int Points, class Body>
void newton(const SlipSpace& space, SlipGroup& group, const Body& body) noexcept {
    if (group.touching) {
        body(SlipNewton<Points, true>(space, group));
    } else {
        body(SlipNewton<Points, false>(space, group));
    }
}

template <int P, int Points>
void respond(const SlipSpace& space, const LaneRows& force, SlipGroup& group, LaneRows& own) noexcept {
    SlipGeometry<P, Points>(space, group).respond(force, own);
}

template <int Points>
void linearise(const SlipSpace& space, SlipGroup& group) noexcept {
    newton<Points>(space, group, [](auto step) noexcept { step.linearise(); });
}

template <int Points>
void eliminate(const SlipSpace& space, SlipGroup& group) noexcept {
    newton<Points>(space, group, [](auto step) noexcept { step.eliminate(); });
}

template <int Points>
void join(const SlipSpace& space, std::span<const SlipGroup> groups, SlipChain& chain) noexcept {
    SlipElimination<Points>(space.contacts(), groups, chain).solve();
}

template <int Points>
void substitute(const SlipSpace& space, const float* unknowns, SlipGroup& group) noexcept {
    newton<Points>(space, group, [unknowns](auto step) noexcept { step.substitute(unknowns); });
}

template <int Points>
void search(const SlipSpace& space, double share, SlipGroup& group) noexcept {
    newton<Points>(space, group, [share](auto step) noexcept { step.search(share); });
}

template <int P, int Points>
[[nodiscard]] SlipKernels kernels() noexcept {
    return {gather<Points>,    slips<P, Points>,   forces<Points>, accelerate<P, Points>, linearise<Points>,
            eliminate<Points>, respond<P, Points>, join<Points>,   substitute<Points>,    search<Points>};
}

template <int Points>
[[nodiscard]] SlipKernels kernels_of_order(int order) noexcept {
    return of_order(order, []<int P>() { return kernels<P, Points>(); });
}

}  // namespace

/// One and three points are what ready levels of detail have; any other number works as well, slower.
template <>
SlipKernels slip_kernels<compiled_isa>(int order, int points) noexcept {
    switch (points) {
        case 1: return kernels_of_order<1>(order);
        case 3: return kernels_of_order<3>(order);
        default: return kernels_of_order<0>(order);
    }
}

}  // namespace cvtflow::model
