#include "tasks/tuning/tuner.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tasks/method/method.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

using WallClock = std::chrono::steady_clock;

constexpr const char* out_of_time = "budget used up";
constexpr double gained_by_halving = 4.0;      ///< largest ratio of the errors, for methods of second order
constexpr double shares[] = {1.0, 0.5, 0.25};  ///< shares of the automatic step
constexpr std::size_t rounds = 3;
constexpr double alike = 1.1;  ///< costs within this factor are ranked by work

/// "40 s", "2.5 min"
std::string span_text(double seconds) {
    return seconds < 90.0 ? fmt::format("{:.2g} s", seconds) : fmt::format("{:.1f} min", seconds / 60.0);
}

OperatingPoints corners_of(const Sweep& sweep) {
    const std::vector<long> corners = corner_cases(sweep);
    if (!corners.empty()) return points_of(sweep, corners);
    Scene first = sweep.scene;
    sweep.apply_case(0, first);
    throw SceneError(fmt::format("{}: every case at the corners of its axes is invalid; case 0: {}", sweep.name, violations(first)));
}

TuneSettings same_everywhere(TuneSettings settings) {
    settings.same_everywhere = true;
    return settings;
}

}  // namespace

Tuner::Tuner(OperatingPoints points, TuneSettings settings, const engine::Cancellation& cancel)
    : settings_(std::move(settings)), cancel_(cancel), dial_(std::move(points), cancel) {}

Tuner::Tuner(const Scene& scene, TuneSettings settings, const engine::Cancellation& cancel)
    : Tuner(
          points_of(scene, settings.times, tuned_outputs(settings.outputs, scene.parameters.detail.pulleys != model::PulleyDetail::absent)),
          settings, cancel) {}

Tuner::Tuner(const Sweep& sweep, TuneSettings settings, const engine::Cancellation& cancel)
    : Tuner(corners_of(sweep), same_everywhere(std::move(settings)), cancel) {}

void Tuner::say(const std::string& what, double seconds) {
    if (cancel_.requested()) throw SimulationError("interrupted");
    measuring_ = what;
    if (!settings_.progress) return;
    const std::string takes = seconds > 0.0 ? fmt::format(", about {}", span_text(seconds)) : "";
    const std::string left = settings_.budget > 0.0 ? fmt::format("; {} of the budget left", span_text(std::max(0.1, dial_.left()))) : "";
    settings_.progress(what + takes + left);
}

double Tuner::expected(double cost) const noexcept {
    const Sweep& sweep = points().sweep;
    const double settling = sweep.scene.state_file.empty() ? sweep.scene.parameters.start.settling_time : 0.0;
    return cost * (latest_end(sweep.scene) + settling);
}

const PointRun* Tuner::reference_at(std::size_t i, TuneResult& result) {
    if (const auto found = judged_.find(i); found != judged_.end()) return found->second ? dial_.reference(i).run : nullptr;
    const std::string& place = points().names[i];
    const auto finest = std::ranges::find_if(
        ranked_, [](const TunedChoice& c) { return c.choice.detail == detail_presets().back().name && c.choice.share == 1.0; });
    const double cost = finest == ranked_.end() ? 0.0 : finest->seconds;
    const auto before = [&](double share) {
        say(fmt::format("reference at {}, 1/{:g} of its automatic step", place, 1.0 / share), expected(cost / share));
    };
    const DialSweep::Reference& reference = dial_.reference(i, reference_share * result.accuracy / tuning_margin, before);
    judged_[i] = reference.run != nullptr;
    if (judged_[i]) {
        result.points.push_back(place);
        result.references.push_back(reference.text);
    } else {
        result.left_out.push_back(fmt::format("{}: {}", place, reference.text));
    }
    return reference.run;
}

