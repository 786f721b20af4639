#include "tools/program/view/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/base/text.hpp"
#include "tasks/channel/channels.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr int max_single = 4;  ///< largest width of a channel whose numbers are drawn separately

Curve element_of(const engine::ChannelInfo& channel, const std::vector<double>& all, int number) {
    const auto width = static_cast<std::size_t>(channel.width);
    Curve curve{channel.width == 1 ? channel.name : fmt::format("{}[{}]", channel.name, number), channel.unit, channel.description, {}};
    for (std::size_t at = static_cast<std::size_t>(number); at < all.size(); at += width) curve.values.push_back(all[at]);
    return curve;
}

/// Rows are read in blocks: a long run has gigabytes of them.
std::vector<Curve> envelope(const engine::RunReader& reader, const engine::ChannelInfo& channel) {
    constexpr std::size_t max_rows = 8192;
    std::vector<Curve> curves;
    for (const char* name : {"least", "mean", "largest"})
        curves.push_back({fmt::format("{} ({})", channel.name, name), channel.unit, channel.description, {}});
    const auto width = static_cast<std::ptrdiff_t>(channel.width);
    for (std::size_t first = 0; first < reader.rows(); first += max_rows) {
        const std::vector<double> some = reader.channel_rows(channel.name, first, std::min(max_rows, reader.rows() - first));
        for (auto row = some.begin(); row != some.end(); row += width) {
            const FiniteFigures figures({row, row + width});
            curves[0].values.push_back(figures.least);
            curves[1].values.push_back(figures.mean);
            curves[2].values.push_back(figures.largest);
        }
    }
    return curves;
}

/// "links/tension[12]" taken apart; the number is -1 where there is none.
std::pair<std::string, int> taken_apart(const std::string& word) {
    const auto bracket = word.find('[');
    int number = -1;
    if (bracket == std::string::npos || !word.ends_with("]")) return {word, number};
    const char *begin = word.data() + bracket + 1, *end = word.data() + word.size() - 1;
    if (const auto [last, error] = std::from_chars(begin, end, number); error != std::errc() || last != end || number < 0)
        throw UsageError(fmt::format("{}: the element number is not valid", word));
    return {word.substr(0, bracket), number};
}

double mean_from(const std::vector<double>& values, std::size_t first) { return FiniteFigures(std::span(values).subspan(first)).mean; }

ChannelDifference of_channel(const Curve& curve, std::vector<double> a, const std::vector<double>& b, const std::vector<double>& times) {
    ChannelDifference d{curve, {}, {}, 0.0, times.front()};
    const std::size_t fifth = 4 * a.size() / 5;
    d.all = {mean_from(a, 0), mean_from(b, 0)};
    d.last = {mean_from(a, fifth), mean_from(b, fifth)};
    for (std::size_t k = 0; k < a.size(); ++k) {
        a[k] = b[k] - a[k];
        if (std::abs(a[k]) > d.largest) d.largest = std::abs(a[k]), d.largest_time = times[k];
    }
    d.curve.values = std::move(a);
    return d;
}

/// Efficiencies have other means than those of their outputs.
void take_efficiencies(const RecordedRun& a, const RecordedRun& b, const std::vector<double>& times, ChannelDifference& d) {
    const auto mean = [&](MeanDifference& of, std::size_t first) {
        const auto ours = a.efficiency(d.curve.name, times[first], times.back()),
                   theirs = b.efficiency(d.curve.name, times[first], times.back());
        if (ours && theirs) of = {*ours, *theirs};
    };
    mean(d.all, 0);
    mean(d.last, std::min(times.size() - 1, 4 * times.size() / 5));
}

}  // namespace

std::string how_to_record(const std::string& name) {
    const auto all = tasks::channels();
    const bool group = std::ranges::any_of(all, [&](const tasks::Channel& channel) { return channel.name.starts_with(name + "/"); });
    const auto found = std::ranges::find(all, name, &tasks::Channel::name);
    if (found == all.end() && !group) return {};
    if (found != all.end() && !found->is(tasks::Channel::on_demand)) return "the machine has no pulleys";
    return fmt::format("record it with --set record.channels={}{}", name, found == all.end() ? "/*" : "");
}

RecordedRun::RecordedRun(std::string path)
    : path_(std::move(path)), reader_(path_), scene_(scene_in(reader_.attributes(), "parameters")), times_(reader_.times()) {
    if (times_.empty()) throw engine::RecordError(path_ + ": the record contains no rows yet");
    const bool finite = std::all_of(times_.begin(), times_.end(), [](double time) { return std::isfinite(time); });
    if (!finite || !std::is_sorted(times_.begin(), times_.end())) throw engine::RecordError(path_ + ": damaged: times do not increase");
}

