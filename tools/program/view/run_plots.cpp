#include "tools/program/view/run_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

namespace {
constexpr double max_order = 20.0;  ///< up to which multiples are marked
constexpr int max_pattern = 6;      ///< links of a pattern whose multiples can still be distinguished

constexpr std::size_t columns_drawn = 1500;  ///< of pixels, or of half pixels

std::vector<Curve> chosen(const RecordedRun& run, const std::vector<std::string>& words) {
    if (words.empty()) return run.overview();
    std::vector<Curve> curves;
    for (const std::string& word : words) {
        for (Curve& curve : run.find(word)) curves.push_back(std::move(curve));
    }
    return curves;
}

bool controls_ratio(const RecordedRun& run) {
    return run.scene() && run.scene()->parameters.control.quantity == model::ControlledQuantity::ratio;
}

std::string subtitle_of(const std::vector<RecordedRun>& runs) {
    std::string text;
    for (const RecordedRun& run : runs) {
        const std::string conditions = run.conditions();
        if (text.find(conditions) == std::string::npos) text += (text.empty() ? "" : "; ") + conditions;
    }
    return text;
}

/// One number without a unit is a quantity of its own: ratio and efficiency share no axis.
std::string kind_of(const Curve& curve) { return curve.unit == "1" ? curve.name : shown(curve.name, curve.unit).unit; }

/// "shaft_1/speed" of one run, "shaft_1/speed, other.h5 (load.torque 8 N*m)" of several.
std::string name_in(const std::vector<RecordedRun>& runs, const RecordedRun& run, const std::string& name) {
    if (runs.size() == 1) return name;
    const std::string setting = only_difference(runs, run);
    return fmt::format("{}, {}{}", name, run.path(), setting.empty() ? "" : " (" + setting + ")");
}

/// Target of a ratio that is controlled, for the panel of the ratio; empty where another quantity is, or nothing.
std::vector<double> target_of(const RecordedRun& run, const Curve& curve) {
    return curve.name == "ratio" && controls_ratio(run) ? run.values("control/target") : std::vector<double>();
}

double mean_of(const std::vector<double>& values) { return FiniteFigures(values).mean; }

struct Panel {
    std::string kind;
    Plot plot;
};

Plot& panel_of(std::vector<Panel>& panels, const Curve& curve) {
    const std::string kind = kind_of(curve);
    const auto found = std::find_if(panels.begin(), panels.end(), [&](const Panel& panel) { return panel.kind == kind; });
    if (found != panels.end()) {
        const bool new_name = found->plot.title.find(curve.name) == std::string::npos;
        found->plot.title += new_name ? ", " + curve.name : "";
        if (new_name) found->plot.y.label = label_of_unit(kind);
        return found->plot;
    }
    panels.push_back({kind, {}});
    panels.back().plot.title = curve.name;
    panels.back().plot.y.label = shown(curve.name, curve.unit).label;
    return panels.back().plot;
}

/// "loss: " where all curves are of one group.
std::string group_of(const Plot& plot) {
    const std::string group = plot.series.front().name.substr(0, plot.series.front().name.find('/') + 1);
    const auto within = [&](const Series& series) { return series.name.starts_with(group); };
    return group.empty() || !std::ranges::all_of(plot.series, within) ? "" : group.substr(0, group.size() - 1) + ": ";
}

/// Titles that say too much, and heights of several pictures below one another.
std::vector<Plot> finished(std::vector<Panel>& panels, const std::string& subtitle) {
    std::vector<Plot> plots;
    for (Panel& panel : panels) {
        Plot& plot = panel.plot;
        if (plot.title.size() > 80) plot.title = fmt::format("{}{} channels", group_of(plot), plot.series.size());
        plot.subtitle = plots.empty() ? subtitle : "";
        if (panels.size() > 1) plot.height = plots.empty() ? 320.0 : 300.0;
        if (plot.series.size() == 1) plot.series.front().name.clear();
        plots.push_back(std::move(plot));
    }
    return plots;
}

/// Largest magnitude of a curve; 0 where no value is finite.
double largest_of(const Series& series) {
    const auto& points = series.points;
    const auto most = finite_extremes(points.begin(), points.end(), [](const Point& point) { return std::abs(point.y); }).second;
    return most != points.end() && std::isfinite(most->y) ? std::abs(most->y) : 0.0;
}

/// Removes curves that lie on the axis: zero throughout, unless all are; and of a group those below 1 % of its largest.
/// @param words as the user gave them: a curve that is named is drawn   @return "; zero: loss/cylinder; below 1 %: loss/inner, …"
std::string remove_small(std::vector<Panel>& panels, const std::vector<std::string>& words) {
    constexpr double visible = 0.01;
    const auto named = [&](const Series& series) {
        return words.empty() || std::ranges::any_of(words, [&](const std::string& word) {
                   return series.name == word || series.name.starts_with(word + ",");
               });
    };
    const auto is_zero = [](const Series& series) { return largest_of(series) == 0.0; };
    const auto empty = [&](const Panel& panel) { return std::ranges::all_of(panel.plot.series, is_zero); };
    if (std::ranges::all_of(panels, empty)) return "";
    std::string zeros, small;
    for (Panel& panel : panels) {
        std::map<std::string, double> largest;  // of each group
        const auto group = [](const Series& series) { return series.name.substr(0, series.name.find('/')); };
        for (const Series& series : panel.plot.series) largest[group(series)] = std::max(largest[group(series)], largest_of(series));
        std::erase_if(panel.plot.series, [&](const Series& series) {
            const bool zero = is_zero(series), leaves = zero || (!named(series) && largest_of(series) < visible * largest[group(series)]);
            std::string& names = zero ? zeros : small;
            if (leaves) names += (names.empty() ? (zero ? "; zero: " : "; below 1 %: ") : ", ") + series.name;
            return leaves;
        });
    }
    std::erase_if(panels, [](const Panel& panel) { return panel.plot.series.empty(); });
    return zeros + small;
}

Series line_through(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                    std::size_t columns = columns_drawn) {
    std::vector<Point> points;
    for (std::size_t k = 0; k < std::min(x.size(), y.size()); ++k) points.push_back({x[k], y[k]});
    return {name, thinned(points, columns), Mark::none, Line::solid, "", 1.4};
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& value : values) value *= factor;
    return values;
}

