#pragma once
/// The trapezoidal rule:  v⁺ = v + h/2 (a + a⁺), q⁺ = q + h/2 (v + v⁺), solved by Newton's method in velocities alone.
///
///     predict ─► evaluate ─► residual ─► [jacobian ─► factor] ─► solve ─► evaluate ─► residual ─► …
///
/// Iterates keep q⁺ = q + h/2 (v + v⁺) exactly, so the residual  r = v⁺ - v - h/2 (a + a⁺)  has velocities only. Friction laws have kinks:
/// the iteration starts from the velocities of the step's start, and steps are halved until the residual falls in energy. A step that does
/// not converge uses the best iterate and is counted.

#include "bench/method/implicit/broyden.hpp"
#include "bench/method/implicit/implicit_method.hpp"
#include "bench/method/implicit/newton.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class TrapezoidalMethod final : public ImplicitMethod {
public:
    static constexpr int state_slots = 4;  ///< start, iterate, increment, trial
    static constexpr int slope_slots = 3;  ///< of the controller, of the trial, of the start

    TrapezoidalMethod(Workspace& workspace, const NewtonOptions& options);

    [[nodiscard]] CycleSequence step() override;
    void restart() noexcept override;
    void phases_changed() noexcept override { start_slope_ = end_slope_ = false; }  // a kept Jacobian may still serve
    /// Slope at the end of the last step; with a matrix that is kept over steps, its Jacobian and updates.
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< @param memory from save()

    void prepare(int segment) noexcept override;
    void finish(int first, int last) noexcept override;
    void update(int segment) noexcept override;

    [[nodiscard]] NewtonStatistics statistics() const noexcept;
    [[nodiscard]] std::string report() const override;

private:
    static constexpr int trial_slope = 1, start_slope = 2;  ///< slots of slopes
    /// Change of the matrix before an iteration.
    enum class Matrix { stays, new_jacobian, update, factorise };

    [[nodiscard]] double theta() const noexcept { return 0.5 * w_.step.h; }
    [[nodiscard]] bool keeps_over_steps() const noexcept { return options_.matrix >= NewtonMatrix::frozen; }
    [[nodiscard]] bool knows_start_slope() noexcept;
    [[nodiscard]] int evaluate_trial(double lambda) noexcept;  ///< lambda [1]
    [[nodiscard]] double residual_norm() noexcept;             ///< [m/s]
    [[nodiscard]] bool falls(double norm) const noexcept;      ///< norm [m/s]
    [[nodiscard]] bool shorten() noexcept;
    void accept_trial(double norm) noexcept;  ///< norm [m/s]
    [[nodiscard]] Matrix next_matrix() noexcept;
    [[nodiscard]] int new_jacobian() noexcept;
    [[nodiscard]] int begin_update() noexcept;
    void finish_solve() noexcept;
    [[nodiscard]] Fault give_up() noexcept;
    void finish_step() noexcept;
    void start_link(int link) noexcept;
    void residual_of_link(int link) noexcept;
    void start_tail() noexcept;
    [[nodiscard]] double residual_of_tail() noexcept;
    void broyden_direction() noexcept;
    [[nodiscard]] double border_factor(int row, double seen) noexcept;  ///< seen [m/s]
    void update_border_rows(int link, int shaft) noexcept;
    void update_corner() noexcept;

    const NewtonOptions options_;
    const double link_mass_;  ///< [kg]
    NewtonStatistics statistics_;
    Broyden broyden_;
    bool predicting_ = false;      ///< a prepare cycle makes the start of the iteration, not a residual
    int iterate_ = 1, trial_ = 3;  ///< state slots; slot 2 holds the increment
    engine::Term terms_[2]{};
    double time_of_start_ = 0.0;  ///< [s]
    bool start_slope_ = false;    ///< slope slot 2 is that of the last step's start …
    bool end_slope_ = false;      ///< … and slope slot 1 that of its end
    bool has_jacobian_ = false;
    bool renew_ = false;      ///< the iterate is evaluated once more for a new Jacobian
    bool first_ = true;       ///< the trial is the start of the iteration
    bool direction_ = false;  ///< step_ belongs to the present matrix
    bool refreshed_ = false;  ///< a Jacobian beyond the rule in this step
    int iterations_ = 0, since_jacobian_ = 0;
    double norm_ = 0.0, lambda_ = 1.0,
           contraction_ = 0.0;             ///< of the residual [m/s]; share of the Newton step taken and rate of convergence [1]
    std::vector<double> energies_;         ///< [links] of the residual
    std::vector<double> residual_;         ///< of the trial, [unknowns]
    std::vector<double> residual_before_;  ///< of the iterate before [velocities] [m/s]
    std::vector<double> step_;             ///< Newton direction [velocities] [m/s]
    std::vector<double> change_;           ///< step taken [velocities] [m/s]
    double squares_[3]{};                  ///< of the change: links on shaft 0, on shaft 1, border [m²/s²]
};

}  // namespace cvtflow::bench
