#pragma once
/// All physical parameters of a scene. SI units, angles in radians. Defaults are the baseline variator of model/EQUATIONS.md.
/// Ranges, units, sources and meanings for users live in the parameter table (tasks/scene/parameter_table.cpp), which is tested against
/// this struct.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cvtflow::model {

/// A quantity over time: linear between points, constant outside them. One point is a constant. Times ascend strictly.
struct TimeTable {
    std::vector<double> time{0.0};  ///< [s]
    std::vector<double> value{0.0};

    TimeTable() = default;
    explicit TimeTable(double constant) : value{constant} {}
    TimeTable(std::vector<double> times, std::vector<double> values) : time(std::move(times)), value(std::move(values)) {}

    [[nodiscard]] double at(double t) const noexcept;  ///< t [s]
    /// ∫ from 0 to t. For t < 0: value(0) t (settling runs before zero). t [s]
    [[nodiscard]] double integral(double t) const noexcept;
    [[nodiscard]] double largest_magnitude() const noexcept;
    bool operator==(const TimeTable&) const = default;
};

/// A number over a speed, between whose points a law interpolates. Speeds ascend strictly; one point is a constant.
struct SpeedTable {
    std::vector<double> speed{0.0};  ///< [m/s]
    std::vector<double> value{0.09};
    bool operator==(const SpeedTable&) const = default;
};

/// Origin of the clamping forces: inputs without hydraulics; cylinders, from forces or from pressures that are requested.
enum class HydraulicMode { none, force, pressure };

/// Cylinder of a movable sheave: a ring-shaped piston that turns with its shaft.
struct Cylinder {
    double area = 0.01;         ///< A [m²]
    double inner = 20e-3;       ///< inner radius of the piston r_i [m]
    double compensation = 0.0;  ///< area of a chamber on the other side, whose oil only rotates; from r_i on [m²]
    double spring = 0.0;        ///< force of a spring toward the chain where the flank's r_m is the running radius [N]
    double spring_rate = 0.0;   ///< decrease of this force per travel of the sheave toward the chain [N/m]
    TimeTable pressure{2e6};    ///< target, mode pressure [Pa]
    bool operator==(const Cylinder&) const = default;
};

/// Cylinders, their valves and the pump that feeds them. From t = 0 on; before, clamping forces act as they are requested.
struct Hydraulics {
    HydraulicMode mode = HydraulicMode::none;
    Cylinder driving{.area = 0.02, .pressure = TimeTable(1.3e6)}, driven;
    double feed_radius = 10e-3;        ///< r_0, where rotating oil has the pressure of its valve [m]
    double oil_density = 850.0;        ///< ρ [kg/m³]
    double oil_modulus = 1e9;          ///< K, bulk modulus with air and lines [Pa]
    double oil_volume = 3e-4;          ///< V of a cylinder with its line [m³]
    double leakage = 3e-12;            ///< L of a cylinder [m³/(s·Pa)]
    double valve_conductance = 1e-9;   ///< G of a valve fully open [m³/(s·Pa)]
    double valve_lag = 0.01;           ///< time constant [s]
    double valve_rate = 1e8;           ///< largest change of a set pressure [Pa/s]
    double pump_displacement = 12e-6;  ///< displacement per turn [m³]
    double pump_ratio = 1.0;           ///< turns of the pump per turn of shaft 1
    TimeTable pump_speed{0.0};         ///< speed of the pump's motor, added [rad/s]
    double pump_volumetric = 0.9;      ///< volumetric efficiency
    double pump_mechanical = 0.85;     ///< mechanical efficiency
    double line_margin = 3e5;          ///< line pressure above the higher set pressure [Pa]
    double line_minimum = 5e5;         ///< lowest line pressure [Pa]
    double relief_pressure = 6e6;      ///< highest line pressure [Pa]
    bool operator==(const Hydraulics&) const = default;
};