/// The one curve that a word names. @throws UsageError where it names several
Curve curve_along_x(const RecordedRun& run, const std::string& word) {
    std::vector<Curve> curves = run.find(word);
    if (curves.size() == 1) return std::move(curves.front());
    throw UsageError(fmt::format("--x {}: {} curves; choose one number, such as {}", word, curves.size(), curves.front().name));
}

/// Means over whole pin periods at the middles of these; what a long run shows.
DrawnCurve period_means(const std::vector<double>& times, const std::vector<double>& values, double period) {
    DrawnCurve means;
    double end = times.front() + period, sum = 0.0;
    long count = 0;
    for (std::size_t k = 0; k < std::min(times.size(), values.size()); ++k) {
        if (times[k] >= end && count > 0) {
            means.times.push_back(end - 0.5 * period);
            means.values.push_back(sum / static_cast<double>(count));
            sum = 0.0, count = 0;
            end += period * std::max(1.0, std::ceil((times[k] - end) / period));
        }
        if (std::isfinite(values[k])) sum += values[k], ++count;
    }
    return means;
}

constexpr double long_run = 60.0;  ///< pin periods beyond which vibrations would be a solid band

/// The pin period of a run that is longer than that [s]; 0: every output is drawn, also of lengths, whose swings such means would hide.
/// @param unit of the curve
double averaged_period(const RecordedRun& run, const std::string& unit) {
    if (unit == "m") return 0.0;
    const auto pins = run.pin_frequency();
    const double span = run.times().back() - run.times().front();
    if (!pins || span * *pins < long_run || static_cast<double>(run.times().size()) < 4.0 * span * *pins) return 0.0;
    return 1.0 / *pins;
}

/// A curve as it is drawn. @param period as averaged_period()
DrawnCurve drawn_of(const RecordedRun& run, const std::vector<double>& values, double period) {
    return period > 0.0 ? period_means(run.times(), values, period) : DrawnCurve{run.times(), values};
}

