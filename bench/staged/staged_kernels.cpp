#include "bench/staged/one_link.hpp"
#include "bench/staged/staged_assembly.hpp"
#include "model/basis/isa.hpp"

namespace cvtflow::bench {

namespace {

using namespace cvtflow::model;

[[nodiscard]] const double* state_of(const StagedChain& chain, int link) noexcept { return chain.states + link * link_layout.link_block(); }

[[nodiscard]] double* force_of(const StagedChain& chain, int link) noexcept {
    return chain.slope + link * link_layout.link_block() + link_layout.link_size();
}

[[nodiscard]] LinkFrame frame_of(const StagedChain& chain, int link) noexcept {
    return link_frame(state_of(chain, link), state_of(chain, link) + link_layout.link_size());
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

template <bool Observe>
void joint_of_pin(const ChainModel& model, const StagedChain& chain, int pin) noexcept {
    static_assert(sizeof(JointForce<>) == (2 * axis_terms + 4) * sizeof(double));
    const int before = model.layout().previous(pin);
    JointForce<> force;
    auto of_joint = books<Observe>(chain, pin, AccountPart::joint);
    joint_part(model.coefficients(), frame_of(chain, before), frame_of(chain, pin), state_of(chain, before), state_of(chain, pin), force,
               of_joint);
    keep(force, chain.buffers->joints.data() + pin * chain.buffers->joint_stride);
}

template <bool Observe>
void chain_forces(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    constexpr int size = link_layout.link_size();
    for (int link = first; link < last; ++link) {
        const double* state = state_of(chain, link);
        double* f = force_of(chain, link);
        std::memcpy(f - size, state + size, size * sizeof(double));
        auto of_link = books<Observe>(chain, link, AccountPart::link);
        chain.buffers->moments[static_cast<std::size_t>(link)] =
            link_part(model.coefficients(), link, frame_of(chain, link), state, f, of_link);
        if (link > first) joint_of_pin<Observe>(model, chain, link);
    }
}

template <bool Observe>
void contact(const ChainModel& model, const StagedChain& chain, int link) noexcept {
    static_assert(sizeof(TipShare) == (4 * axis_terms + 5) * sizeof(double));
    TipShare share;
    auto of_tips = books<Observe>(chain, link, AccountPart::tips);
    tip_part(model, frame_of(chain, link), state_of(chain, link), chain.sheaves, chain.phases + tips_per_link * link, share,
             chain.loads[link], of_tips);
    keep(share, chain.buffers->tips.data() + link * chain.buffers->tip_stride);
}

void forward_links(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    const StagedBuffers& buffers = *chain.buffers;
    for (int link = first; link < last; ++link) {
        const auto rear = kept<JointForce<>>(buffers.joints.data() + link * buffers.joint_stride);
        const auto front = kept<JointForce<>>(buffers.joints.data() + model.layout().next(link) * buffers.joint_stride);
        const bool touching = touches(chain.phases, link);
        const auto share = kept<TipShare>(buffers.tips.data() + link * buffers.tip_stride);
        double* f = force_of(chain, link);
        assemble(frame_of(chain, link), buffers.moments[static_cast<std::size_t>(link)], rear, front, touching ? &share : nullptr, f);
    }
}

void reverse_links(const ChainModel& model, const StagedChain& chain, int first, int last) noexcept {
    for (int link = first; link < last; ++link) accelerate(model.inertia(), force_of(chain, link));
}

[[nodiscard]] StagedFunctions functions_of(bool observe) noexcept {
    if (observe) return {chain_forces<true>, joint_of_pin<true>, contact<true>, forward_links, reverse_links};
    return {chain_forces<false>, joint_of_pin<false>, contact<false>, forward_links, reverse_links};
}

}  // namespace

template <>
StagedFunctions staged_kernels<compiled_isa>(bool observe) noexcept {
    return functions_of(observe);
}

}  // namespace cvtflow::bench
