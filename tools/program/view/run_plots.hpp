#pragma once
/// Pictures of records, and their spectra over orders: passing pins, the pattern of the pitches, rounds of the chain, turns of the shafts.
/// The chain at its recorded states.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

struct AmplitudeSpectrum {
    std::vector<double> frequency;  ///< [Hz], from 0 to half of the sampling rate
    std::vector<double> amplitude;  ///< a sine of amplitude a at a frequency of the grid has a peak of a
};

/// Spectrum of equidistant values: the line that fits best in the window removed, since a drift leaks into low orders; Hann window, padded
/// with zeros to a power of two of at least twice the length. Empty for fewer than 8 values. A trailing value at another distance (a run
/// that ended between outputs) is left out.
[[nodiscard]] AmplitudeSpectrum amplitude_spectrum(const std::vector<double>& times, std::vector<double> values);

/// Something that repeats while a chain runs.
struct Repetition {
    std::string name;        ///< "pins", "pitch pattern", "round of the chain", "shaft 1", "shaft 2"
    double frequency = 0.0;  ///< mean over the run [Hz]
    bool multiples = false;  ///< whether multiples are marked as well
    std::string colour;      ///< of its lines; empty: it has none
};

/// Links after which the pitches repeat; 1: all are equal. @param pitch [m], repeated cyclically over `links`
[[nodiscard]] int pattern_length(const std::vector<double>& pitch, int links);

/// Repetitions in the record and its scene; pins first. Empty if the record does not contain the chain's speed.
[[nodiscard]] std::vector<Repetition> repetitions(const RecordedRun& run);

/// Vertical lines at the orders of the repetitions, as series for the legend, up to the order `end`.
/// @param range lower and upper end of the lines
[[nodiscard]] std::vector<Series> order_lines(const std::vector<Repetition>& all, double end, std::pair<double, double> range);

/// "order 1 = 1404 Hz; pitch pattern 0.5, round of the chain 0.0119, shaft 1 0.0237, shaft 2 0.0236".
[[nodiscard]] std::string orders_text(const std::vector<Repetition>& all);

/// Curves over time or another channel, a plot per unit; several runs in each. Runs longer than 60 pin periods are shown as means over pin
/// periods, but for lengths, whose swings these would hide.
/// Curves that are zero throughout are named in the subtitle, unless there is no other.
/// @param words channels and groups; none: the overview   @param every_output also of long runs   @param measured drawn as points if given
/// @param x channel, or one number of it; empty: time   @throws UsageError for a word that names nothing
[[nodiscard]] std::vector<Plot> time_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words, bool every_output,
                                           const Measured* measured = nullptr, const std::string& x = {});

/// Curve of a channel of one number: its outputs [s], [unit of the channel], or means over pin periods at the middles of these.
struct DrawnCurve {
    std::vector<double> times, values;
};
/// A channel as time_plots() draws it without `every_output`.
[[nodiscard]] DrawnCurve drawn_curve(const RecordedRun& run, const engine::ChannelInfo& channel);

/// Their amplitudes over orders of the pins that pass in the first run; over frequency if the record does not contain them.
[[nodiscard]] std::vector<Plot> order_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words);

/// The way of the followed pin in the plane of the chain. @throws UsageError if a record does not have it
[[nodiscard]] Plot round_plot(const std::vector<RecordedRun>& runs);

/// Mean losses of one run by kind as bars with their shares, largest first. @throws UsageError if it has none
[[nodiscard]] Plot loss_plot(const RecordedRun& run);

/// Points thinned without visible change of a line through them: minimum and maximum of each of `columns` stretches.
[[nodiscard]] std::vector<Point> thinned(const std::vector<Point>& points, std::size_t columns);

/// Contents of plots as CSV: series, x, y, the labels of both axes.
[[nodiscard]] std::string csv(const std::vector<Plot>& plots);

/// Whether the record contains what wear_plots takes.
[[nodiscard]] bool has_wear(const RecordedRun& run);

/// Over the radius of each sheave: friction energy, largest pressure times sliding speed, Archard's depth; over the tips: Archard's depth.
/// Sums over the record's rows by the trapezoidal rule.
/// @throws UsageError if the record lacks channels of the group wear, or a scene that this program can read
[[nodiscard]] std::vector<Plot> wear_plots(const RecordedRun& run);

}  // namespace cvtflow::tools
