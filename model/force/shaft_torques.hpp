#pragma once
/// Torques on the shafts: drive, load, and the couplings or governors that hold a shaft by its angle and speed. (model/EQUATIONS.md
/// section 8)

#include <array>
#include <optional>

#include "model/force/pulley_coordinates.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// Angle of what holds a shaft by its speed: φ_ref(t) = angle + ∫ω_ref from `since` to t.
struct ReferenceAngle {
    double since = 0.0;  ///< [s]
    double angle = 0.0;  ///< [rad]
    double zero = 0.0;   ///< φ_ref when a coupling took over: hosts count its far end from there [rad]
    bool operator==(const ReferenceAngle&) const = default;
};

/// A coupling at one instant.
struct CouplingState {
    double twist = 0.0, rate = 0.0;  ///< φ_ref - φ [rad], its rate [rad/s]
    double energy = 0.0;             ///< ½ k twist² [J]
    double damping = 0.0;            ///< c [N·m·s/rad]
};

/// Inputs that the caller has set: a value that replaces the scene's table from then on.
struct HeldInputs {
    std::optional<double> driving;              ///< S_1 [N]
    std::optional<double> driven;               ///< S_2 [N]
    std::optional<double> load_torque;          ///< against the travel of shaft 2 [N·m]
    std::optional<double> drive_torque;         ///< drive mode torque [N·m]
    std::optional<double> drive_speed;          ///< drive modes speed and coupling [rad/s]; the reference angle goes on from reference[0]
    std::optional<double> load_speed;           ///< load modes speed and coupling [rad/s]; the reference angle goes on from reference[1]
    std::optional<double> ratio;                ///< of ratio control [1]
    std::optional<double> driving_pressure;     ///< hydraulics.mode pressure [Pa]
    std::optional<double> driven_pressure;      ///< [Pa]
    std::array<ReferenceAngle, 2> reference{};  ///< of the shafts
    bool coupled = false;  ///< whether couplings, load mode speed and hydraulics have taken over (ShaftTorques::couple)
    bool operator==(const HeldInputs&) const = default;
};

class ShaftTorques : public PulleyCoordinates {
public:
    /// Becomes the torques of other parameters, inputs released; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);

    /// Puts values in place of tables; between steps only.
    void hold(const HeldInputs& held) noexcept { held_ = held; }
    [[nodiscard]] const HeldInputs& held() const noexcept { return held_; }
    /// Angle and speed of what holds shaft 0 or 1 at time t: of a governor's reference, or of a coupling's far end. t [s]
    [[nodiscard]] double reference_angle(double t, int shaft) const noexcept;
    [[nodiscard]] double reference_speed(double t, int shaft) const noexcept;  ///< t [s]
    /// Couplings, and load mode speed, take over: with the twist that carries the torque that acts at this instant. Before, shaft 1 is held
    /// by the governor of mode speed and shaft 2 by load.torque. t [s], block [unknowns of the pulleys]
    void couple(double t, const double* block) noexcept;
    /// Whether a coupling acts on shaft 0 or 1; its state, zero where none does. t [s], block [unknowns of the pulleys]
    [[nodiscard]] bool coupled(int shaft) const noexcept;
    [[nodiscard]] CouplingState coupling(double t, const double* block, int shaft) const noexcept;

protected:
    [[nodiscard]] double drive_torque(double t, const double* block) const noexcept;      ///< t [s], block [unknowns of the pulleys]
    [[nodiscard]] double resisting_torque(double t, const double* block) const noexcept;  ///< against shaft 2; t [s], block as above

private:
    /// By what holds a shaft by its angle and speed [N·m]. t [s], block [unknowns of the pulleys]
    [[nodiscard]] double holding_torque(const Spring& by, double t, const double* block, int shaft) const noexcept;
    [[nodiscard]] const TimeTable& speed_table(int shaft) const noexcept { return shaft == 0 ? drive_.speed : load_.speed; }
    [[nodiscard]] const std::optional<double>& held_speed(int shaft) const noexcept {
        return shaft == 0 ? held_.drive_speed : held_.load_speed;
    }

    Drive drive_;
    Load load_;
    HeldInputs held_;
    std::array<Spring, 2> governor_, holder_;  ///< of each shaft: as in mode speed; as its mode has it once couplings have taken over
};

}  // namespace cvtflow::model
