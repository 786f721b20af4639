#pragma once
/// The Jacobian of the right-hand side: its blocks, exactly, and by differences.

#include <array>
#include <span>
#include <vector>

#include "bench/method/product_names.hpp"
#include "model/parameters/chain_layout.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

// Derivatives of all accelerations with respect to coordinates and velocities, as blocks: a link depends on its two neighbours and, while
// it touches, on the sheaves of its pulley. The pulleys' block has the integrals I of controllers, if any, as its last unknowns: velocities
// without a coordinate, whose "acceleration" is I'.

/// Variable of a derivative: coordinates (K) or velocities (D).
enum class With { position = 0, velocity = 1 };
/// Link of the variable: the link before, the same link, the link after.
enum class Near { before = 0, same = 1, after = 2 };

class AccelerationJacobian {
public:
    explicit AccelerationJacobian(const ChainLayout& layout);

    [[nodiscard]] int links() const noexcept { return links_; }
    /// Coordinates of a link.
    [[nodiscard]] int size() const noexcept { return size_; }
    /// Pulley coordinates and, with control, the integrals.
    [[nodiscard]] int border() const noexcept { return border_; }

    /// ∂(acceleration of a link)/∂(coordinates or velocities of it or a neighbour): [size × size], row-major [1/s²] or [1/s].
    [[nodiscard]] double* link(int link, Near near, With with) noexcept { return numbers_.data() + link_at(link, near, with); }
    [[nodiscard]] const double* link(int link, Near near, With with) const noexcept { return numbers_.data() + link_at(link, near, with); }
    /// ∂(acceleration of a link)/∂(pulleys): [size × border]. Zero for links that do not touch.
    [[nodiscard]] double* columns(int link, With with) noexcept { return numbers_.data() + columns_begin_ + border_at(link, with); }
    [[nodiscard]] const double* columns(int link, With with) const noexcept {
        return numbers_.data() + columns_begin_ + border_at(link, with);
    }
    /// ∂(acceleration of the pulleys)/∂(a link): [border × size].
    [[nodiscard]] double* rows(int link, With with) noexcept { return numbers_.data() + rows_begin_ + border_at(link, with); }
    [[nodiscard]] const double* rows(int link, With with) const noexcept { return numbers_.data() + rows_begin_ + border_at(link, with); }
    /// ∂(acceleration of the pulleys)/∂(pulleys): [border × border].
    [[nodiscard]] double* corner(With with) noexcept {
        return numbers_.data() + corner_begin_ + static_cast<int>(with) * border_ * border_;
    }
    [[nodiscard]] const double* corner(With with) const noexcept {
        return numbers_.data() + corner_begin_ + static_cast<int>(with) * border_ * border_;
    }

    /// All blocks, one after the other.
    [[nodiscard]] std::span<double> numbers() noexcept { return numbers_; }
    [[nodiscard]] std::span<const double> numbers() const noexcept { return numbers_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return numbers_.size() * sizeof(double); }

private:
    [[nodiscard]] int link_at(int link, Near near, With with) const noexcept {
        return ((3 * link + static_cast<int>(near)) * 2 + static_cast<int>(with)) * size_ * size_;
    }
    [[nodiscard]] int border_at(int link, With with) const noexcept { return (2 * link + static_cast<int>(with)) * size_ * border_; }

    int links_, size_, border_;
    int columns_begin_, rows_begin_, corner_begin_;
    std::vector<double> numbers_;  ///< links, columns, rows, corner [m/s² or rad/s² per unit of the unknown]
};

// The Jacobian exactly, by forward differentiation where forces are made - at a plate, a point of a joint, a tip - and by the chain rule
// from there to coordinates. At a kink, the side on which the state lies counts.

/// Derivatives of a sheave's motion: x, y, z, tilts (positions), then their rates and the rotation's.
inline constexpr int sheave_directions = 11;
inline constexpr int sheave_positions = 5;

/// One tip's effect on its sheave, per motion of the sheave; row: force in the order of SheaveForces.
using SheaveStiffness = std::array<std::array<double, sheave_directions>, 6>;

class ExactJacobian {
public:
    /// @param variator must outlive this
    explicit ExactJacobian(const Variator& variator);