enum class PinDetail { halves, rigid };
inline constexpr std::array<std::string_view, 2> pin_detail_names{"halves", "rigid"};
[[nodiscard]] constexpr std::string_view name_of(PinDetail pins) noexcept { return pin_detail_names[static_cast<std::size_t>(pins)]; }
enum class PlateDetail { each, lumped };
enum class PulleyDetail { elastic, rigid, absent };
enum class FrictionLaw { piecewise, smoothed };
inline constexpr std::array<std::string_view, 2> friction_law_names{"piecewise", "smoothed"};
/// Friction of tips: one coefficient, a table over the sliding speed, or a lubricated contact.
enum class TipFriction { constant, table, lubricated };
/// Sheaves in the order of their numbers: 1-, 1+, 2-, 2+.
enum class Sheave { driving_fixed, driving_movable, driven_movable, driven_fixed };
enum class JointLaw { linear, palmgren };
enum class DriveMode { speed, torque, coupling };
enum class LoadMode { torque, speed, coupling };
enum class ControlledQuantity { ratio, slip, safety };
/// Quantity that a second controller keeps, by S_2 beside ratio control by S_1.
enum class DrivenControl { none, slip, safety };
enum class StartLayout { belt, ring };

/// Resolved detail. Absent detail is absent from the state vector.
struct Detail {
    PinDetail pins = PinDetail::halves;      ///< two halves that roll in contact; one body whose halves roll by constraint
    PlateDetail plates = PlateDetail::each;  ///< every plate, or a lumped pack with the same moments
    int joint_points = 3;                    ///< Gauss-Legendre points along the rolling line of a joint, 1…16
    PulleyDetail pulleys = PulleyDetail::elastic;
    FrictionLaw friction = FrictionLaw::piecewise;
    double smoothing = 0.1;   ///< half-width d of the smoothed law, in units of v0 [1]
    bool stick_slip = false;  ///< tips also have phases stick and slip
    bool operator==(const Detail&) const = default;
};

struct Friction {
    double coefficient;       ///< μ [1]
    double saturation_speed;  ///< v0 [m/s]
    bool operator==(const Friction&) const = default;
};

struct Chain {
    int pins = 84;                       ///< N
    std::vector<double> pitch{8.12e-3};  ///< [m], repeated cyclically over the links
    double damping_ratio = 0.02;         ///< ζ of every spring of the chain [1]
    double young_modulus = 2.1e11;       ///< E [Pa]
    bool operator==(const Chain&) const = default;
};

struct Half {
    double length = 36e-3;         ///< ℓ_p [m]
    double width = 2.6e-3;         ///< w, thickness in travel direction [m]
    double mass = 4.42e-3;         ///< m_h [kg]
    double area = 15.65e-6;        ///< A [m²]
    double bending_travel = 1.85;  ///< EI for bending along travel [N·m²]
    double bending_height = 13.4;  ///< EI for bending along height [N·m²]
    bool operator==(const Half&) const = default;
};

struct Plate {
    int count = 14;                    ///< plates per link
    double mass = 0.65e-3;             ///< m_j, each [kg]
    double stiffness = 5.7e7;          ///< k_p, each [N/m]
    double span = 15e-3;               ///< outermost plates sit at ± span [m]
    double bending_stiffness = 0.105;  ///< out-of-plane EI, each [N·m²]
    double torsion_stiffness = 15.0;   ///< k_t, each [N·m/rad]
    Friction friction{0.10, 0.01};
    bool operator==(const Plate&) const = default;
};

struct Joint {
    double radius = 10e-3;   ///< ρ of the rolling profile [m]
    double stiffness = 1e9;  ///< k_J, whole line [N/m]
    JointLaw law = JointLaw::linear;
    double reference_depth = 3.5e-6;   ///< δ_r at which ζ and Palmgren's law are anchored [m]
    double clearance = 20e-6;          ///< c_g of the plate opening [m]
    double clearance_stiffness = 1e8;  ///< k_g [N/m]
    Friction friction{0.10, 0.005};
    bool operator==(const Joint&) const = default;
};

