#pragma once
/// Means of short runs against those of longer ones: where a machine drawn by chance has other means later, its short run has a note.

#include <string>
#include <string_view>
#include <vector>

#include "bench/study/extremes/lottery.hpp"

namespace cvtflow::bench {

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
