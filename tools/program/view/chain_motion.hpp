#pragma once
/// The chain at its recorded states: where its pins are and what they carry.

#include <array>
#include <cstddef>
#include <vector>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

struct ChainMotion {
    int pins = 0;
    std::size_t recorded = 0;      ///< states of the record; more than `times` where they were thinned
    std::vector<double> times;     ///< [s]
    std::vector<float> x, y, z;    ///< [states * pins], of the middles of the pins' rear halves [m]
    std::vector<float> pin_force;  ///< axial force of a pin on its sheaves, mean of both sides [N]; empty: not recorded
    std::vector<float> tension;    ///< of the link behind the pin [N]; empty: not recorded
    std::vector<float> slip;       ///< 1 - Ω/ω of a pin that touches sheaves, Ω about their axis; 0 elsewhere; empty: no pulleys
    std::vector<float> side;       ///< 0: free, 1, 2: between the sheaves of that shaft
    std::array<std::vector<float>, 2> angle, radius;  ///< per state: of the shafts [rad]; mean of the pins on them [m]
    double centre_distance = 0.0, pin_length = 0.0, pin_width = 0.0, flank = 0.0;  ///< [m]; flank: β [rad]
    double innermost = 0.0, outermost = 0.0;                                       ///< radii of the sheaves [m]
    int plates = 0;
    double plate_span = 0.0;  ///< [m]
    bool pulleys = false;
};

/// Motion over at most `max_states` states, equally spaced among the recorded ones. Without pins if the record has no states or no readable
/// scene.
[[nodiscard]] ChainMotion chain_motion(const RecordedRun& run, std::size_t max_states);

/// Axial force of the pins over the angle about the shaft: mean over all states, with minimum and maximum.
[[nodiscard]] Plot pin_force_plot(const ChainMotion& motion, const std::string& conditions);

}  // namespace cvtflow::tools
