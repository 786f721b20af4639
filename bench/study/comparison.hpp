#pragma once
/// Methods with their steps on one stretch of one scene: how far from a tight reference, after how much work.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tasks/run/run_watch.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/control/step_controller.hpp"
#include "tasks/step/frozen_start.hpp"

namespace cvtflow::bench {

struct Candidate {
    std::string method;
    double step = 0.0;  ///< 0: automatic [s]
};

/// What a candidate computed, at every output time.
struct Course {
    std::vector<double> time;                    ///< [outputs] since the start [s]
    std::vector<std::vector<double>> tip_axial;  ///< [outputs][4 links] [N]
    std::vector<std::vector<double>> tension;    ///< [outputs][links] [N]
    std::vector<tasks::TransitionRecord> transitions;
    std::vector<double> side;  ///< [links] x of the rear halves at the start [m]

    /// Axial force of a pin on the sheave at that side (0: -z, 1: +z) over the outputs: of its rear half and of the front half before it.
    [[nodiscard]] std::vector<double> pin_axial(int pin, int sheave_side) const;
};

struct Compared {
    Candidate candidate;
    tasks::Fault fault;       ///< why it stopped early; errors are then NaN
    double step = 0.0;        ///< in use: that asked for or a little less; the last one of automatic steps [s]
    tasks::RunVerdict watch;  ///< whether its figures can be right
    tasks::Counters counters;
    double seconds = 0.0;        ///< median over the rounds of what the run took, without outputs [s]
    double error_axial = 0.0;    ///< ‖axial force of all tips - reference‖/‖reference‖, over all outputs [1]
    double error_tension = 0.0;  ///< the same of the tensions of all links [1]
    double error_pin = 0.0;      ///< the same of the pin that enters [1]
    Course course;
};

struct ComparisonOptions {
    double duration = 1e-3;          ///< [s]
    double output_interval = 12e-6;  ///< a multiple of most steps [s]
    Candidate reference{"rk4", 12.5e-9};
    int rounds = 3;               ///< of timing, all candidates in turns
    std::optional<int> pin = {};  ///< whose axial force is looked at; nothing: the first that enters the driving sheaves
    std::function<void(const std::string&)> progress;  ///< may be empty
};

struct Comparison {
    Course reference;
    tasks::Counters reference_counters;
    tasks::RunVerdict reference_watch;
    std::optional<int> pin = {};  ///< looked at; nothing: none enters
    double entry = 0.0;           ///< when it enters, since the start [s]
    std::vector<Compared> candidates;
};

/// One thread, every candidate from the same start, transitions as in a run.
/// @throws std::invalid_argument for unknown methods; SimulationError if the reference itself fails
[[nodiscard]] Comparison compare(const model::Parameters& parameters, const tasks::FrozenStart& start,
                                 std::span<const Candidate> candidates, const ComparisonOptions& options,
                                 const engine::Cancellation& cancel);

}  // namespace cvtflow::bench