struct Tip {
    double angle = 0.19198621771937624;  ///< β, 11° [rad]
    double radius = 28e-3;               ///< R_p [m]
    double hertz = 2.5e10;               ///< K [N/m^1.5]
    double reference_depth = 9e-6;       ///< δ_T at which ζ is anchored [m]
    double deepest = 2e-4;               ///< deeper penetration is a fault [m]
    Friction friction{0.09, 0.01};
    double friction_scale = 1.0;  ///< factor on μ of every law, e.g. of a calibration [1]
    TipFriction friction_law = TipFriction::constant;
    SpeedTable friction_table;          ///< law table: μ over the sliding speed
    double friction_memory = 0.0;       ///< L: distance over which friction follows the sliding speed; 0: at once [m]
    double limiting_traction = 0.05;    ///< law lubricated: μ of a full film
    double roughness = 0.2e-6;          ///< law lubricated: root mean square of both surfaces [m]
    double pressure_sensitivity = 0.0;  ///< a: relative change of μ per relative change of pressure [1]
    double reference_pressure = 1e9;    ///< pressure at which μ applies unchanged [Pa]
    /// Coefficient of friction at the sliding speed where it is largest [1]
    [[nodiscard]] double largest_friction() const noexcept { return friction_scale * friction.coefficient; }
    bool operator==(const Tip&) const = default;
};

/// Oil of tips with the lubricated law.
struct Oil {
    double temperature = 353.15;         ///< [K]
    double viscosity_40 = 0.030;         ///< dynamic viscosity at 40 °C [Pa·s]
    double viscosity_100 = 0.006;        ///< dynamic viscosity at 100 °C [Pa·s]
    double pressure_viscosity = 1.8e-8;  ///< α of Barus' law [1/Pa]
    bool operator==(const Oil&) const = default;
};

/// Heat balance of the losses: pulleys and chain, and the oil around them.
struct Heat {
    bool enabled = false;
    double ambient = 353.15;             ///< temperature of the oil that flows in [K]
    double pulley_capacity = 12e3;       ///< heat capacity of pulleys and chain [J/K]
    double oil_capacity = 2e3;           ///< heat capacity of the oil around them [J/K]
    double pulley_conductance = 100.0;   ///< conductance from pulleys and chain to the oil [W/K]
    double ambient_conductance = 100.0;  ///< conductance from the oil to ambient [W/K]
    bool operator==(const Heat&) const = default;
};

/// Parameters of wear from the recorded loads of tips, and the limit of clamping over slip.
struct Wear {
    double coefficient = 5e-17;               ///< Archard's, volume per force and way [m²/N]
    SpeedTable clamping_limit{{0.0}, {0.0}};  ///< largest clamping force over the slip speed; one value of 0: none [N]
    bool operator==(const Wear&) const = default;
};

struct Pulley {
    double centre_distance = 0.170;       ///< a [m]
    double arc_radius = 2.0;              ///< R_c of the sheave's meridian [m]
    double arc_position = 54.44e-3;       ///< r_m, where the flank leans by β [m]
    double innermost = 25e-3;             ///< a pin on a smaller radius has left the sheave: fault [m]
    double outermost = 80e-3;             ///< a touching pin on a larger radius has left the sheave: fault [m]
    double sheave_mass = 3.0;             ///< [kg]
    double sheave_polar_inertia = 8e-3;   ///< J_p [kg·m²]
    double sheave_tilt_inertia = 4.2e-3;  ///< J_t [kg·m²]
    double shaft_mass = 7.0;              ///< [kg]
    double shaft_polar_inertia = 2e-2;    ///< [kg·m²]
    double shaft_tilt_inertia = 2e-2;     ///< [kg·m²]
    double bearing_radial = 5e8;          ///< [N/m]
    double bearing_axial = 5e8;           ///< [N/m]
    double bearing_tilt = 2e6;            ///< [N·m/rad]
    double attachment_radial = 1e9;       ///< [N/m]
    double attachment_axial = 1e9;        ///< [N/m]
    double attachment_tilt = 1.4e6;       ///< [N·m/rad]
    double attachment_torsion = 5e5;      ///< [N·m/rad]
    double cylinder_damping = 2e5;        ///< c_cyl [N·s/m]
    double damping_ratio = 0.1;           ///< ζ_s [1]
    bool operator==(const Pulley&) const = default;
};

