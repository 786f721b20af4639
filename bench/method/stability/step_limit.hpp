#pragma once
/// The longest step with which a method is stable at a state, and the reason for it.

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/method/product_names.hpp"
#include "bench/method/stability/program_stability.hpp"
#include "tasks/method/method.hpp"
#include "tasks/method/spectral_bound.hpp"

namespace cvtflow::bench {

/// Reason why a step cannot be longer.
enum class StepLimiter {
    nothing,          ///< linear stability sets no limit
    oscillation,      ///< the fastest one
    decay,            ///< the fastest one: friction, damping
    friction_stages,  ///< the method has no more stages for friction
    polynomials,      ///< the method has no polynomial for more
};

struct StepLimit {
    double step = std::numeric_limits<double>::infinity();  ///< longest stable one [s]
    StepLimiter by = StepLimiter::nothing;
    double oscillation = 0.0;  ///< frequency of the disturbance that grows first beyond the limit [rad/s]
    double friction = 0.0;     ///< damping of this disturbance by friction [1/s]
    double in_pulleys = 0.0;   ///< share of its kinetic energy in shafts and sheaves; not set by StepLimitBound
};

/// "1.91 us (oscillation of 120 kHz under friction of 1.2e+06 1/s)".
[[nodiscard]] std::string text_of(const StepLimit& limit);

/// A quick estimate from the fastest oscillation and the fastest decay (SpectralBound), each as if it had the worst of the other, along the
/// chain. It ignores the pulleys (calibrate()). The vectors of the power iteration persist: about 100 evaluations of the right-hand side
/// the first time, 12 later.
class StepLimitBound {
public:
    /// `variator` must outlive it. @throws std::invalid_argument for a name that is no method's
    StepLimitBound(const model::Variator& variator, const Method& method);

    /// Updates the estimate at a state with its phases held: serial, deterministic. [layout.size()]
    /// @return evaluations of the right-hand side that it took
    int update(double t, const double* state, const model::Phase* phases);
    /// The last estimate.
    [[nodiscard]] const StepLimit& limit() const noexcept { return limit_; }
    /// Sets the true limit at the state of the last update (predicted_step_limit()). This estimate and later ones are multiplied by its
    /// ratio to the estimate. [s]
    void calibrate(double known) noexcept;

    /// Directions and limit, for checkpoints. load() returns the rest of the memory.
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);  ///< @param memory from save()

private:
    [[nodiscard]] StepLimit judged() const;
    [[nodiscard]] StepLimit of_oscillator() const;

    SpectralBound bound_;
    ProgramStability program_;  ///< stability of a method that takes friction apart
    bool takes_friction_apart_ = false;
    double real_reach_ = 0.0;       ///< |h λ| of a decay; 0: no limit [1]
    double imaginary_reach_ = 0.0;  ///< |h λ| of an oscillation damped by 1 %; 0: no limit [1]
    double calibration_ = 1.0;      ///< [1]
    StepLimit limit_;
};

/// The estimated limit at one state, by a temporary StepLimitBound. t [s], state [unknowns]
[[nodiscard]] StepLimit estimated_step_limit(const model::Variator& variator, const Method& method, double t, const double* state,
                                             const model::Phase* phases);

}  // namespace cvtflow::bench
