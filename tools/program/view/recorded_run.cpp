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

Curve element_of(const engine::ChannelInfo& channel, const std::vector<double>& all, int number) {
    const auto width = static_cast<std::size_t>(channel.width);
    Curve curve{channel.width == 1 ? channel.name : fmt::format("{}[{}]", channel.name, number), channel.unit, channel.description, {}};
    for (std::size_t at = static_cast<std::size_t>(number); at < all.size(); at += width) curve.values.push_back(all[at]);
    return curve;
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

std::vector<Curve> RecordedRun::curves(const engine::ChannelInfo& channel) const {
    const std::vector<double> all = reader_.channel(channel.name);
    std::vector<Curve> made;
    for (int number = 0; number < channel.width; ++number) made.push_back(element_of(channel, all, number));
    return made;
}

std::vector<Curve> RecordedRun::group(const std::string& name) const {
    std::vector<Curve> made;
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        if (!channel.name.starts_with(name + "/")) continue;
        for (Curve& curve : curves(channel)) made.push_back(std::move(curve));
    }
    return made;
}

std::vector<Curve> RecordedRun::find(const std::string& word) const {
    const auto [name, number] = taken_apart(word);
    std::vector<std::string> names;
    for (const engine::ChannelInfo& channel : reader_.channels()) {
        names.push_back(channel.name);
        if (channel.name != name) continue;
        if (number < 0) return curves(channel);
        if (number >= channel.width) throw UsageError(fmt::format("{}: {} has {} elements, numbered from 0", word, name, channel.width));
        return {element_of(channel, reader_.channel(name), number)};
    }
    std::vector<Curve> all = number < 0 ? group(name) : std::vector<Curve>{};
    if (const std::string how = all.empty() ? how_to_record(name) : std::string{}; !how.empty())
        throw UsageError(fmt::format("{}: {} was recorded without this channel ({})", word, path_, how));
    if (all.empty())
        throw UsageError(
            fmt::format("{}: neither a file nor a channel of {}{}", word, path_, engine::did_you_mean(engine::closest(name, names))));
    return all;
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

}  // namespace cvtflow::tools
