#pragma once
/// The equations of a step of the trapezoidal rule:  v⁺ = v + h/2 (a + a⁺), q⁺ = q + h/2 (v + v⁺).
///
/// Iterates keep q⁺ = q + h/2 (v + v⁺) exactly, so the residual  r = v⁺ - v - h/2 (a + a⁺)  has velocities only. The derived class solves.

#include <vector>

#include "bench/method/implicit/implicit_method.hpp"
#include "bench/method/implicit/newton.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class TrapezoidalRule : public ImplicitMethod {
public:
    static constexpr int state_slots = 4;  ///< start, iterate, increment, trial
    static constexpr int slope_slots = 3;  ///< of the controller, of the trial, of the start

    void phases_changed() noexcept override { start_slope_ = end_slope_ = false; }  // a kept Jacobian may still serve

    void prepare(int segment) noexcept override;         ///< start of the iteration after predict(), else the residual
    void finish(int first, int last) noexcept override;  ///< increment of the state from that of the velocities

protected:
    static constexpr int trial_slope = 1, start_slope = 2;  ///< slots of slopes

    TrapezoidalRule(Workspace& workspace, NewtonStart start);

    [[nodiscard]] double theta() const noexcept { return 0.5 * w_.step.h; }
    [[nodiscard]] bool knows_start_slope() noexcept;
    [[nodiscard]] int evaluate_start() noexcept;
    [[nodiscard]] int predict() noexcept;
    void start_tail() noexcept;                                ///< after the cycle of predict()
    [[nodiscard]] int evaluate_trial(double lambda) noexcept;  ///< lambda [1]; 0: the iterate again
    [[nodiscard]] double residual_norm() noexcept;             ///< of the trial, after the prepare cycle [m/s]
    void finish_tail() noexcept;                               ///< after the solve cycle
    void take_iterate() noexcept;

    int iterate_ = 1, trial_ = 3;   ///< state slots; slot 2 holds the increment
    bool end_slope_ = false;        ///< slope slot 1 is that of the last step's end
    std::vector<double> residual_;  ///< of the trial, [unknowns]

private:
    void start_link(int link) noexcept;
    void residual_of_link(int link) noexcept;
    [[nodiscard]] double residual_of_tail() noexcept;

    const NewtonStart start_;
    const double link_mass_;  ///< [kg]
    engine::Term terms_[2]{};
    double time_of_start_ = 0.0;    ///< [s]
    bool start_slope_ = false;      ///< slope slot 2 is that of the last step's start
    bool predicting_ = false;       ///< a prepare cycle makes the start of the iteration, not a residual
    std::vector<double> energies_;  ///< [links] of the residual
};

}  // namespace cvtflow::bench
