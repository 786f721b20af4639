#include "bench/staged/one_link.hpp"
#include "bench/staged/staged_assembly.hpp"
#include "model/basis/isa.hpp"

namespace cvtflow::bench {

namespace {

using namespace cvtflow::model;

template <int P>
[[nodiscard]] const double* state_of(const StagedChain& chain, int link) noexcept {
    return chain.states + link * link_layout<P>.link_block();
}

template <int P>
[[nodiscard]] double* force_of(const StagedChain& chain, int link) noexcept {
    return chain.slope + link * link_layout<P>.link_block() + link_layout<P>.link_size();
}

template <int P>
[[nodiscard]] LinkFrame frame_of(const StagedChain& chain, int link) noexcept {
    return link_frame<P>(state_of<P>(chain, link), state_of<P>(chain, link) + link_layout<P>.link_size());
}

template <bool Observe>
[[nodiscard]] auto books([[maybe_unused]] const StagedChain& chain, [[maybe_unused]] int link, [[maybe_unused]] AccountPart part) noexcept {
    if constexpr (Observe)
        return SummingBooks{chain.accounts + account_parts * link + static_cast<int>(part)};
    else
        return NoBooks{};
}

/// Results are kept as plain doubles; these read and write them.
template <class Share>
[[nodiscard]] Share kept(const double* from) noexcept {
    Share share;
    std::memcpy(static_cast<void*>(&share), from, sizeof share);
    return share;
}
template <class Share>
void keep(const Share& share, double* to) noexcept {
    std::memcpy(to, &share, sizeof share);
}

template <int P, bool Observe>
void joint_of_pin(const ChainModel& model, const StagedChain& chain, int pin) noexcept {
    static_assert(sizeof(JointForce<P>) == (2 * (P + 1) + 4) * sizeof(double));
    const int before = model.layout().previous(pin);
    JointForce<P> force;
    auto of_joint = books<Observe>(chain, pin, AccountPart::joint);
    joint_part<P>(model.coefficients(), frame_of<P>(chain, before), frame_of<P>(chain, pin), state_of<P>(chain, before),
                  state_of<P>(chain, pin), force, of_joint);
    keep(force, chain.buffers->joints.data() + pin * chain.buffers->joint_stride);
}

template <int P, bool Observe>
void chain_forces(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    constexpr int size = link_layout<P>.link_size();
    for (int link = first; link < last; ++link) {
        const double* state = state_of<P>(chain, link);
        double* f = force_of<P>(chain, link);
        std::memcpy(f - size, state + size, size * sizeof(double));
        auto of_link = books<Observe>(chain, link, AccountPart::link);
        chain.buffers->moments[static_cast<std::size_t>(link)] =
            link_part<P>(model.coefficients(), link, frame_of<P>(chain, link), state, f, of_link);
        if (link > first) joint_of_pin<P, Observe>(model, chain, link);
    }
}

template <int P, bool Observe>
void contact(const ChainModel& model, const StagedChain& chain, int link) noexcept {
    static_assert(sizeof(TipShare<P>) == (4 * (P + 1) + 5) * sizeof(double));
    TipShare<P> share;
    auto of_tips = books<Observe>(chain, link, AccountPart::tips);
    tip_part<P>(model, frame_of<P>(chain, link), state_of<P>(chain, link), chain.sheaves, chain.phases + tips_per_link * link, share,
                chain.loads[link], of_tips);
    keep(share, chain.buffers->tips.data() + link * chain.buffers->tip_stride);
}

template <int P>
void forward_links(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    const StagedBuffers& buffers = *chain.buffers;
    for (int link = first; link < last; ++link) {
        const auto rear = kept<JointForce<P>>(buffers.joints.data() + link * buffers.joint_stride);
        const auto front = kept<JointForce<P>>(buffers.joints.data() + model.layout().next(link) * buffers.joint_stride);
        const bool touching = touches(chain.phases, link);
        const auto share = kept<TipShare<P>>(buffers.tips.data() + link * buffers.tip_stride);
        double* f = force_of<P>(chain, link);
        assemble<P>(frame_of<P>(chain, link), buffers.moments[static_cast<std::size_t>(link)], rear, front, touching ? &share : nullptr, f);
    }
}

template <int P>
void reverse_links(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    for (int link = first; link < last; ++link) accelerate<P>(model.inertia(), force_of<P>(chain, link));
}

template <int P>
[[nodiscard]] StagedFunctions functions_of(bool observe) noexcept {
    if (observe) return {chain_forces<P, true>, joint_of_pin<P, true>, contact<P, true>, forward_links<P>, reverse_links<P>};
    return {chain_forces<P, false>, joint_of_pin<P, false>, contact<P, false>, forward_links<P>, reverse_links<P>};
}

}  // namespace

template <>
StagedFunctions staged_kernels<compiled_isa>(bool observe) noexcept {
    return functions_of<axis_order>(observe);
}

}  // namespace cvtflow::bench