    /// Rows of the links [first, last): blocks, columns, and rows of the pulleys on them. Ranges are independent of each other. state
    /// [unknowns]
    void links(const double* state, const Phase* phases, int first, int last, AccelerationJacobian& out) noexcept;
    /// Pulleys and control on themselves, after all links: their supports and gyroscopic moments by central differences, which are exact
    /// for polynomials of second degree, the tips' part from the results of links(). t [s], state [unknowns]
    void corner(double t, const double* state, const Phase* phases, AccelerationJacobian& out) noexcept;

    /// Origin of a sheave's motion and destination of its loads; number 2 shaft + side.
    struct SheaveMap {
        std::array<int, sheave_directions> coordinate;  ///< pulley coordinate of each direction, -1: none
        struct Effect {
            int coordinate;
            double factor;  ///< acceleration per unit of load [1/kg or 1/(kg·m²)]
        };
        std::array<std::vector<Effect>, 6> effects;
    };
    [[nodiscard]] const SheaveMap& sheave(int number) const noexcept { return sheaves_[static_cast<std::size_t>(number)]; }

private:
    /// state [unknowns]
    using LinkFunction = void (*)(const ExactJacobian&, const Variator&, const double* state, const Phase* phases, int link,
                                  AccelerationJacobian&, SheaveStiffness*, const SheaveMotion*) noexcept;
    void find_maps();
    void own_corner(double t, const double* state, AccelerationJacobian& out) noexcept;  ///< t [s], state [unknowns]

    const Variator& variator_;
    LinkFunction link_;
    std::array<SheaveMap, 4> sheaves_;
    std::vector<SheaveStiffness> stiffness_;    ///< [links][side], summed over the ends
    std::vector<double> tail_, above_, below_;  ///< [unknowns of the pulleys] and their slopes
};

// The Jacobian by differences, many columns per evaluation (Curtis, Powell, Reid 1974): links that share no neighbour have one colour and
// are moved together. Three colours where the number of links is divisible by three, else up to five; each pulley coordinate is a separate
// group.
//
//     groups = colours x link_size x {q, v}  +  2 pulley_size  +  control
//
// Groups are independent of each other and share their base point: coarse tasks for a task graph.

/// Point at which the derivative is taken, with the results of an evaluation there.
struct BasePoint {
    double time = 0.0;                         ///< [s]
    const double* state = nullptr;             ///< [layout.size()]
    const double* slope = nullptr;             ///< slope at the state [unknowns]
    const model::Phase* phases = nullptr;      ///< [4 links]
    const model::LinkLoad* loads = nullptr;    ///< [links]
    const model::Account* accounts = nullptr;  ///< [links * account_parts], only with a ledger
};

class ColouredJacobian {
public:
    /// Steps of one-sided differences: small against contact depths (µm) and saturation speeds (mm/s), large against rounding.
    static constexpr double position_step = 1e-9;  ///< [m] or [rad]
    static constexpr double velocity_step = 1e-6;  ///< [m/s] or [rad/s]

    /// @param batches shares that are processed in parallel, each with separate memory   @param variator must outlive this
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
        std::vector<double> zero, reaction;  ///< pulleys at rest; effect of a link's reactions on them
    };

    [[nodiscard]] int chain_groups() const noexcept { return 2 * colours_ * layout_.link_size(); }
    [[nodiscard]] int colour(int link) const noexcept;
    void chain_group(int group, const BasePoint& base, Scratch& room, bench::AccelerationJacobian& out) const noexcept;
    void pulley_group(int column, const BasePoint& base, Scratch& room, bench::AccelerationJacobian& out) const noexcept;
    void move_colour(int colour, int offset, double step, const BasePoint& base,
                     Scratch& room) const noexcept;  ///< step [disturbance: m or m/s]
    /// step [disturbance: m or m/s]
    void reaction_column(int link, int column, bench::With with, double step, const BasePoint& base, Scratch& room,
                         bench::AccelerationJacobian& out) const noexcept;

    const model::Variator& variator_;
    model::ChainLayout layout_;
    int colours_;
    std::vector<Scratch> scratch_;
};

// Derivatives of the whole right-hand side by central differences: for cases without exact derivatives, and for eigenvalues.

/// Whether an unknown is a velocity (or a first-order unknown), not a coordinate.
[[nodiscard]] bool is_velocity(const ChainLayout& layout, int index) noexcept;

/// ∂(slope)/∂(state) with phases held: [unknowns × unknowns], column by column. t [s], state [unknowns]
[[nodiscard]] std::vector<double> difference_jacobian(const Variator& variator, double t, const std::vector<double>& state,
                                                      const std::vector<Phase>& phases);

}  // namespace cvtflow::bench