/// A shorter step or another method helps only where the detail is not what is wrong.
bool Tuner::worth_trying(const TunedChoice& candidate, const TuneResult& result) const {
    const double most = gained_by_halving * result.accuracy / result.margin;
    return settings_.all || std::none_of(result.choices.begin(), result.choices.end(), [&](const TunedChoice& before) {
               const bool similar = before.choice.detail == candidate.choice.detail && before.choice.share <= 2.0 * candidate.choice.share;
               return similar && before.choice.step == 0.0 && candidate.choice.step == 0.0 && before.tried &&
                      std::isfinite(before.error()) && before.error() > most;
           });
}

/// A run that cannot begin is one without values.
const PointRun& Tuner::run_at(const TunedChoice& candidate, std::size_t point) {
    const auto key = std::pair(candidate.choice.text(), point);
    if (const auto known = runs_.find(key); known != runs_.end()) return known->second;
    try {
        return runs_[key] = dial_.run(candidate.choice, candidate.step, point);
    } catch (const SimulationError& error) {
        if (cancel_.requested()) throw;
        return runs_[key] = {{}, error.what()};
    }
}

/// Measures a candidate at all points, until it fails at one of them, unless all is asked for.
void Tuner::try_at_points(TunedChoice& candidate, TuneResult& result) {
    candidate.step = dial_.step_of(candidate.choice);
    for (std::size_t i = 0; i < dial_.size(); ++i) {
        if (const auto found = judged_.find(i); found != judged_.end() && !found->second) continue;
        const std::string& place = points().names[i];
        say(fmt::format("{} at {}", candidate.choice.text(), place), expected(candidate.seconds));
        const PointRun& run = run_at(candidate, i);
        const PointRun* reference = reference_at(i, result);
        if (reference == nullptr) continue;
        const std::vector<double> errors = dial_.errors(run, *reference);
        const auto worst = std::max_element(errors.begin(), errors.end()) - errors.begin();
        if (!candidate.tried || largest(errors) > candidate.error()) candidate.worst = place;
        candidate.errors.resize(errors.size(), 0.0);
        for (std::size_t k = 0; k < errors.size(); ++k) candidate.errors[k] = std::max(candidate.errors[k], errors[k]);
        candidate.tried = true;
        if (largest(errors) > result.accuracy / result.margin && candidate.outcome.empty())
            candidate.outcome = run.objection.empty() ? fmt::format("{} has an error of {:.2g} % at {}", result.outputs[std::size_t(worst)],
                                                                    100.0 * largest(errors), place)
                                                      : fmt::format("{} at {}", run.objection, place);
        if (!candidate.outcome.empty() && !settings_.all) return;
    }
    if (!candidate.tried)
        throw SimulationError(fmt::format("{}: no operating point has a reference run for an accuracy of {:g} %:\n  {}", result.scene,
                                          100.0 * result.accuracy, fmt::join(result.left_out, "\n  ")));
    if (candidate.outcome.empty()) candidate.outcome = result.chosen ? "within the target" : "chosen";
}

void Tuner::try_choices(TuneResult& result) {
    for (const TunedChoice& ranked : ranked_) {
        TunedChoice& candidate = result.choices.emplace_back(ranked);
        if (result.chosen && !settings_.all) {
            candidate.outcome = "more expensive than the chosen one";
        } else if (!result.used_up_by.empty()) {
            candidate.outcome = out_of_time;
        } else if (!worth_trying(candidate, result)) {
            candidate.outcome = "insufficient detail";
        } else {
            try {
                try_at_points(candidate, result);
            } catch (const BudgetUsedUp&) {
                candidate.outcome = out_of_time;
                result.used_up_by = measuring_;
            }
        }
        if (candidate.outcome == "chosen") result.chosen = result.choices.size() - 1;
    }
}

