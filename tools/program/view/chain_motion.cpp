#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/parameters/chain_layout.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::tools {

namespace {

using model::ChainLayout;

/// Channels of the record that a picture of the chain needs: those with a number per tip, per link, per shaft.
class MotionReader {
public:
    MotionReader(const RecordedRun& run, const ChainLayout& at) : run_(run), at_(at), times_(run.times()) {
        for (const engine::ChannelInfo& channel : run.reader().channels()) {
            if (channel.unit == "N" && channel.width == model::tips_per_link * at.links && tip_.empty()) tip_ = channel.name;
            if (channel.unit == "N" && channel.width == at.links && channel.axis == "link" && link_.empty()) link_ = channel.name;
        }
    }

    void add(ChainMotion& motion, const engine::RecordedState& now) const {
        const auto row = static_cast<std::size_t>(std::lower_bound(times_.begin(), times_.end(), now.time - 1e-12) - times_.begin());
        const std::size_t at_row = std::min(row, times_.size() - 1);
        motion.times.push_back(now.time);
        const std::vector<double> tips = read(tip_, at_row), links = read(link_, at_row);
        for (int pin = 0; pin < at_.links; ++pin) {
            if (!tips.empty()) motion.pin_force.push_back(static_cast<float>(of_pin(tips, pin)));
            if (!links.empty()) motion.tension.push_back(static_cast<float>(links[static_cast<std::size_t>(pin)]));
        }
        std::array<double, 2> speed{}, sum{}, count{};
        for (const std::size_t shaft : {0U, 1U}) {
            speed[shaft] = number(fmt::format("shaft_{}/speed", shaft + 1), at_row);
            motion.angle[shaft].push_back(static_cast<float>(number(fmt::format("shaft_{}/angle", shaft + 1), at_row)));
        }
        for (int pin = 0; pin < at_.links; ++pin) place(motion, now, pin, speed, sum, count);
        for (const std::size_t shaft : {0U, 1U})
            motion.radius[shaft].push_back(static_cast<float>(count[shaft] > 0.0 ? sum[shaft] / count[shaft] : 0.0));
    }

private:
    [[nodiscard]] std::vector<double> read(const std::string& channel, std::size_t row) const {
        return channel.empty() ? std::vector<double>{} : run_.reader().channel_rows(channel, row, 1);
    }
    [[nodiscard]] double number(const std::string& channel, std::size_t row) const {
        return run_.channel(channel) == nullptr ? 0.0 : read(channel, row).front();
    }
    /// Its rear half is on its own link, its front half on the link before.
    template <class Value>
    [[nodiscard]] std::array<Value, 4> tips_of(const std::vector<Value>& tips, int pin) const {
        const auto own = static_cast<std::size_t>(model::tips_per_link * pin);
        const auto before = static_cast<std::size_t>(model::tips_per_link * at_.previous(pin));
        return {tips[own], tips[own + 1], tips[before + 2], tips[before + 3]};
    }
    [[nodiscard]] double of_pin(const std::vector<double>& tips, int pin) const {
        const auto mine = tips_of(tips, pin);
        return 0.5 * (std::abs(mine[0] + mine[2]) + std::abs(mine[1] + mine[3]));  // signs tell the sides
    }
    void place(ChainMotion& motion, const engine::RecordedState& now, int pin, const std::array<double, 2>& speed,
               std::array<double, 2>& sum, std::array<double, 2>& count) const {
        const double* q = now.state.data() + at_.link_begin(pin);
        const double* v = q + at_.link_size();
        const int ix = at_.x(model::End::rear, 0), iy = at_.y(model::End::rear, 0);
        motion.x.push_back(static_cast<float>(q[ix]));
        motion.y.push_back(static_cast<float>(q[iy]));
        motion.z.push_back(static_cast<float>(q[at_.z(model::End::rear)]));
        const auto phases = tips_of(now.phases, pin);
        const bool touches = std::any_of(phases.begin(), phases.end(), [](std::uint8_t phase) { return phase != 0; });
        const double distance = run_.scene()->parameters.pulley.centre_distance;
        const std::size_t shaft = q[ix] > 0.5 * distance ? 1 : 0;
        double slip = 0.0;
        if (touches) {
            const double dx = q[ix] - (shaft == 1 ? distance : 0.0), dy = q[iy];
            const double squared = dx * dx + dy * dy;
            if (speed[shaft] != 0.0) slip = 1.0 - (dx * v[iy] - dy * v[ix]) / squared / speed[shaft];
            sum[shaft] += std::sqrt(squared), count[shaft] += 1.0;
        }
        motion.slip.push_back(static_cast<float>(slip));
        motion.side.push_back(touches ? static_cast<float>(shaft + 1) : 0.0F);
    }

