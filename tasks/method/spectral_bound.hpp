#pragma once
/// Extent of the eigenvalues of the equations of motion at a state: the friction of contacts along the real axis, the elasticity along the
/// imaginary one. Found by power iteration on differences of the right-hand side, with perturbations so small that no contact opens, closes
/// or begins to slide for them: at most a nanometre per second, or ten picometres.

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/archive.hpp"
#include "model/machine/held_links.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::tasks {

/// Unknowns that are moved; the others stay.
enum class MovedPart {
    all,
    pulleys,
    waves,          ///< x, y, p and q of rigid pins, x and y of halves, in which stretch and yaw run along the chain
    other_links,    ///< z, slide and bending of rigid pins, z and e of halves
    all_but_waves,  ///< other_links and pulleys
};

/// Memory of an estimate, which bounds of machines with the same layout share as long as they take turns.
struct SpectralMemory {
    explicit SpectralMemory(const model::ChainLayout& layout);

    std::vector<double> base, moved, slope, rest;  ///< [unknowns]
    std::vector<model::Phase> rest_phases;         ///< none of them slips
    model::EvaluationScratch scratch;
};

class SpectralBound {
public:
    /// `variator` must outlive it. Takes all its memory here, but for what is given.
    /// @param held what a step holds of the links; nullptr: nothing
    explicit SpectralBound(const model::Variator& variator, MovedPart part = MovedPart::all,
                           std::shared_ptr<SpectralMemory> memory = nullptr, std::shared_ptr<const model::HeldLinks> held = nullptr);

    /// imaginary() becomes that of a step h that holds links: of (M + h² K_held)⁻¹ (K + 4 D/h), or without D. A leapfrog that takes D at
    /// extrapolated velocities is stable while h imaginary() < 2. [s]
    void take(double step, bool damped) noexcept;
    [[nodiscard]] double step() const noexcept { return step_; }

    /// Estimates at a state with its phases held: serial, deterministic, a warm start from the last call. [layout.size()]
    /// Those with a budget stop once it is used up; the next call continues, at the state then: the iteration forgets where it began.
    /// @param budget evaluations, two at least   @return evaluations of the right-hand side that it took
    int estimate(double t, const double* state, const model::Phase* phases) noexcept;
    /// estimate(), with real() of the state brought to rest: no contact slides, so each is as stiff as its load lets it be. Which of them
    /// slide changes from one microsecond to the next; at rest they are a bound for as long as loads stay. t [s], state [unknowns]
    int estimate_at_rest(double t, const double* state, const model::Phase* phases, int budget = unlimited) noexcept;
    /// imaginary() of estimate() alone. t [s], state [unknowns]
    int estimate_oscillation(double t, const double* state, const model::Phase* phases, int budget = unlimited) noexcept;
    /// Whether the last call has completed its estimate; until then real() and imaginary() are those of the estimate before.
    [[nodiscard]] bool complete() const noexcept { return !velocity_complete_ && velocity_.taken == 0 && coordinate_.taken == 0; }

    /// Largest |λ| of the accelerations by velocities: all friction and damping [1/s]. From below, as power iterations are, by some per
    /// cent.
    [[nodiscard]] double real() const noexcept { return velocity_.found; }
    /// Largest frequency of the accelerations by coordinates, friction aside [rad/s].
    [[nodiscard]] double imaginary() const noexcept;

    /// Makes the next estimate begin from the start.
    void forget() noexcept {
        cold_ = true;
        velocity_complete_ = false;
        for (Iteration* each : {&velocity_, &coordinate_}) {
            each->value = each->found = 0.0;
            each->taken = 0;
        }
    }
    /// The vectors of the iterations, and how far an estimate has come whose budget was too small to complete it.
    void visit(engine::Archive& archive);
    /// step() and imaginary() alone; a next estimate begins from the start.
    void visit_limit(engine::Archive& archive) { archive("held_step", step_), archive("spectrum_found", coordinate_.found); }

    static constexpr int unlimited = std::numeric_limits<int>::max();

private:
    /// Direction and growth of one power iteration.
    struct Iteration {
        std::vector<double> direction;  ///< [layout.size()], only in velocities or only in coordinates
        double value = 0.0;             ///< [1/s]
        double size = 0.0;              ///< largest entry of the perturbation
        double found = 0.0;             ///< value of the last complete estimate [1/s]
        int taken = 0;                  ///< iterations of the present estimate; 0: it is complete
    };

    void begin() noexcept;
    int iterate(Iteration& iteration, bool of_velocities, double t, const double* state, const model::Phase* phases,
                int budget) noexcept;  ///< t [s], state [unknowns]
    int iterate_at_rest(double t, const double* state, const model::Phase* phases, int budget) noexcept;
    void publish() noexcept;
    template <class Action>
    void for_each_unknown(Action action) const noexcept;

    const model::Variator& variator_;
    const MovedPart part_;
    Iteration velocity_, coordinate_;
    std::shared_ptr<SpectralMemory> memory_;
    std::shared_ptr<const model::HeldLinks> held_;
    model::HeldInverse inverse_;
    double step_ = 0.0, damping_weight_ = 0.0;  ///< [s], [1/s]
    bool cold_ = true;
    bool velocity_complete_ = false;  ///< the present estimate has its velocities, not yet its coordinates
};

}  // namespace cvtflow::tasks