/// The cheapest measured choice that is within a tenth of the target with the margin: of those tried, or of the references the one with
/// twice the step.
std::string Tuner::next_digit(const TuneResult& result) const {
    const double target = 0.1 * result.accuracy;
    const TunedChoice *best = nullptr, &chosen = result.choices[*result.chosen];
    const TunedChoice* finest = nullptr;
    for (const TunedChoice& c : result.choices) {
        const bool better = c.tried && c.error() * result.margin <= target && (best == nullptr || c.seconds < best->seconds);
        if (better) best = &c;
        if (c.choice.detail == detail_presets().back().name && c.choice.share == 1.0 && finest == nullptr) finest = &c;
    }
    if (best == &chosen) return fmt::format("nothing: the choice is within {:g} %, too", 100.0 * target);
    double share = 1.0, off = 0.0;
    for (const auto& [point, has_reference] : judged_) {
        if (!has_reference) continue;
        share = std::min(share, 2.0 * dial_.reference(point).share);
        off = std::max(off, dial_.reference(point).agreement);
    }
    const auto times = [&](double seconds, const std::string& what) {
        return fmt::format("{:.2g} times the time: {} is within {:g} %", seconds / chosen.seconds, what, 100.0 * target);
    };
    if (best != nullptr) return times(best->seconds, best->choice.text());
    if (finest == nullptr || off * result.margin > target) return "not known: no measured choice is that exact";
    return "at most " + times(finest->seconds / share, TuneChoice{finest->choice.detail, finest->choice.method, share}.text());
}

TuneResult Tuner::tune(double accuracy) {
    const auto began = WallClock::now();
    dial_.begin_budget(settings_.budget);
    TuneResult result;
    result.scene = points().sweep.name;
    result.accuracy = accuracy;
    if (dial_.size() == 1) result.margin = lone_point_margin;
    for (const TunedOutput& output : points().outputs) result.outputs.push_back(output.name);
    judged_.clear();
    try {
        if (ranked_.empty()) find_costs();
        try_choices(result);
    } catch (const BudgetUsedUp&) {
        result.used_up_by = measuring_;
    }
    dial_.begin_budget(0.0);  // what is asked of the choice is no part of the search
    result.left_out.insert(result.left_out.end(), left_out_.begin(), left_out_.end());
    const auto beats = [](const TunedChoice& one, const TunedChoice& other) {
        const bool no_worse = one.tried && one.error() <= other.error() && one.seconds <= other.seconds;
        return no_worse && (one.error() < other.error() || one.seconds < other.seconds);
    };
    for (TunedChoice& choice : result.choices)
        choice.front = choice.tried && std::isfinite(choice.error()) &&
                       std::ranges::none_of(result.choices, [&](const TunedChoice& other) { return beats(other, choice); });
    if (result.chosen) result.next_digit = next_digit(result);
    result.wall = std::chrono::duration<double>(WallClock::now() - began).count();
    return result;
}

long TuneResult::tried() const noexcept { return std::ranges::count_if(choices, &TunedChoice::tried); }

std::string TuneResult::why_none() const {
    if (used_up_by.empty()) return fmt::format("no choice has errors times {:g} within the target", margin);
    const std::string spent = fmt::format("the budget ended during: {}", used_up_by);
    return tried() == 0 ? "nothing was tried: " + spent
                        : fmt::format("none of the {} that were tried has errors times {:g} within the target; {}", tried(), margin, spent);
}

std::vector<UnseenPoint> Tuner::verify(const TunedChoice& choice, OperatingPoints points, double accuracy) const {
    DialSweep dial(std::move(points), cancel_);
    std::vector<UnseenPoint> unseen;
    for (std::size_t i = 0; i < dial.size(); ++i) {
        UnseenPoint& made = unseen.emplace_back();
        made.name = dial.points().names[i];
        if (settings_.progress) settings_.progress("verifying at " + made.name);
        const DialSweep::Reference& reference = dial.reference(i, reference_share * accuracy);
        made.remark = reference.text;
        if (reference.run == nullptr) continue;
        const PointRun run = dial.run(choice.choice, choice.step, i);
        made.remark = run.objection;
        made.errors = dial.errors(run, *reference.run);
    }
    return unseen;
}

