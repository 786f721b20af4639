#pragma once
/// All methods of the laboratory, beside those of the product: named in scenes of cvtflow-lab and of the tests like any other.

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "bench/method/stability/program_stability.hpp"
#include "bench/method/stability/step_map.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

/// Adds them to the product's catalogue, once per process, before anything else asks it.
void add_laboratory_methods();

/// Mathematical definition of a program, with which its code has to agree.
struct MethodAnalysis {
    /// Stability on the test equation of the program; empty: the program chooses among tables of stages.
    std::function<ProgramStability()> stability = {};
    /// Step of the program as a linear map of small disturbances.
    std::function<std::unique_ptr<StepMap>(const LinearChain& chain)> linear = {};
};
/// Analysis of a program of either catalogue. @throws std::out_of_range for one without analysis
[[nodiscard]] const MethodAnalysis& analysis_of(const tasks::MethodProgram& program);

/// The reach that the analysis finds, which the catalogue declares.
[[nodiscard]] tasks::MethodReach derived_reach(const tasks::MethodProgram& program);
[[nodiscard]] engine::StageReach derived_reach(const engine::StagePlan& plan);

}  // namespace cvtflow::bench