/// Millimetres are as long in either direction.
void equalise(Plot& plot) {
    double x[2]{INFINITY, -INFINITY}, y[2]{INFINITY, -INFINITY};
    for (const Series& series : plot.series) {
        for (const Point& point : series.points) {
            x[0] = std::min(x[0], point.x), x[1] = std::max(x[1], point.x);
            y[0] = std::min(y[0], point.y), y[1] = std::max(y[1], point.y);
        }
    }
    const double margin = 0.05 * std::max({x[1] - x[0], y[1] - y[0], 1e-6});
    plot.x.from = x[0] - margin, plot.x.to = x[1] + margin;
    plot.y.from = y[0] - margin, plot.y.to = y[1] + margin;
    constexpr double beside = 90.0, above = 114.0;  // what the frame leaves of the picture, with labels and headings [px]
    const double shape = (*plot.y.to - *plot.y.from) / (*plot.x.to - *plot.x.from);
    plot.height = std::clamp(above + (plot.width - beside) * shape, 240.0, 1200.0);
}

/// Lower and upper end of the vertical axis for amplitudes drawn up to the order `end`: no empty decades, six at most.
std::pair<double, double> amplitude_range(const Plot& plot, double end) {
    double largest = 1e-300, smallest = INFINITY;
    for (const Series& series : plot.series) {
        for (const Point& point : series.points) {
            largest = std::max(largest, point.y);
            if (point.x <= end && point.y > 0.0) smallest = std::min(smallest, point.y);
        }
    }
    return {std::max(1e-6 * largest, 0.5 * std::min(smallest, largest)), 2.0 * largest};
}

/// Points of the measured columns among the curves of the first run. @throws UsageError if there is none
void add_measured(std::vector<Panel>& panels, const std::vector<Curve>& curves, const Measured& measured, const Curve& x, double factor) {
    bool any = false;
    for (const Curve& curve : curves) {
        if (measured.find(curve.name, curve.unit) == nullptr) continue;
        Series points = measured.points({x.name, x.unit}, {curve.name, curve.unit}, fmt::format("{}, {}", curve.name, measured.name));
        for (Point& point : points.points) point.x *= factor / shown(x.name, x.unit).factor;
        panel_of(panels, curve).series.push_back(std::move(points));
        any = true;
    }
    if (!any) throw UsageError(fmt::format("--with {}: its columns are none of the channels that are drawn", measured.path));
}

}  // namespace

DrawnCurve drawn_curve(const RecordedRun& run, const engine::ChannelInfo& channel) {
    return drawn_of(run, run.values(channel.name), averaged_period(run, channel.unit));
}

AmplitudeSpectrum amplitude_spectrum(const std::vector<double>& times, std::vector<double> values) {
    AmplitudeSpectrum spectrum;
    if (times.size() != values.size() || values.size() < 8) return spectrum;
    const double distance = times[1] - times[0];
    if (!(distance > 0.0)) return spectrum;
    if (std::abs(times.back() - times[times.size() - 2] - distance) > 1e-3 * distance) values.pop_back();
    const auto count = static_cast<double>(values.size());
    const double mean = FiniteFigures(values).mean;
    for (double& value : values) value = std::isfinite(value) ? value : mean;
    std::vector<double> window(values.size());
    double weights = 0.0, level = 0.0, slope = 0.0, spread = 0.0;
    const auto place = [&](std::size_t k) { return static_cast<double>(k) - 0.5 * count; };  // the window is even about 0
    for (std::size_t k = 0; k < values.size(); ++k) {
        window[k] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / count);
        weights += window[k];
        level += window[k] * values[k];
        slope += window[k] * values[k] * place(k);
        spread += window[k] * place(k) * place(k);
    }
    std::vector<double> padded(2 * std::bit_ceil(values.size()));
    for (std::size_t k = 0; k < values.size(); ++k) padded[k] = window[k] * (values[k] - level / weights - slope / spread * place(k));
    std::vector<std::complex<double>> transformed;
    Eigen::FFT<double>().fwd(transformed, padded);
    for (std::size_t k = 0; k <= padded.size() / 2; ++k) {
        spectrum.frequency.push_back(static_cast<double>(k) / (static_cast<double>(padded.size()) * distance));
        spectrum.amplitude.push_back(2.0 * std::abs(transformed[k]) / weights);
    }
    return spectrum;
}