namespace {

/// Costs that differ by less than a tenth fall into one bin, or into neighbouring ones.
long bin_of(double seconds) { return std::lround(std::log(seconds) / std::log(alike)); }

/// Reasons against methods: those with the same reason in one line.
class Objections {
public:
    void add(const std::string& name, const std::string& reason) {
        const auto same = std::ranges::find(found_, reason, &std::pair<std::string, std::string>::second);
        if (same == found_.end())
            found_.emplace_back(name, reason);
        else
            same->first += ", " + name;
    }
    void write(std::vector<std::string>& lines) const {
        for (const auto& [names, reason] : found_) lines.push_back(names + ": " + reason);
    }

private:
    std::vector<std::pair<std::string, std::string>> found_;
};

/// METHOD or METHOD@STEP.
TuneChoice choice_of(const std::string& detail, const std::string& method) {
    const std::size_t at = method.find('@');
    const double step = at == std::string::npos ? 0.0 : std::get<Quantity>(parse_quantity(method.substr(at + 1))).value;
    return {detail, method.substr(0, at), 1.0, step};
}

}  // namespace

std::vector<TunedChoice> Tuner::find_bases() {
    const Scene& scene = points().sweep.scene;
    std::vector<std::string> levels = settings_.levels;
    for (const DetailPreset& preset : detail_presets())
        if (settings_.levels.empty()) levels.emplace_back(preset.name);
    if (settings_.levels.empty() && level_of(scene).empty()) levels.emplace_back();  // the scene's detail has no name
    std::vector<std::string> methods = settings_.methods;
    if (methods.empty()) methods = {RunSettings{}.method};
    const bool all = settings_.methods.empty() && !settings_.same_everywhere;
    for (const AutomaticChoice& row : automatic_choices())
        if (all && find_program(row.method) != nullptr) methods.emplace_back(row.method);  // tables cost ten times as much
    std::vector<TunedChoice> bases;
    Objections objections;
    for (const std::string& level : levels) {
        for (const std::string& method : methods) {
            TunedChoice base;
            base.choice = choice_of(level, method);
            try {
                base.choice.method = method_of(chosen_scene(scene, base.choice, 0.0));
                if (std::ranges::find(bases, base.choice, &TunedChoice::choice) != bases.end()) continue;
                for (std::size_t point = 0; point < dial_.size(); ++point)
                    base.work = std::max(base.work, dial_.cost(base.choice, point).work);
                bases.push_back(base);
            } catch (const std::exception& error) {  // a method that the scene's detail takes need not take every level: rigid pins
                if (cancel_.requested()) throw;
                objections.add(fmt::format("{} at {}", method, level.empty() ? "the scene's detail" : level), error.what());
            }
        }
    }
    objections.write(left_out_);
    if (bases.empty())
        throw SimulationError(fmt::format("{}: no choice can be tried:\n  {}", points().sweep.name, fmt::join(left_out_, "\n  ")));
    return bases;
}

/// Every level with every method, in turns; shares of the step cost in proportion.
void Tuner::find_costs() {
    say("costs of levels of detail");
    std::vector<TunedChoice> bases = find_bases();
    std::vector<std::vector<double>> seconds(bases.size());
    for (std::size_t round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < bases.size(); ++i) {
            if (cancel_.requested()) throw SimulationError("interrupted");
            seconds[i].push_back(dial_.cost(bases[i].choice, 0).seconds);
        }
    }
    for (std::size_t i = 0; i < bases.size(); ++i) {
        std::ranges::sort(seconds[i]);
        bases[i].seconds = seconds[i][rounds / 2];
        bases[i].spread = (seconds[i].back() - seconds[i].front()) / bases[i].seconds;
        for (const double share : shares) {
            if (share != 1.0 && bases[i].choice.step > 0.0) continue;
            TunedChoice& made = ranked_.emplace_back(bases[i]);
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

}  // namespace cvtflow::tasks
