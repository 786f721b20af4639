#pragma once
/// Steps of the trapezoidal rule, solved by Newton's method in velocities alone.
///
///     predict ─► evaluate ─► residual ─► [jacobian ─► factor] ─► solve ─► evaluate ─► residual ─► …
///
/// Friction laws have kinks: the iteration starts from the velocities of the step's start, and steps are halved until the residual falls
/// in energy. A step that does not converge uses the best iterate and is counted.

#include "bench/method/implicit/broyden.hpp"
#include "bench/method/implicit/newton.hpp"
#include "bench/method/implicit/trapezoidal_rule.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class TrapezoidalMethod final : public TrapezoidalRule {
public:
    TrapezoidalMethod(Workspace& workspace, const NewtonOptions& options);

    [[nodiscard]] CycleSequence step() override;
    void restart() noexcept override;
    /// Slope at the end of the last step; with a matrix that is kept over steps, its Jacobian and updates.
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< @param memory from save()

    void update(int segment) noexcept override;

    [[nodiscard]] NewtonStatistics statistics() const noexcept;
    [[nodiscard]] std::string report() const override;

private:
    /// Change of the matrix before an iteration.
    enum class Matrix { stays, new_jacobian, update, factorise };

    [[nodiscard]] bool falls(double norm) const noexcept;  ///< norm [m/s]
    [[nodiscard]] bool shorten() noexcept;
    void accept_trial(double norm) noexcept;  ///< norm [m/s]
    [[nodiscard]] Matrix next_matrix() noexcept;
    [[nodiscard]] int new_jacobian() noexcept;
    [[nodiscard]] int begin_update() noexcept;
    void finish_solve() noexcept;
    [[nodiscard]] Fault give_up() noexcept;
    void finish_step() noexcept;
    void broyden_direction() noexcept;
    [[nodiscard]] double border_factor(int row, double seen) noexcept;  ///< seen [m/s]
    void update_border_rows(int link, int shaft) noexcept;
    void update_corner() noexcept;

    const NewtonOptions options_;
    NewtonStatistics statistics_;
    Broyden broyden_;
    bool has_jacobian_ = false;
    bool renew_ = false;      ///< the iterate is evaluated once more for a new Jacobian
    bool first_ = true;       ///< the trial is the start of the iteration
    bool direction_ = false;  ///< step_ belongs to the present matrix
    bool refreshed_ = false;  ///< a Jacobian beyond the rule in this step
    int iterations_ = 0, since_jacobian_ = 0;
    double norm_ = 0.0, lambda_ = 1.0,
           contraction_ = 0.0;             ///< of the residual [m/s]; share of the Newton step taken and rate of convergence [1]
    std::vector<double> residual_before_;  ///< of the iterate before [velocities] [m/s]
    std::vector<double> step_;             ///< Newton direction [velocities] [m/s]
    std::vector<double> change_;           ///< step taken [velocities] [m/s]
    double squares_[3]{};                  ///< of the change: links on shaft 0, on shaft 1, border [m²/s²]
};

}  // namespace cvtflow::bench