int pattern_length(const std::vector<double>& pitch, int links) {
    const auto at = [&](int link) { return pitch[static_cast<std::size_t>(link) % pitch.size()]; };
    for (int length = 1; length < links; ++length) {
        if (links % length != 0) continue;
        bool repeats = true;
        for (int link = length; link < links && repeats; ++link) repeats = at(link) == at(link - length);
        if (repeats) return length;
    }
    return links;
}

std::vector<Repetition> repetitions(const RecordedRun& run) {
    const auto pins = run.pin_frequency();
    if (!pins) return {};
    const model::Chain& chain = run.scene()->parameters.chain;
    std::vector<Repetition> all{{"pins", *pins, true, "#999999"}};
    const int pattern = pattern_length(chain.pitch, chain.pins);
    if (pattern > 1) all.push_back({"pitch pattern", *pins / pattern, pattern <= max_pattern, "#b8860b"});
    all.push_back({"round of the chain", *pins / chain.pins, false, ""});
    for (const int shaft : {1, 2}) {
        const double mean = FiniteFigures(run.values(fmt::format("shaft_{}/speed", shaft))).mean / (2.0 * std::numbers::pi);
        if (mean > 0.0) all.push_back({fmt::format("shaft {}", shaft), mean, false, shaft == 1 ? "#333333" : "#aa3377"});
    }
    return all;
}

std::vector<Series> order_lines(const std::vector<Repetition>& all, double end, std::pair<double, double> range) {
    std::vector<Series> drawn;
    for (const Repetition& each : all) {
        if (each.colour.empty()) continue;
        const bool pins = &each == &all.front();
        const std::string multiples = each.multiples ? " and multiples" : "";
        const std::string name = fmt::format("{}: {:.4g} Hz{}", pins ? "pins pass" : each.name, each.frequency, multiples);
        Series lines{name, {}, Mark::none, pins ? Line::dashed : Line::dotted, each.colour, pins ? 1.0 : 1.4};
        const double first = each.frequency / all.front().frequency, last = std::min(end, each.multiples ? max_order : first);
        for (int multiple = 1; multiple * first <= last; ++multiple) {
            const double order = multiple * first;
            if (!pins && std::abs(order - std::round(order)) < 1e-6) continue;  // pins pass there
            for (const double y : {range.first, range.second, static_cast<double>(NAN)}) lines.points.push_back({order, y});
        }
        drawn.push_back(std::move(lines));
    }
    return drawn;
}

std::string orders_text(const std::vector<Repetition>& all) {
    std::string text = fmt::format("order 1 = {:.4g} Hz", all.front().frequency);
    for (std::size_t k = 1; k < all.size(); ++k)
        text += fmt::format("{} {} {:.3g}", k == 1 ? ";" : ",", all[k].name, all[k].frequency / all.front().frequency);
    return text;
}

std::vector<Point> thinned(const std::vector<Point>& points, std::size_t columns) {
    if (points.size() <= 2 * columns) return points;
    std::vector<Point> kept;
    for (std::size_t column = 0; column < columns; ++column) {
        const auto begin = points.begin() + static_cast<std::ptrdiff_t>(column * points.size() / columns);
        const auto end = points.begin() + static_cast<std::ptrdiff_t>((column + 1) * points.size() / columns);
        auto [first, second] = finite_extremes(begin, end, [](const Point& point) { return point.y; });
        if (second < first) std::swap(first, second);
        kept.push_back(*first);
        if (first != second) kept.push_back(*second);
    }
    return kept;
}

