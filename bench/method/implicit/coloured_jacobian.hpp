#pragma once
/// The Jacobian by differences, many columns per evaluation (Curtis, Powell, Reid 1974): links that share no neighbour have one colour and
/// are moved together. Three colours where the number of links is divisible by three, else up to five; each pulley coordinate is a group of
/// its own.
///
///     groups = colours x link_size x {q, v}  +  2 pulley_size  +  control
///
/// Groups are independent of each other and share their base point: coarse tasks for a task graph.

#include <vector>

#include "bench/method/jacobian/acceleration_jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

/// Where the derivative is taken, with what an evaluation there has left.
struct BasePoint {
    double time = 0.0;                         ///< [s]
    const double* state = nullptr;             ///< [layout.size()]
    const double* slope = nullptr;             ///< its slope [unknowns]
    const model::Phase* phases = nullptr;      ///< [4 links]
    const model::LinkLoad* loads = nullptr;    ///< [links]
    const model::Account* accounts = nullptr;  ///< [links * account_parts], only with a ledger
};

class ColouredJacobian {
public:
    /// One-sided differences: small against contact depths (µm) and saturation speeds (mm/s), large against rounding.
    static constexpr double position_step = 1e-9;  ///< [m] or [rad]
    static constexpr double velocity_step = 1e-6;  ///< [m/s] or [rad/s]

    /// @param batches shares that are worked on side by side, each with memory of its own   @param variator must outlive this
    ColouredJacobian(const model::Variator& variator, int batches);

    [[nodiscard]] int batches() const noexcept { return static_cast<int>(scratch_.size()); }
    [[nodiscard]] int colours() const noexcept { return colours_; }
    /// Evaluations of the right-hand side that a Jacobian takes.
    [[nodiscard]] int groups() const noexcept { return chain_groups() + 2 * layout_.pulley_size + layout_.controls; }

    /// Fills the entries of the groups of one batch. Entries of links that do not touch on the pulleys are cleared.
    void evaluate(int batch, const BasePoint& base, bench::AccelerationJacobian& out) noexcept;

private:
    struct Scratch {
        explicit Scratch(const model::ChainLayout& layout);
        model::EvaluationScratch evaluation;
        std::vector<double> slope, tail;     ///< [unknowns, per second]
        std::vector<double> zero, reaction;  ///< pulleys at rest; what reactions of a link do to them
    };

    [[nodiscard]] int chain_groups() const noexcept { return 2 * colours_ * layout_.link_size(); }
    [[nodiscard]] int colour(int link) const noexcept;
    void chain_group(int group, const BasePoint& base, Scratch& own, bench::AccelerationJacobian& out) const noexcept;
    void pulley_group(int column, const BasePoint& base, Scratch& own, bench::AccelerationJacobian& out) const noexcept;
    void move_colour(int colour, int offset, double step, const BasePoint& base,
                     Scratch& own) const noexcept;  ///< step [disturbance: m or m/s]
    /// step [disturbance: m or m/s]
    void reaction_column(int link, int column, bench::With with, double step, const BasePoint& base, Scratch& own,
                         bench::AccelerationJacobian& out) const noexcept;

    const model::Variator& variator_;
    model::ChainLayout layout_;
    int colours_;
    std::vector<Scratch> scratch_;
};

}  // namespace cvtflow::bench
