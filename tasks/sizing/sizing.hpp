#pragma once
/// Clamping forces, piston forces and pressures that a load requires, without a run: of a scene's tables at their worst instants, or of a
/// torque over the machine's ratios. Method: docs/own_machine.md.

#include <array>
#include <string>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

/// An instant of a scene's tables, or an operating point. Forces and pressures: index 0 driving, 1 driven.
struct SizedPoint {
    std::string reason;                ///< "largest S_2": why this instant is among the worst
    double time = 0.0;                 ///< [s]
    double ratio = 1.0;                ///< target ratio, without ratio control start.ratio [1]
    double speed = 0.0;                ///< speed of shaft 1 [rad/s]
    double load = 0.0;                 ///< load of the driven pulley, drag included, signed as load.torque [N·m]
    double limit = 0.0;                ///< 2 mu S_2 r_2/cos(beta) [N·m]
    std::string decided;               ///< key that decides S_2
    std::array<double, 2> radius{};    ///< running radii of the pins [m]
    std::array<double, 2> clamping{};  ///< S_1 holds the ratio by the theory of a belt [N]
    std::array<double, 2> piston{};    ///< clamping force without rotating oil and spring [N]
    std::array<double, 2> pressure{};  ///< piston force over the area [Pa]
    std::array<double, 2> least{};     ///< clamping force of rotating oil and spring alone [N]
    double shift = 0.0;                ///< d ln(ratio)/dt that is asked for [1/s]
    double shifting = 0.0;             ///< S_1 while the ratio shifts so [N]
    double correction = 0.0;           ///< largest of both S_1 beside the table: what control has to add, signed [N]
    std::string objection;             ///< why S_1 is not known; empty: it is

    [[nodiscard]] double factor() const noexcept;  ///< limit over |load|; infinite without load [1]
};

/// Worst points, or the reason why there are none.
struct Sizing {
    std::vector<SizedPoint> points;
    std::string objection;
    bool of_tables = false;              ///< points are instants of the scene's tables
    std::vector<SizedPoint> instants{};  ///< of the tables: all, of which points are the worst
};

/// Instants of largest S_2, largest S_1, least safety and fastest shift, without S_1: size_driving() adds it.
[[nodiscard]] Sizing size_scene(const Scene& scene);
/// A torque on shaft 1 with a safety factor and without losses, at five ratios over those that the sheaves permit; likewise without S_1.
/// torque [N·m], safety [1]
[[nodiscard]] Sizing size_for_torque(const Scene& scene, double torque, double safety);
/// Adds S_1, by the theory of a belt, and what follows from it.
void size_driving(const Scene& scene, SizedPoint& at);

/// Sentences on what of a scene lies outside of the ranges in which errors are known (docs/validity.md, whose figures these are), in the
/// order of the page. Empty: nothing does.
/// @param sizing of the scene's tables; without instants only what is constant is judged   @param automatic_step [s]
[[nodiscard]] std::vector<std::string> outside_validity(const Scene& scene, const Sizing& sizing, double automatic_step);

}  // namespace cvtflow::tasks
