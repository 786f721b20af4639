#pragma once
/// Machines drawn by chance, run with default settings: a run that is reported as `finished` must be accurate.
/// And means of short runs against those of longer ones: where a machine has other means later, its short run has a note.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

/// Settings with which a machine of the lottery is run.
struct LotteryRules {
    std::string detail;            ///< level of detail of all machines; empty: as drawn
    double settling_time = 20e-3;  ///< [s]
    double duration = 20e-3;       ///< [s]
    double refinement = 4.0;       ///< factor by which steps of the comparison are shorter [1]
    double tolerance = 0.01;       ///< tolerance of slip and losses
    double longer = 0.0;           ///< 0, or the means of `duration` are compared with those of a run longer by this factor [1]
    double min_slip = 5e-4;  ///< lower bound of the slip that differences are divided by: 1 % of it is below the accuracy of shaft speeds
};

struct LotteryMachine {
    std::string scene;                  ///< ready scene whose settled state it begins with; empty: it settles from defaults
    std::vector<std::string> settings;  ///< "key=value"
};

/// Machine `number`. Two of three: every physical parameter but lengths and angles within a factor of 2 of its default, clamping
/// 5 … 80 kN, 500 … 6000 rpm, ratio 2.4, 1 or 0.417, up to 0.9 of the torque that friction carries, any level of detail, both friction
/// laws, both contact laws of joints. One of three: a ready scene with its state, of which one or two physical parameters are drawn. Some
/// have another chain (mixed pitches, thickness, joint radius, plates), and a load that is zero, is reversed, or jumps. A seed gives the
/// same machines everywhere.
[[nodiscard]] LotteryMachine lottery_machine(std::uint64_t seed, long number);

/// Result of a machine.
struct LotteryTicket {
    long number = 0;
    std::string detail;
    bool ready = false;                           ///< began with a ready state that fits
    double step = 0.0;                            ///< last one in use [s]
    std::string status;                           ///< finished, unreliable, a fault's name, or refused
    std::string notes;                            ///< names of notes on the run
    double slip = 0.0, exact_slip = 0.0;          ///< mean over the run; with shorter steps from the same settled start [1]
    double loss = 0.0, exact_loss = 0.0;          ///< dissipated [J]
    double residual = 0.0, exact_residual = 0.0;  ///< residual of the energy balance over the losses
    double balance_error_ratio = 0.0;             ///< EnergyLedger::balance_error_ratio [1]
    double wall = 0.0;                            ///< wall time without the comparison [s]
    std::string message;                          ///< message of a fault or refusal

    /// Relative differences.
    [[nodiscard]] double slip_error(const LotteryRules& rules) const noexcept;
    [[nodiscard]] double loss_error() const noexcept;
    /// Whether losses agree with the comparison, and slip, unless a note states that no torque is transferred.
    [[nodiscard]] bool right(const LotteryRules& rules) const noexcept;
    /// Whether the result is right, or not reported as finished.
    [[nodiscard]] bool honest(const LotteryRules& rules) const noexcept { return status != "finished" || right(rules); }
    /// Whether the result is right, but reported as unreliable.
    [[nodiscard]] bool false_alarm(const LotteryRules& rules) const noexcept { return status == "unreliable" && right(rules); }
};

/// The machine as a scene; where longer times are compared, nine of ten hold their ratio by control, and a third have strand guides.
[[nodiscard]] tasks::Scene lottery_scene(std::uint64_t seed, long number, const LotteryRules& rules);

/// Settles and runs a machine with defaults, and once more with shorter steps.
[[nodiscard]] LotteryTicket play(std::uint64_t seed, long number, const LotteryRules& rules);

/// Machines first … first + count - 1, on `threads` threads.
[[nodiscard]] std::vector<LotteryTicket> play_all(std::uint64_t seed, long first, long count, int threads, const LotteryRules& rules);

/// Means of a machine over a short time, compared with those over the last half of a longer one.
struct LongerTicket {
    long number = 0;
    std::string status;         ///< status of the short run: finished, a fault's name, or refused
    std::string later;          ///< fault of the longer run
    std::string notes;          ///< names of the short run's notes
    std::string_view quantity;  ///< quantity whose mean differs most from that of the longer run
    double off = 0.0;           ///< difference over the longer run's mean, at least 0.3 % for slip, a tenth of tight for slack
    double wall = 0.0;          ///< [s]

    [[nodiscard]] bool compared() const noexcept { return status == "finished" && later.empty(); }
    /// Whether a note states that the means are no results.
    [[nodiscard]] bool noted() const noexcept {
        return notes.find("unsteady") != std::string::npos || notes.find("uncertain") != std::string::npos;
    }
};

/// Machines first … first + count - 1 with rules.longer above 1, on `threads` threads.
[[nodiscard]] std::vector<LongerTicket> play_longer(std::uint64_t seed, long first, long count, int threads, const LotteryRules& rules);

}  // namespace cvtflow::bench