std::vector<Plot> time_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words, bool every_output,
                             const Measured* measured, const std::string& x) {
    constexpr std::size_t stretches = 10000;  // of a curve that is drawn over another one
    std::vector<Panel> panels;
    std::string means, samples;
    Shown along = shown_time(last_time(runs));
    Curve across{"time", "s", {}, {}};
    for (const RecordedRun& run : runs) {
        if (const std::string how = run.sampling(); !how.empty()) samples = "; " + how;
        if (!x.empty()) across = curve_along_x(run, x), along = shown(across.name, across.unit);
        for (const Curve& curve : chosen(run, words)) {
            const bool with_ratio = curve.name == "control/target" && std::ranges::count(words, "ratio") > 0 && controls_ratio(run);
            if (curve.name == across.name || (x.empty() && with_ratio)) continue;
            const double period = every_output || across.unit == "m" ? 0.0 : averaged_period(run, curve.unit);
            if (period > 0.0) means = fmt::format("; means over pin periods ({})", time_text(period));
            Plot& plot = panel_of(panels, curve);
            plot.x.label = along.label;
            const DrawnCurve drawn = drawn_of(run, curve.values, period);
            const std::vector<double> values = scaled(drawn.values, shown(curve.name, curve.unit).factor);
            const std::string name = name_in(runs, run, curve.name);
            if (const std::vector<double> target = target_of(run, curve); x.empty() && !target.empty()) {
                plot.series.push_back(line_through(name_in(runs, run, "control/target"), scaled(run.times(), along.factor), target));
                plot.series.back().line = Line::dashed, plot.series.back().colour = "#555555";
            }
            plot.series.push_back(
                x.empty() ? line_through(name, scaled(drawn.times, along.factor), values)
                          : line_through(name, scaled(drawn_of(run, across.values, period).values, along.factor), values, stretches));
        }
    }
    if (measured != nullptr) add_measured(panels, chosen(runs.front(), words), *measured, across, along.factor);
    const std::string left_out = remove_small(panels, words);
    return finished(panels, subtitle_of(runs) + means + samples + left_out);
}

std::vector<Plot> order_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words) {
    std::vector<Panel> panels;
    double end = INFINITY;
    const std::vector<Repetition> orders = repetitions(runs.front());
    const double unit = orders.empty() ? 1.0 : orders.front().frequency;
    for (const RecordedRun& run : runs) {
        for (const Curve& curve : chosen(run, words)) {
            if (const std::string why = run.unresolved(); !why.empty()) throw UsageError(run.path() + ": " + why);
            AmplitudeSpectrum spectrum = amplitude_spectrum(run.times(), curve.values);
            if (spectrum.frequency.empty()) throw UsageError(run.path() + ": orders need 8 rows at least");
            Plot& plot = panel_of(panels, curve);
            plot.x.label = orders.empty() ? "frequency [Hz]" : "order of the passing pins";
            for (double& frequency : spectrum.frequency) frequency /= unit;
            const Shown how = shown(curve.name, curve.unit);
            for (double& amplitude : spectrum.amplitude) amplitude *= how.factor;
            if (plot.series.empty())
                plot.y = {"amplitude of " + how.label, Scale::logarithmic};
            else
                plot.y.label = "amplitude, " + label_of_unit(how.unit.empty() ? curve.unit : how.unit);
            end = std::min(end, spectrum.frequency.back());
            plot.series.push_back(line_through(name_in(runs, run, curve.name), spectrum.frequency, spectrum.amplitude));
        }
    }
    if (!orders.empty()) end = std::min(end, 12.5);
    for (Panel& panel : panels) {
        const auto [bottom, top] = amplitude_range(panel.plot, end);
        panel.plot.x.from = 0.0, panel.plot.x.to = end;
        panel.plot.y.from = bottom, panel.plot.y.to = top;
        for (std::size_t k = 0; k < panel.plot.series.size(); ++k) {
            panel.plot.series[k].colour = palette(k);
            panel.plot.series[k].line = palette_line(k);
        }
        if (!orders.empty()) {
            const std::vector<Series> lines = order_lines(orders, end, {bottom, top});
            panel.plot.series.insert(panel.plot.series.begin(), lines.begin(), lines.end());
        }
    }
    return finished(panels, subtitle_of(runs) + (orders.empty() ? "" : "; " + orders_text(orders)));
}