std::string RecordedRun::name() const { return text_of(reader_.attributes(), "scene", ""); }

std::string RecordedRun::conditions() const {
    const auto& all = reader_.attributes();
    return fmt::format("{}, {}{}, step {}", text_of(all, "scene"), scene_ ? level_text(*scene_) + ", " : "", text_of(all, "method"),
                       step_text(all));
}

double on_line(const std::vector<double>& times, const std::vector<double>& values, double time) {
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    const auto k = static_cast<std::size_t>(after - times.begin());
    if (k == 0 || times[k] == time) return values[k];
    const double share = (time - times[k - 1]) / (times[k] - times[k - 1]);
    return values[k - 1] + share * (values[k] - values[k - 1]);
}

double last_time(const std::vector<RecordedRun>& runs) {
    double last = -INFINITY;
    for (const RecordedRun& run : runs) last = std::max(last, run.times().back());
    return last;
}

std::vector<tasks::KeyDifference> differing_keys(const tasks::Scene& a, const tasks::Scene& b) {
    const auto counts = [](const tasks::Parameter& key) { return key.section() != "scene"; };
    std::vector<tasks::KeyDifference> keys = tasks::differing_keys(a, b, counts, tasks::readable_value);
    if (tasks::level_of(a).empty() || tasks::level_of(b).empty() || tasks::level_of(a) == tasks::level_of(b)) return keys;
    std::erase_if(keys, [](const tasks::KeyDifference& each) {  // a level sets its dials; pulleys may be absent at any
        return each.key->key != "detail.pulleys" && std::ranges::count(tasks::dial_keys(), each.key->key) > 0;
    });
    return keys;
}

std::string only_difference(const std::vector<RecordedRun>& runs, const RecordedRun& run) {
    const tasks::Parameter* key = nullptr;
    for (const RecordedRun& other : runs) {
        if (!other.scene() || !runs.front().scene()) return {};
        for (const tasks::KeyDifference& each : differing_keys(*other.scene(), *runs.front().scene())) {
            if (key != nullptr && key != each.key) return {};
            key = each.key;
        }
    }
    if (key == nullptr) return {};
    std::string value = tasks::readable_value(*key, *run.scene());
    std::erase(value, '"');
    return fmt::format("{} {}", key->key, value);
}

const engine::ChannelInfo* RecordedRun::channel(const std::string& name) const {
    const auto& channels = reader_.channels();
    const auto found = std::ranges::find(channels, name, &engine::ChannelInfo::name);
    return found == channels.end() ? nullptr : &*found;
}

std::vector<double> RecordedRun::values(const std::string& channel) const {
    return this->channel(channel) == nullptr ? std::vector<double>() : reader_.channel(channel);
}

std::vector<Curve> RecordedRun::curves(const engine::ChannelInfo& channel, bool each) const {
    if (channel.width > max_single && !each) return envelope(reader_, channel);
    const std::vector<double> all = reader_.channel(channel.name);
    std::vector<Curve> made;
    for (int number = 0; number < channel.width; ++number) made.push_back(element_of(channel, all, number));
    return made;
}

std::vector<Curve> RecordedRun::group(const std::string& name, bool each) const {
    std::vector<Curve> made;
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        if (!channel.name.starts_with(name + "/")) continue;
        for (Curve& curve : curves(channel, each)) made.push_back(std::move(curve));
    }
    return made;
}

std::vector<Curve> RecordedRun::find(const std::string& word, bool each) const {
    const auto [name, number] = taken_apart(word);
    std::vector<std::string> names;
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        names.push_back(channel.name);
        if (channel.name != name) continue;
        if (number < 0) return curves(channel, each);
        if (number >= channel.width) throw UsageError(fmt::format("{}: {} has {} elements, numbered from 0", word, name, channel.width));
        return {element_of(channel, reader_.channel(name), number)};
    }
    std::vector<Curve> all = number < 0 ? group(name, each) : std::vector<Curve>{};
    if (const std::string how = all.empty() ? how_to_record(name) : std::string{}; !how.empty())
        throw UsageError(fmt::format("{}: {} was recorded without this channel ({})", word, path_, how));
    if (all.empty())
        throw UsageError(
            fmt::format("{}: neither a file nor a channel of {}{}", word, path_, engine::did_you_mean(engine::closest(name, names))));
    return all;
}

