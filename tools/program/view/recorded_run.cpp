#include "tools/program/view/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/text.hpp"
#include "tasks/run/channels.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/plot/finite.hpp"
#include "tools/program/text/attribute_text.hpp"
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

}  // namespace

std::string how_to_record(const std::string& name) {
    const auto all = tasks::channels();
    const auto named = [&](const tasks::Channel& channel) { return channel.name == name; };
    const auto of_group = [&](const tasks::Channel& channel) { return channel.name.starts_with(name + "/"); };
    const bool group = std::any_of(all.begin(), all.end(), of_group);
    const auto found = std::find_if(all.begin(), all.end(), named);
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

std::string RecordedRun::name() const {
    const auto scene = reader_.attribute("scene");
    const auto* text = scene ? std::get_if<std::string>(&scene->value) : nullptr;
    return text != nullptr ? *text : "";
}

std::string RecordedRun::conditions() const {
    const auto& all = reader_.attributes();
    return fmt::format("{}, {}, step {}", text_of(all, "scene"), text_of(all, "method"), step_text(all));
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

std::string RecordedRun::unresolved() const {
    const auto pins = pin_frequency();
    if (!pins || times_.size() < 2) return {};
    const double between = (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
    if (2.0 * *pins * between < 1.0) return {};
    return fmt::format("outputs are {} apart, and pins pass at {:.4g} Hz: spectra require run.output_interval below {}", time_text(between),
                       *pins, time_text(0.5 / *pins));
}

std::optional<double> RecordedRun::pin_frequency() const {
    if (!scene_) return {};
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        if (channel.name != "chain_speed") continue;
        const std::vector<double> speed = reader_.channel(channel.name);
        const double mean = FiniteFigures(speed).mean;
        const model::Chain& chain = scene_->parameters.chain;
        if (mean > 0.0) return mean * chain.pins / model::chain_length(chain);
    }
    return {};
}

}  // namespace cvtflow::tools