    const RecordedRun& run_;
    const ChainLayout at_;
    const std::vector<double>& times_;
    std::string tip_, link_;
};

}  // namespace

ChainMotion chain_motion(const RecordedRun& run, std::size_t max_states) {
    const std::size_t recorded = run.reader().state_times().size();
    if (!run.scene() || recorded == 0) return {};
    const ChainLayout at = model::layout_of(run.scene()->parameters);
    ChainMotion motion;
    motion.recorded = recorded;
    const MotionReader reader(run, at);
    const std::size_t shown = std::min(recorded, max_states);
    for (std::size_t k = 0; k < shown; ++k) {
        const engine::RecordedState state = machine_state(run.path(), run.reader(), k * recorded / shown, at);
        if (finite(state)) reader.add(motion, state);  // a run that diverged has no chain to show
    }
    return motion;
}

Plot pin_force_plot(const RecordedRun& run, const ChainMotion& motion) {
    constexpr int bins = 120;
    const double distance = run.scene()->parameters.pulley.centre_distance;
    const Shown how = shown("pin force", "N");
    Plot plot{
        .title = "Axial force of the pins round the pulleys",
        .subtitle = run.conditions() + ", mean over all states; thin: minimum and maximum",
        .x = {.label = "angle about the shaft in its sense of turning, 0: away from the other shaft [°]", .from = -130.0, .to = 130.0},
        .y = {fmt::format("force of both halves on each sheave [{}]", how.unit)}};
    for (const int shaft : {1, 2}) {
        std::vector<std::vector<double>> round(bins);  // forces per 3° of angle
        for (std::size_t k = 0; k < motion.pin_force.size(); ++k) {
            if (motion.side[k] != static_cast<float>(shaft) || !std::isfinite(motion.pin_force[k])) continue;
            const double away = shaft == 2 ? motion.x[k] - distance : -static_cast<double>(motion.x[k]);
            const double angle = std::atan2(shaft == 2 ? motion.y[k] : -static_cast<double>(motion.y[k]), away);
            const double bin = std::clamp((angle / std::numbers::pi + 1.0) * 0.5 * bins, 0.0, bins - 1.0);
            round[static_cast<std::size_t>(bin)].push_back(motion.pin_force[k]);
        }
        const std::string colour = palette(static_cast<std::size_t>(shaft - 1));
        Series mean{shaft == 1 ? "driving sheaves" : "driven sheaves", {}, Mark::none, Line::solid, colour, 2.4}, low = mean, high = mean;
        low.name.clear(), high.name.clear(), low.width = high.width = 0.8;
        for (int k = 0; k < bins; ++k) {
            const FiniteFigures forces(round[static_cast<std::size_t>(k)]);
            const double angle = -180.0 + 360.0 * (k + 0.5) / bins;
            mean.points.push_back({angle, how.factor * forces.mean});
            low.points.push_back({angle, how.factor * forces.least}), high.points.push_back({angle, how.factor * forces.largest});
        }
        for (Series* series : {&mean, &low, &high}) plot.series.push_back(std::move(*series));
    }
    return plot;
}

}  // namespace cvtflow::tools