std::vector<Curve> RecordedRun::overview() const {
    std::vector<Curve> made;
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        if (channel.width == 1 && channel.name.find('/') == std::string::npos) made.push_back(curves(channel).front());
    }
    return made;
}

std::string RecordedRun::sparse() const {
    const auto pins = pin_frequency();
    if (!pins || times_.size() < 2) return {};
    const double between = (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
    if (2.0 * *pins * between < 1.0) return {};
    return fmt::format("outputs are {} apart, and pins pass at {:.4g} Hz", time_text(between), *pins);
}

std::string RecordedRun::sampling() const {
    const std::string how = sparse();
    if (how.empty()) return how;
    return scene_ && scene_->run.means ? "outputs are means over their interval" : how + ": curves are samples";
}

std::string RecordedRun::unresolved() const {
    const std::string how = sparse();
    return how.empty() ? how : fmt::format("{}: spectra require run.output_interval below {}", how, time_text(0.5 / *pin_frequency()));
}

std::optional<double> RecordedRun::efficiency(const std::string& name, double begin, double end) const {
    const tasks::EfficiencyChannels* of = tasks::efficiency_channels_of(name);
    if (of == nullptr) return {};
    const double frequency = pin_frequency().value_or(0.0), periods = std::floor((end - begin) * frequency * (1.0 + 1e-9));
    if (periods > 0.0) begin = std::max(begin, end - periods / frequency);
    std::array<double, tasks::EfficiencyChannels::sums> changes{};
    for (std::size_t k = 0; k < changes.size(); ++k) {
        for (const std::string_view energy : of->energies[k]) {
            const std::vector<double> course = values(std::string(energy));
            if (!course.empty()) changes[k] += on_line(times_, course, end) - on_line(times_, course, begin);
        }
    }
    return tasks::efficiency_of(changes);
}

std::optional<double> RecordedRun::pin_frequency() const {
    if (!scene_) return {};
    const double mean = FiniteFigures(values("chain_speed")).mean;
    const model::Chain& chain = scene_->parameters.chain;
    return mean > 0.0 ? std::optional(mean * chain.pins / model::chain_length(chain)) : std::nullopt;
}

engine::RecordedState machine_state(const std::string& path, const engine::RunReader& run, std::size_t number,
                                    const model::ChainLayout& at) {
    engine::RecordedState recorded = run.state(number);
    const bool fits = recorded.state.size() == static_cast<std::size_t>(at.size()) &&
                      recorded.phases.size() == static_cast<std::size_t>(model::tips_per_link * at.links);
    const bool phases =
        std::ranges::all_of(recorded.phases, [](auto phase) { return phase <= static_cast<std::uint8_t>(model::Phase::slip); });
    if (!fits || !phases) throw engine::RecordError(fmt::format("{}: state {} does not match its machine", path, number));
    return recorded;
}

bool finite(const engine::RecordedState& recorded) {
    return std::isfinite(recorded.time) && std::ranges::all_of(recorded.state, [](double value) { return std::isfinite(value); });
}

double MeanDifference::relative() const noexcept { return a != 0.0 ? (b - a) / std::abs(a) : std::numeric_limits<double>::quiet_NaN(); }

RunDifference difference(const RecordedRun& a, const RecordedRun& b) {
    RunDifference result;
    const std::vector<double>&ours = a.times(), &theirs = b.times();
    const auto first = std::lower_bound(ours.begin(), ours.end(), theirs.front());
    const auto last = std::upper_bound(first, ours.end(), theirs.back());
    const auto begin = first - ours.begin(), end = last - ours.begin();
    result.times.assign(first, last);
    const std::vector<Curve> of_a = a.overview(), of_b = b.overview();
    for (const Curve& curve : of_b) {
        if (std::ranges::count(of_a, curve.name, &Curve::name) == 0) result.only_b.push_back(curve.name);
    }
    for (const Curve& curve : of_a) {
        const auto other = std::ranges::find(of_b, curve.name, &Curve::name);
        if (other == of_b.end()) {
            result.only_a.push_back(curve.name);
        } else if (!result.times.empty()) {
            std::vector<double> there;
            for (const double time : result.times) there.push_back(on_line(theirs, other->values, time));
            result.channels.push_back(of_channel({curve.name, curve.unit, curve.description, {}},
                                                 {curve.values.begin() + begin, curve.values.begin() + end}, there, result.times));
            take_efficiencies(a, b, result.times, result.channels.back());
        }
    }
    return result;
}

}  // namespace cvtflow::tools
