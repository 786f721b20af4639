#pragma once
/// Leapfrog with friction integrated inside the step. Elasticity limits the step (ω h < 2), friction does not:
///
///     q ← q + h/2 v
///     G, contacts: everything but friction's velocities, at q and at velocities extrapolated over the half step
///     v ← friction and G over h, by a table of stages
///     q ← q + h/2 v
///
/// Friction is stiff, so velocities follow the surfaces that it acts on, and a quantity that is constant over the step delays them by half
/// a step. Two quantities therefore change within it: the sheaves' surface under a tip turns with the tip (a tenth of the saturation speed
/// in 1 µs), and G(t) = G + (t/h - 1/2) ΔG, with ΔG its change since the step before, which leaves the impulse of G and so the leapfrog
/// alone.

#include <array>
#include <span>
#include <vector>

#include "tasks/method/friction/kick_system.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/method/friction/leapfrog_frame.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// Spectral radius of friction about rest, where every contact sticks: the steepest that the law can be.
class FrictionSpectrum {
public:
    /// @param mode number of the field of the vector of power iterations, which outlasts a step; the next one is for its image
    /// @param edges number of the mode's edges
    FrictionSpectrum(KickSystem& kick, std::size_t mode, std::size_t edges);

    void repartitioned();
    /// Begins with a mode without symmetry.
    void restart() noexcept;
    /// Largest eigenvalue, from a few power iterations on, for the contacts of the last record [1/s].
    [[nodiscard]] double radius(const Workspace& workspace, int iterations) noexcept;

private:
    KickSystem& kick_;
    const std::size_t mode_, edges_;
    const model::FrictionOperator sticking_;
    std::vector<model::ContactField> resting_;  ///< [segment] contacts without motion
};

/// Friction inside a step: velocities of all links under friction and constant accelerations, everything else frozen, are a small system of
/// ordinary differential equations that a table of stages integrates, by segments. Increments of a link's velocities are floats, rounded to
/// 6e-8 of themselves.
class FrictionLeapfrog final : public StepMethod {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = LeapfrogFrame::state_slots, slope_slots = LeapfrogFrame::slope_slots;
    /// Factor by which the spectral radius of friction may have grown since its last estimate.
    static constexpr double margin = 1.1;  ///< [1]

    FrictionLeapfrog(Workspace& workspace, const Kick& kick);

    [[nodiscard]] CycleSequence step() override;
    void add_tasks(engine::TaskGraph& graph) override;
    void repartitioned() override;
    [[nodiscard]] AtTransition at_transition() const noexcept override { return AtTransition::repeat; }
    void restart() noexcept override;
    void phases_changed() noexcept override {}  // the history remains valid: nothing jumps
    /// Memory between steps: forces of the last step, and the vectors of power iterations.
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< @param memory from save()

    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return kick_.bytes(); }

    // Bodies of tasks: each touches the columns of one segment only, and reads what its neighbours have handed over.

    /// Contacts and all other forces of a segment's links; their velocities at the step's start in slot 0.
    void record(int segment) noexcept;
    /// One row of a chained table: evaluates at the velocities of its slot, with extrapolation times the difference between base and that
    /// of the step before added to base; adds weight times the tips' forces to their means; combines the velocities of the row that
    /// follows. item = stage of the cycle × segments + segment
    void stage(int item) noexcept;
    void finish(int segment) noexcept { kick_.finish(w_, segment, false); }

private:
    /// Fields: velocities by slot from slot 1 on (slot 0: those at the start); accelerations by everything but friction, of this step and
    /// of the one before (see now_); ….
    enum Further : std::size_t { state, base = state + kick_state_slots - 1, first_slope = base + 2, mode, image, count };
    enum Edges : std::size_t { state_edges, mode_edges = state_edges + kick_state_slots };
    [[nodiscard]] static model::FloatColumns& slot(SegmentFields::Fields& fields, int number) noexcept {
        return number == 0 ? fields.start : fields.of[state + at(number) - 1];
    }

    void begin();
    [[nodiscard]] Fault choose_table();

    Workspace& w_;
    LeapfrogFrame frame_;
    KickSystem kick_;
    std::size_t now_ = 0;  ///< number of the present step's base
    FrictionSpectrum spectrum_;
    const KickTables tables_;
    const KickTable* table_ = nullptr;  ///< table of the present step
    Rounds stages_;                     ///< stages of the present step
    long steps_ = 0;
    double radius_ = 0.0;  ///< spectral radius of friction [1/s]
};

}  // namespace cvtflow::tasks