/// Torsional spring and damper between a shaft and what turns beyond it.
struct Coupling {
    double stiffness = 1000.0;  ///< k [N·m/rad]
    double damping = 2.0;       ///< c [N·m·s/rad]
    bool operator==(const Coupling&) const = default;
};

/// Imperfections of a machine, which its drawing does not show.
struct Imperfection {
    double misalignment = 0.0;              ///< offset of pulley 2 along its axis, towards +z [m]
    Sheave sheave = Sheave::driving_fixed;  ///< sheave with run-out, another attachment, or unbalance
    double runout = 0.0;                    ///< radial eccentricity of its flank about the shaft's axis [m]
    double attachment = 1.0;                ///< ratio of the tilt stiffness of its attachment to that of the others
    double unbalance = 0.0;                 ///< mass of the sheave times the distance of its centre of mass from its axis [kg·m]
    double pin_length_spread = 0.0;         ///< standard deviation of the lengths of pins [m]
    std::uint64_t pin_length_seed = 1;      ///< seed of the lengths
    bool operator==(const Imperfection&) const = default;
};

struct Drive {
    DriveMode mode = DriveMode::speed;
    TimeTable speed{209.43951023931953};  ///< ω_ref of shaft 1, or of what drives it through the coupling [rad/s]
    TimeTable torque{0.0};                ///< T_1, mode torque [N·m]
    double governor_frequency = 200.0;    ///< f_g [Hz]
    double inertia = 0.0;                 ///< inertia added to shaft 1 [kg·m²]
    Coupling coupling;                    ///< used in mode coupling
    bool operator==(const Drive&) const = default;
};

/// Load of shaft 2. Before t = 0 `torque` acts in every mode; then the modes speed and coupling take over without a jump of the torque.
struct Load {
    LoadMode mode = LoadMode::torque;
    TimeTable torque{150.0};            ///< M, against the travel of shaft 2 [N·m]
    TimeTable speed{0.0};               ///< ω_ref of shaft 2, or of the inertia beyond the coupling [rad/s]
    double governor_frequency = 200.0;  ///< f_g, mode speed [Hz]
    Coupling coupling;                  ///< used in mode coupling
    double linear = 0.0;                ///< b, torque added per speed of shaft 2 [N·m·s/rad]
    double quadratic = 0.0;             ///< c, torque added per squared speed of shaft 2, with its sign [N·m·s²/rad²]
    double inertia = 0.0;               ///< inertia added to shaft 2 [kg·m²]
    bool operator==(const Load&) const = default;
};

/// Torque that seals, bearings and oil take from a shaft, by its speed; never supplies energy.
struct ShaftDrag {
    double seals = 0.0;     ///< M_s, at any speed [N·m]
    double viscous = 0.0;   ///< b, friction of bearings per speed [N·m·s/rad]
    double churning = 0.0;  ///< c, drag of oil per speed squared [N·m·s²/rad²]
    bool operator==(const ShaftDrag&) const = default;
};

/// Drag of both shafts; none by default.
struct Drag {
    ShaftDrag driving, driven;
    double bearing_friction = 0.0;    ///< μ_B of both shafts' bearings under load [1]
    double bearing_diameter = 40e-3;  ///< d_B, diameter at which that friction acts [m]
    [[nodiscard]] bool present() const noexcept { return driving != ShaftDrag{} || driven != ShaftDrag{} || bearing_friction != 0.0; }
    bool operator==(const Drag&) const = default;
};

