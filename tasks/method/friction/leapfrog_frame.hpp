#pragma once
/// The part of the leapfrog of pin halves outside friction.
///
///     q ← q + h/2 v;   velocities extrapolated to the middle, where contacts and all other forces are taken;   …;   q ← q + h/2 v
///
/// and data of the step before: its mean acceleration, the motion of the sheaves in its middle, its length.

#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class LeapfrogFrame {
public:
    /// Slots of the workspace that it uses.
    static constexpr int state_slots = 2, slope_slots = 3;

    explicit LeapfrogFrame(Workspace& workspace) : w_(workspace) {}

    /// Forgets the previous step.
    void restart() noexcept;
    /// Whether there is a step before the one that begins.
    [[nodiscard]] bool continues() const noexcept { return continues_; }
    /// Data of the step before become history; workspace.step.row for the middle of the step, and the sheaves there.
    void begin();
    /// Pulleys, from what the chain does to them; workspace.step.row for the result, whose links are in state slot 1.
    void end(const model::SheaveForces& chain);

    [[nodiscard]] const model::ContactDrift& drift() const noexcept { return drift_; }

    void save(std::vector<double>& memory) const;
    /// @param memory from save()   @return the rest of the memory
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);

private:
    void extrapolate();

    Workspace& w_;
    bool continues_ = false;  ///< whether a step precedes the present one
    double length_ = 0.0;     ///< length of the present step [s]
    alignas(model::cache_line) model::ContactDrift drift_;
    model::SheaveMotion sheaves_before_[4]{};
};

}  // namespace cvtflow::tasks
