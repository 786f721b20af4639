#pragma once
/// Cylinders of the movable sheaves, their valves and the pump that feeds them. (model/EQUATIONS.md section 8, hydraulics)

#include <array>

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// Motion of a cylinder with its pulley.
struct CylinderMotion {
    double position = 0.0;  ///< y of the movable sheave toward the chain [m]
    double speed = 0.0;     ///< y' [m/s]
    double turning = 0.0;   ///< ω of the shaft [rad/s]
};

/// Hydraulics at one instant. Index 0: driving, 1: driven.
struct HydraulicInstant {
    std::array<double, 2> target{}, set{}, pressure{};  ///< requested of a valve, set by it, in the cylinder at r_0 [Pa]
    std::array<double, 2> flow{}, force{};              ///< flow into the cylinder [m³/s]; clamping force S [N]
    double line = 0.0;                                  ///< pressure behind the pump [Pa]
    double pump_speed = 0.0, pump_torque = 0.0;         ///< [rad/s, N·m]
    double pump_flow = 0.0, spill = 0.0;                ///< [m³/s]; spill: what the cylinders do not take; 0: the pump is short of flow
    double pump = 0.0, mechanical = 0.0, volumetric = 0.0;  ///< power of the pump's shaft, losses in the pump [W]
    double relief = 0.0, valves = 0.0, leakage = 0.0;       ///< losses of spilling, of throttling, of leakage [W]
    double sheaves = 0.0;                                   ///< power of the oil on the sheaves [W]

    [[nodiscard]] double lost() const noexcept { return mechanical + volumetric + relief + valves + leakage; }
};

/// Energies of the hydraulics since t = 0 [J]: pump = mechanical + volumetric + relief + valves + leakage + sheaves + change of stored.
struct HydraulicEnergy {
    double pump = 0.0, mechanical = 0.0, volumetric = 0.0, relief = 0.0, valves = 0.0, leakage = 0.0, sheaves = 0.0;
    double stored = 0.0;  ///< energy in compressed oil, now

    [[nodiscard]] double lost() const noexcept { return mechanical + volumetric + relief + valves + leakage; }
};

/// Means of the powers between two instants [W]; zero if no time lies between. time [s]
[[nodiscard]] HydraulicEnergy mean_powers(const HydraulicEnergy& from, const HydraulicEnergy& to, double time) noexcept;

class HydraulicModel {
public:
    /// Becomes the model of other parameters; allocates only what does not fit into the memory it has.
    void adopt(const Hydraulics& hydraulics);

    [[nodiscard]] bool present() const noexcept { return data_.mode != HydraulicMode::none; }
    [[nodiscard]] const Hydraulics& data() const noexcept { return data_; }
    /// Force of rotating oil and spring toward the chain [N].
    [[nodiscard]] double other_force(int shaft, const CylinderMotion& motion) const noexcept;
    [[nodiscard]] double area(int shaft) const noexcept { return cylinder(shaft).area; }
    /// @param unknowns [hydraulic_unknowns]   @param requested clamping forces [N]   @param pump_speed [rad/s]
    [[nodiscard]] HydraulicInstant instant(const double* unknowns, const std::array<CylinderMotion, 2>& motion,
                                           const std::array<double, 2>& requested, double pump_speed) const noexcept;
    /// Rates of the unknowns. rates [hydraulic_unknowns]
    void rates(const HydraulicInstant& now, double* rates) const noexcept;
    /// Unknowns at which cylinders at rest have the forces, as far as pressures from 0 to the relief pressure can; energies 0.
    /// unknowns [hydraulic_unknowns], force [N]
    void fill(const std::array<CylinderMotion, 2>& motion, const std::array<double, 2>& force, double* unknowns) const noexcept;
    /// unknowns [hydraulic_unknowns]
    [[nodiscard]] HydraulicEnergy energy(const double* unknowns, const std::array<CylinderMotion, 2>& motion) const noexcept;

private:
    [[nodiscard]] const Cylinder& cylinder(int shaft) const noexcept { return shaft == 0 ? data_.driving : data_.driven; }
    /// Pressure per travel of a piston against closed valves: A K/V [Pa/m].
    [[nodiscard]] double stiffness(int shaft) const noexcept { return area(shaft) / capacity_; }
    [[nodiscard]] double target(int shaft, const CylinderMotion& motion, double force) const noexcept;
    void share_flow(HydraulicInstant& now) const noexcept;

    Hydraulics data_;
    double capacity_ = 0.0;             ///< C = V/K of a cylinder [m³/Pa]
    double per_radian_ = 0.0;           ///< displacement of the pump [m³/rad]
    std::array<double, 2> rotating_{};  ///< force of rotating oil over ω² [N·s²]
};

}  // namespace cvtflow::model