Plot round_plot(const std::vector<RecordedRun>& runs) {
    const Shown length = shown("position", "m");
    const std::string x = fmt::format("x [{}]", length.unit), y = fmt::format("y [{}]", length.unit);
    Plot plot{.title = "Round of the followed pin", .subtitle = subtitle_of(runs), .x = {x}, .y = {y}};
    for (const RecordedRun& run : runs) {
        const auto& channels = run.reader().channels();
        const auto place = std::ranges::find_if(
            channels, [](const auto& channel) { return channel.width == 3 && channel.unit == "m" && channel.axis == "axis"; });
        if (place == channels.end()) throw UsageError(run.path() + ": the record has no channel with a place in space");
        const std::vector<double> all = run.reader().channel(place->name);
        Series series{runs.size() == 1 ? "" : run.path(), {}, Mark::none, Line::solid, "", 1.4};
        for (std::size_t k = 0; k + 2 < all.size(); k += 3) series.points.push_back({length.factor * all[k], length.factor * all[k + 1]});
        plot.series.push_back(std::move(series));
    }
    equalise(plot);
    return plot;
}

Plot loss_plot(const RecordedRun& run) {
    std::vector<Curve> kinds = run.group("loss");
    if (kinds.empty()) throw UsageError(run.path() + ": the record has no losses");
    std::erase_if(kinds, [](const Curve& kind) { return kind.name == "loss/total"; });
    std::sort(kinds.begin(), kinds.end(), [](const Curve& a, const Curve& b) { return mean_of(a.values) > mean_of(b.values); });
    double total = 0.0;
    for (const Curve& kind : kinds) total += mean_of(kind.values);
    std::vector<Bar> bars;
    std::string zeros;
    for (const Curve& kind : kinds) {
        const double mean = mean_of(kind.values);
        std::string name = kind.name.substr(5);
        std::replace(name.begin(), name.end(), '_', ' ');
        if (mean == 0.0) zeros += (zeros.empty() ? "; zero: " : ", ") + name;
        const std::string share = total > 0.0 ? fmt::format(" ({:.1f} %)", 100.0 * mean / total) : "";
        if (mean != 0.0) bars.push_back({name, mean, fmt::format("{:.4g} W{}", mean, share)});
    }
    if (bars.empty()) bars.push_back({"all kinds", 0.0, "0 W"});
    const std::string title = fmt::format("Losses by kind: {:.4g} W on average", total);
    return {
        .title = title, .subtitle = run.conditions() + zeros, .x = {}, .y = {"mean power dissipated [W]"}, .bars = bars, .width = 620.0};
}

std::string csv(const std::vector<Plot>& plots) {
    const bool fields = std::any_of(plots.begin(), plots.end(), [](const Plot& plot) { return !plot.fields.empty(); });
    std::string text = fields ? "plot,series,x,y,value,x axis,y axis\n" : "plot,series,x,y,x axis,y axis\n";
    const auto quoted = [](const std::string& cell) { return tasks::csv_cell(cell, true, true); };
    for (const Plot& plot : plots) {
        const std::string axes = fmt::format(",{},{}\n", quoted(plot.x.label), quoted(plot.y.label));
        for (const Field& field : plot.fields) {
            for (std::size_t k = 0; k < field.values.size(); ++k)
                text += fmt::format("{},{},{:.9g},{:.9g},{:.9g}{}", quoted(plot.title), quoted(field.label), field.x[k % field.x.size()],
                                    field.y[k / field.x.size()], field.values[k], axes);
        }
        for (std::size_t k = 0; k < plot.bars.size(); ++k)
            text += fmt::format("{},{},{},{:.9g}{}{}", quoted(plot.title), quoted(plot.bars[k].name), k, plot.bars[k].value,
                                fields ? "," : "", axes);
        for (const Series& series : plot.series) {
            const std::string name = quoted(series.name.empty() ? plot.title : series.name);
            for (const Point& point : series.points) {
                if (std::isfinite(point.x) && std::isfinite(point.y))
                    text += fmt::format("{},{},{:.9g},{:.9g}{}{}", quoted(plot.title), name, point.x, point.y, fields ? "," : "", axes);
            }
        }
    }
    return text;
}

}  // namespace cvtflow::tools