/// Guides of both strands: a rail inside and one outside of each, beside the common tangents of the pulleys at start.ratio. None by
/// default.
struct Guide {
    double stiffness = 0.0;     ///< k, stiffness of a rail against a pin; 0: no guides [N/m]
    double damping = 0.5;       ///< χ: relative growth of the normal force per speed of approach [s/m]
    double clearance = 0.3e-3;  ///< c, between a pin in the middle and either rail [m]
    double offset = 0.0;        ///< o, offset of the middle between the rails from the tangent, outwards [m]
    double friction = 0.1;      ///< μ
    double begin = 0.2;         ///< beginning of the rails, as a part of the strand from shaft 1 to shaft 2
    double end = 0.8;           ///< end of the rails, as a part of the strand
    [[nodiscard]] bool present() const noexcept { return stiffness > 0.0; }
    bool operator==(const Guide&) const = default;
};

struct Clamping {
    TimeTable driving{27.1e3};  ///< S_1 [N]
    TimeTable driven{20e3};     ///< S_2 [N]
    double safety = 0.0;        ///< ν: S_2 carries at least ν times the load's torque; 0: S_2 is the table
    bool operator==(const Clamping&) const = default;
};

/// PI control of the speed ratio by S_1, or of slip or safety factor by S_2, or of both shafts at once; in the state only if enabled.
struct Control {
    bool enabled = false;
    ControlledQuantity quantity = ControlledQuantity::ratio;
    TimeTable slip{0.01};                         ///< λ_ref, target slip relative to the sheaves' positions
    TimeTable safety{1.3};                        ///< ν_ref, target safety factor of shaft 2
    TimeTable ratio{1.0};                         ///< i_ref = ω_1/ω_2 [1]
    double proportional = 1e6;                    ///< K_P [N]
    double integral = 5e7;                        ///< K_I [N/s]
    double authority = 1e4;                       ///< A, largest correction of S_1 (of S_2) either way [N]
    double reference_speed = 209.43951023931953;  ///< ω_n in drive mode torque [rad/s]
    DrivenControl driven = DrivenControl::none;   ///< quantity of the second controller, beside ratio control
    double driven_proportional = 5e5;             ///< K_P of the second controller [N]
    double driven_integral = 5e7;                 ///< K_I of the second controller [N/s]
    double driven_authority = 1e4;                ///< A of the second controller [N]
    bool operator==(const Control&) const = default;
};

/// Number of controllers that act, and with it of their integrals.
[[nodiscard]] constexpr int controllers(const Control& control) noexcept {
    if (!control.enabled) return 0;
    return control.quantity == ControlledQuantity::ratio && control.driven != DrivenControl::none ? 2 : 1;
}

/// Beginning of the run.
struct Start {
    StartLayout layout = StartLayout::belt;
    double ratio = 1.0;            ///< r_2/r_1 of the geometric start; speeds follow within 1.5 % (a bent chain is shorter) [1]
    double ring_speed = 200.0;     ///< Ω of the free ring [rad/s]
    double settling_time = 60e-3;  ///< t_settle: a geometric start runs from t = -t_settle [s]
    double ramp_time = 5e-3;       ///< t_ramp ≤ t_settle [s]
    bool operator==(const Start&) const = default;
};

struct Parameters {
    Detail detail;
    Chain chain;
    Half half;
    Plate plate;
    Joint joint;
    Tip tip;
    Oil oil;
    Heat heat;
    Wear wear;
    Pulley pulley;
    Imperfection imperfection;
    Drive drive;
    Load load;
    Drag drag;
    Guide guide;
    Clamping clamping;
    Control control;
    Hydraulics hydraulics;
    Start start;
    bool ledger = false;  ///< integrate losses and works by kind with the state
    bool operator==(const Parameters&) const = default;
};

/// Sum of the pitches of all links [m].
[[nodiscard]] double chain_length(const Chain& chain) noexcept;

/// Factor on clamping and load while settling: smoothstep from -t_settle over t_ramp, one from t = 0 on. t [s]
[[nodiscard]] double ramp(const Start& start, double t) noexcept;

}  // namespace cvtflow::model
