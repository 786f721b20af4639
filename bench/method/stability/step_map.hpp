#pragma once
/// Effect of one step of a method on small disturbances, written down a second time from the method's definition, to compare with the code.

#include <memory>

#include "bench/method/implicit/linear_plan.hpp"
#include "bench/method/product_names.hpp"
#include "bench/method/stability/linear_chain.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tasks/method/friction/kick_tables.hpp"

namespace cvtflow::bench {

/// The step as a linear map of (q, h v, the method's memory), all in metres or radians.
class StepMap {
public:
    virtual ~StepMap() = default;
    /// Sets the length of the next steps. false: the method refuses it. h [s]
    [[nodiscard]] virtual bool prepare(double h) = 0;
    /// Numbers of a disturbance; the first ones are q, then h v.
    [[nodiscard]] virtual int size() const noexcept = 0;
    virtual void step(const double* from, double* to) = 0;  ///< maps a disturbance over one step. from, to [size()]

protected:
    StepMap() = default;
    StepMap(const StepMap&) = default;
    StepMap& operator=(const StepMap&) = default;
};

[[nodiscard]] std::unique_ptr<StepMap> table_step(const LinearChain& chain, const engine::CompiledPlan& plan);
[[nodiscard]] std::unique_ptr<StepMap> leapfrog_step(const LinearChain& chain, const Kick& kick);
/// Step with converged sweeps over contacts: friction by backward Euler on velocities.
[[nodiscard]] std::unique_ptr<StepMap> backward_euler_leapfrog_step(const LinearChain& chain);
/// Step of that kind with held links.
[[nodiscard]] std::unique_ptr<StepMap> held_leapfrog_step(const LinearChain& chain);
[[nodiscard]] std::unique_ptr<StepMap> implicit_step(const LinearChain& chain, const LinearPlan& plan);
[[nodiscard]] std::unique_ptr<StepMap> trapezoidal_step(const LinearChain& chain);
/// Steps of methods that choose among tables by the spectrum, with the choice of their first step.
[[nodiscard]] std::unique_ptr<StepMap> dumka3_step(const LinearChain& chain);
[[nodiscard]] std::unique_ptr<StepMap> rkc_step(const LinearChain& chain);
[[nodiscard]] std::unique_ptr<StepMap> rock2_step(const LinearChain& chain);
[[nodiscard]] std::unique_ptr<StepMap> fitted_step(const LinearChain& chain);

}  // namespace cvtflow::bench
