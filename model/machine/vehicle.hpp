#pragma once
/// A vehicle behind shaft 2 and its load on that shaft; a driving cycle, the tables of shafts and ratio that follow from it, and the
/// energies of the trip. (model/EQUATIONS.md section 13)

#include <array>
#include <vector>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

struct Vehicle {
    double mass = 0.0;                  ///< 0: no vehicle [kg]
    double wheel_radius = 0.3;          ///< r [m]
    double wheel_inertia = 0.0;         ///< inertia of all wheels and the parts that turn with them [kg·m²]
    double final_drive = 5.5;           ///< i_f, speed of shaft 2 over the wheels'
    double efficiency = 1.0;            ///< efficiency of the final drive, in a cycle
    double drag_area = 0.62;            ///< c_w A [m²]
    double air_density = 1.2;           ///< [kg/m³]
    double rolling_resistance = 0.012;  ///< rolling resistance over the weight
    TimeTable grade{0.0};               ///< rise of the road over its horizontal length
    [[nodiscard]] bool present() const noexcept { return mass > 0.0; }
    [[nodiscard]] double lever() const noexcept { return wheel_radius / final_drive; }                              ///< [m]
    [[nodiscard]] double inertia() const noexcept { return mass + wheel_inertia / (wheel_radius * wheel_radius); }  ///< [kg]
    bool operator==(const Vehicle&) const = default;
};

/// Speed of the vehicle over time, and the rules by which a driver follows it.
struct Cycle {
    TimeTable speed{0.0};                                  ///< v; 0 throughout: no cycle [m/s]
    double begin = 0.0;                                    ///< time of the tables at t = 0 [s]
    SpeedTable engine_speed{{0.0}, {151.84364492350666}};  ///< target of ω_1 over v [rad/s]
    double idle_speed = 94.24777960769379;                 ///< smallest ω_1, at which the clutch slips [rad/s]
    double min_ratio = 0.6, max_ratio = 2.2;
    double engine_drag = 15.0;  ///< largest torque by which shaft 1 brakes [N·m]
    double pedal_time = 0.5;    ///< time over which tables are means, and between their points [s]
    [[nodiscard]] bool present() const noexcept { return speed.largest_magnitude() > 0.0; }
    /// Number of pedal times from `begin` to the end.
    [[nodiscard]] double intervals() const noexcept { return (speed.time.back() - begin) / pedal_time; }
    bool operator==(const Cycle&) const = default;
};

/// Accounts of a trip: energies [J] but for `distance` [m]. shaft = kinetic + climb + air + rolling + brakes + clutch + final_drive.
enum class TripAccount { distance, traction, shaft, kinetic, climb, air, rolling, brakes, clutch, final_drive };
using TripSums = std::array<double, 10>;  ///< energies and distance by account [J, m]

/// Load of a vehicle without clutch and cycle: inertia, torque and drag of shaft 2.
void load_by(const Vehicle& vehicle, Load& load);

/// A vehicle that follows a cycle exactly. Without a cycle it is empty.
class Trip {
public:
    Trip() = default;
    Trip(const Vehicle& vehicle, const Cycle& cycle) { follow(vehicle, cycle); }
    /// Changes the vehicle and the cycle. Allocates nothing if neither is a longer table than before.
    void follow(const Vehicle& vehicle, const Cycle& cycle);

    [[nodiscard]] double speed(double t) const noexcept;  ///< vehicle speed [m/s]. t [s]
    /// Accounts from t = 0 on; zero without a cycle. t [s]
    [[nodiscard]] TripSums sums(double t) const noexcept;
    /// Sets the parameters that follow from the cycle: speed of shaft 1, ratio, torque of shaft 2, ratio of the start.
    void command(Parameters& parameters) const;
    [[nodiscard]] int points() const noexcept { return static_cast<int>(sums_.size()); }  ///< number of points of these tables

private:
    struct Demand {
        double driving = 0.0, ratio = 0.0, torque = 0.0;  ///< ω_1 [rad/s], ω_1/ω_2, torque of shaft 2 [N·m]
        TripSums power{};                                 ///< rates of the accounts
    };
    [[nodiscard]] Demand demand(double t) const noexcept;
    /// Integral of demand() [unit s]. from, to [s]
    [[nodiscard]] Demand integral(double from, double to) const noexcept;

    Vehicle vehicle_;
    Cycle cycle_;
    TimeTable engine_speed_;      ///< table over v [m/s] instead of a time
    std::vector<TripSums> sums_;  ///< sums at 0, pedal_time, 2 pedal_time …, up to the end of the cycle
};

}  // namespace cvtflow::model
