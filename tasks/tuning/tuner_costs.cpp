/// What choices cost: the cheapest methods, every level with every method, cheapest first. (tasks/tuning/tuner.hpp)

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tasks/method/automatic_method.hpp"
#include "tasks/method/method_choice.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/tuning/tuner.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double shares[] = {1.0, 0.5, 0.25};  ///< of the automatic step
constexpr std::size_t max_methods = 3;
constexpr double method_reach = 2.0;    ///< methods so many times as dear as the cheapest are left out
constexpr double method_trial = 50e-6;  ///< [s]
constexpr double cost_trial = 1e-3;     ///< [s]
constexpr int rounds = 3;
constexpr double alike = 1.1;  ///< costs within this factor are ranked by work

/// Levels of detail, including the scene's detail if that has no name.
std::vector<std::string> levels_for(const Scene& scene) {
    std::vector<std::string> levels;
    bool named = false;
    for (const DetailPreset& preset : detail_presets()) {
        Scene at = scene;
        apply_detail(at, preset.name);
        const auto dials = dial_keys();
        named = named || std::all_of(dials.begin(), dials.end(), [&](std::string_view key) {
                    const Parameter& dial = *find_parameter(key);
                    return value_text(dial, at) == value_text(dial, scene);
                });
        levels.emplace_back(preset.name);
    }
    if (!named) levels.emplace_back();
    return levels;
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// Costs that differ by less than a tenth fall into one bin, or into neighbouring ones.
long bin_of(double seconds) { return std::lround(std::log(seconds) / std::log(alike)); }

/// "rk4, heun: reason" of methods that the same speaks against, in their order. @param objections method, reason
std::vector<std::string> joined_by_reason(const std::vector<std::pair<std::string, std::string>>& objections) {
    std::vector<std::string> lines;
    for (const auto& [name, reason] : objections) {
        const auto ending = ": " + reason;
        const auto same = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) { return line.ends_with(ending); });
        if (same == lines.end())
            lines.push_back(name + ending);
        else
            same->insert(same->size() - ending.size(), ", " + name);
    }
    return lines;
}

}  // namespace

/// The requested methods, or the cheapest of the catalogue at their automatic steps, by a short run with the scene's detail.
void Tuner::find_methods() {
    methods_ = settings_.methods;
    if (!methods_.empty()) return;
    if (settings_.same_everywhere) {
        methods_ = {RunSettings{}.method};
        left_out_ = {"all methods but the automatic choice: which of them is cheapest depends on the machine"};
        return;
    }
    std::vector<std::pair<double, std::string>> costs;
    std::vector<std::pair<std::string, std::string>> objections;
    const std::vector<std::string> names = method_names();
    for (const std::string& name : names) {
        say_share("methods", static_cast<std::size_t>(&name - names.data()) + 1, names.size());
        try {
            const PointRun run = points_.front().trial({"", name}, method_trial);
            if (run.objection.empty())
                costs.emplace_back(run.seconds, name);
            else
                objections.emplace_back(name, run.objection);
        } catch (const std::exception& error) {  // a method that cannot be used with the scene
            objections.emplace_back(name, error.what());
        }
    }
    left_out_ = joined_by_reason(objections);
    std::stable_sort(costs.begin(), costs.end());
    std::vector<std::string> dear;
    for (const auto& [seconds, name] : costs) {
        const double over = seconds / costs.front().first;
        const bool usual =
            std::ranges::any_of(automatic_choices(), [&name = name](const AutomaticChoice& row) { return row.method == name; });
        const bool taken = usual || (methods_.size() < max_methods && over <= method_reach);
        if (taken)
            methods_.push_back(name);
        else
            dear.push_back(fmt::format("{} ({:.3g})", name, over));
    }
    if (!dear.empty())
        left_out_.push_back(
            fmt::format("methods that are more expensive than {}, by factors of: {}", costs.front().second, fmt::join(dear, ", ")));
}

std::vector<std::pair<TunedChoice, double>> Tuner::find_bases() {
    std::vector<std::pair<TunedChoice, double>> bases;
    std::vector<std::pair<std::string, std::string>> objections;
    std::map<std::pair<std::string, std::uint64_t>, std::string> steps;  // method by level and end of its trial
    for (const std::string& level : levels_for(scene_)) {
        for (const std::string& method : methods_) {
            require_going_on();
            TunedChoice base;
            base.choice = {level, method};
            base.choice.method = method_of(chosen_scene(scene_, base.choice, 0.0));
            const auto same = [&](const auto& other) { return other.first.choice.text() == base.choice.text(); };
            if (std::any_of(bases.begin(), bases.end(), same)) continue;
            try {
                const PointRun run = points_.front().trial(base.choice, cost_trial);
                const auto [first, differs] = steps.try_emplace({level, run.hash}, method);
                if (!differs && run.objection.empty()) throw SimulationError("takes the steps of " + first->second);
                base.work = run.work;
                bases.emplace_back(base, run.seconds);
            } catch (const std::exception& error) {  // a method that the scene's detail takes need not take every level: rigid pins
                objections.emplace_back(fmt::format("{} at {}", method, level.empty() ? "the scene's detail" : level), error.what());
            }
        }
    }
    for (const std::string& line : joined_by_reason(objections)) left_out_.push_back(line);
    if (bases.empty()) throw SimulationError(fmt::format("{}: no choice can be tried:\n  {}", scene_.name, fmt::join(left_out_, "\n  ")));
    return bases;
}

/// Every level with every method, in turns; shares of the step cost in proportion.
void Tuner::find_costs() {
    say("costs of levels of detail");
    const auto bases = find_bases();
    std::vector<std::vector<double>> seconds;
    for (const auto& [base, first] : bases) seconds.push_back({first});
    for (int round = 1; round < rounds; ++round) {
        for (std::size_t i = 0; i < bases.size(); ++i) {
            say_share(fmt::format("costs of levels of detail, round {} of {}", round + 1, rounds), i + 1, bases.size());
            seconds[i].push_back(points_.front().trial(bases[i].first.choice, cost_trial).seconds);
        }
    }
    for (std::size_t i = 0; i < bases.size(); ++i) {
        const auto [least, most] = std::minmax_element(seconds[i].begin(), seconds[i].end());
        TunedChoice base = bases[i].first;
        base.seconds = median_of(seconds[i]);
        base.spread = (*most - *least) / base.seconds;
        for (const double share : shares) {
            TunedChoice& made = ranked_.emplace_back(base);
            made.choice.share = share;
            made.seconds /= share;
            made.work /= share;
        }
    }
    std::stable_sort(ranked_.begin(), ranked_.end(), [this](const TunedChoice& a, const TunedChoice& b) {
        if (settings_.same_everywhere) return a.work < b.work;
        return std::pair(bin_of(a.seconds), a.work) < std::pair(bin_of(b.seconds), b.work);
    });
}

void Tuner::prepare() {
    if (!ranked_.empty()) return;
    find_methods();
    find_costs();
}

}  // namespace cvtflow::tasks
