#pragma once
/// The published schedule: a chain that is evaluated stage by stage, and an assembly of the step from its stages.

#include <vector>

#include "model/basis/isa.hpp"
#include "model/chain/chain_model.hpp"

namespace cvtflow::bench {

// The chain evaluated stage by stage, as the published parallelisation does: contact forces, chain forces, boundary pins, forward pass,
// reverse pass. Results are those of ChainModel::slopes bit for bit, since both use the same formulas (bench/staged/one_link.hpp).

using model::ChainModel;

/// Results of stages that later stages read. Strides in doubles.
struct StagedBuffers {
    explicit StagedBuffers(const model::ChainLayout& layout);
    std::vector<double> joints;   ///< [links][joint_stride]: force of the joint of pin i
    std::vector<double> tips;     ///< [links][tip_stride]: forces of a link's tips
    std::vector<double> moments;  ///< [links] moment of elasticity and plates about z
    int joint_stride, tip_stride;
};

/// Data that all stages read and write. Links are whole numbers 0 … N-1 here; there is no window.
struct StagedChain {
    const double* states;  ///< stage state of the whole chain [unknowns]
    const model::SheaveMotion* sheaves;
    const model::Phase* phases;
    double* slope;           ///< slope of the whole chain [unknowns, per second]
    model::LinkLoad* loads;  ///< [links]
    StagedBuffers* buffers;
    model::Account* accounts;  ///< [links * account_parts], only for observing evaluations, else nullptr
};

/// Functions of observing or not, chosen once.
struct StagedFunctions {
    /// Elasticity and plates of links [first, last), joints of the pins strictly between them.
    void (*chain_forces)(const ChainModel&, const StagedChain&, int first, int last) noexcept;
    /// Joint of one pin, between link pin - 1 and link pin.
    void (*joint)(const ChainModel&, const StagedChain&, int pin) noexcept;
    /// Tips of one link that touches.
    void (*contact)(const ChainModel&, const StagedChain&, int link) noexcept;
    /// Sum of forces for links [first, last).
    void (*forward)(const ChainModel&, const StagedChain&, int first, int last) noexcept;
    /// Accelerations A⁻¹ f for links [first, last).
    void (*reverse)(const ChainModel&, const StagedChain&, int first, int last) noexcept;
};
/// Functions of the model's instruction set.
[[nodiscard]] StagedFunctions staged_functions(const ChainModel& model, bool observe);

/// Defined in staged_kernels.cpp, which is compiled once per instruction set.
template <model::Isa isa>
StagedFunctions staged_kernels(bool observe) noexcept;
template <>
StagedFunctions staged_kernels<model::Isa::baseline>(bool observe) noexcept;
template <>
StagedFunctions staged_kernels<model::Isa::avx2>(bool observe) noexcept;
template <>
StagedFunctions staged_kernels<model::Isa::avx512>(bool observe) noexcept;

struct CompiledStages {
    model::Isa isa;
    StagedFunctions (*functions)(bool observe) noexcept;
};
/// Stages for the instruction sets of the model's kernels. The build writes this list (compiled_staged.cpp.in).
[[nodiscard]] std::vector<CompiledStages> compiled_stages();

// The published schedule as an assembly of the step: tasks for every stage, contact forces in uniform batches of touching links beside
// chain forces by segments, then the boundary pins, forward pass, reverse pass.

/// Adds it to the product's assemblies, once per process, before any workspace is made. Until then run.assembly = "staged" is refused.
void add_staged_assembly();

}  // namespace cvtflow::bench
