#include "tasks/tuning/tuner.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "tasks/batch/start_states.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

std::vector<bool> pareto_front(const std::vector<TradeoffPoint>& points) {
    std::vector<bool> front;
    for (const TradeoffPoint& point : points) {
        bool beaten = !std::isfinite(point.error);
        for (const TradeoffPoint& other : points) {
            const bool no_worse = other.error <= point.error && other.seconds <= point.seconds;
            beaten = beaten || (no_worse && (other.error < point.error || other.seconds < point.seconds));
        }
        front.push_back(!beaten);
    }
    return front;
}

namespace {

using WallClock = std::chrono::steady_clock;

constexpr const char* out_of_time = "budget used up";
constexpr double gained_by_halving = 4.0;  ///< largest ratio of the errors, for methods of second order

double seconds_since(WallClock::time_point then) { return std::chrono::duration<double>(WallClock::now() - then).count(); }

/// "40 s", "2.5 min"
std::string span_text(double seconds) {
    return seconds < 90.0 ? fmt::format("{:.2g} s", seconds) : fmt::format("{:.1f} min", seconds / 60.0);
}

/// An operating point begins anew with its inputs held, which a far end that turns on by itself does not allow.
void require_held_inputs(const Scene& scene) {
    const model::Parameters& p = scene.parameters;
    if (scene.vehicle.present())
        throw SceneError(fmt::format(
            "{}: a [vehicle] cannot be tuned: the load follows from its speed; tune a scene without it at a speed and torque of "
            "its own, and use the result here",
            scene.name));
    if (p.hydraulics.mode != model::HydraulicMode::none)
        throw SceneError(fmt::format(
            "{}: hydraulics.mode \"{}\" cannot be tuned: oil carries on what it held; tune with \"none\", and use the result here",
            scene.name, p.hydraulics.mode == model::HydraulicMode::force ? "force" : "pressure"));
    if (p.drive.mode != model::DriveMode::coupling && p.load.mode == model::LoadMode::torque) return;
    throw SceneError(
        fmt::format("{}: drive.mode \"coupling\" and load.mode \"speed\" and \"coupling\" cannot be tuned; tune with "
                    "load.mode = \"torque\" and the torque that acts, and use the result here",
                    scene.name));
}

}  // namespace

Tuner::Tuner(const Scene& scene, TuneSettings settings, const engine::Cancellation& cancel)
    : scene_(scene), settings_(std::move(settings)), cancel_(cancel), finest_(detail_presets().back().name) {
    require_held_inputs(scene);
    outputs_ = tuned_outputs(settings_.outputs, scene.parameters.detail.pulleys != model::PulleyDetail::absent);
    for (const OperatingPoint& point : points_of(scene, settings_.times)) points_.emplace_back(point, finest_, outputs_, cancel, deadline_);
}

Tuner::Tuner(const Sweep& sweep, TuneSettings settings, const engine::Cancellation& cancel)
    : scene_(sweep.scene), settings_(std::move(settings)), cancel_(cancel), finest_(detail_presets().back().name) {
    require_held_inputs(sweep.scene);
    settings_.same_everywhere = true;
    outputs_ = tuned_outputs(sweep.scalars);
    for (const long number : corner_cases(sweep)) points_.emplace_back(point_of_case(sweep, number), finest_, outputs_, cancel, deadline_);
    if (!points_.empty()) return;
    Scene first = sweep.scene;
    sweep.apply_case(0, first);
    throw SceneError(fmt::format("{}: every case at the corners of its axes is invalid; case 0: {}", sweep.name, violations(first)));
}

void Tuner::say(const std::string& what, double seconds) {
    measuring_ = what;
    if (!settings_.progress) return;
    const std::string takes = seconds > 0.0 ? fmt::format(", about {}", span_text(seconds)) : "";
    const std::string left =
        settings_.budget > 0.0 ? fmt::format("; {} of the budget left", span_text(std::max(0.1, deadline_.left()))) : "";
    settings_.progress(what + takes + left);
}

void Tuner::say_share(const std::string& what, std::size_t number, std::size_t of) {
    throw_if_cancelled();
    if (4 * number / of == 4 * (number - 1) / of && number > 1) return;
    say(fmt::format("{}: {:.0f} %", what, 100.0 * static_cast<double>(number - 1) / static_cast<double>(of)));
    measuring_ = what;
}

double Tuner::expected(const PointMeasure& point, double cost) const noexcept {
    const double settling = point.point().settles ? point.point().scene.parameters.start.settling_time : 0.0;
    return cost * (point.point().until + settling);
}

void Tuner::throw_if_cancelled() const {
    if (cancel_.requested()) throw SimulationError("interrupted");
}

const PointRun* Tuner::reference_at(std::size_t i, TuneResult& result) {
    PointMeasure& point = points_[i];
    if (const auto found = judged_.find(i); found != judged_.end()) return found->second ? point.reference(1e300) : nullptr;
    const auto finest = std::find_if(ranked_.begin(), ranked_.end(),
                                     [&](const TunedChoice& c) { return c.choice.detail == finest_ && c.choice.share == 1.0; });
    const double cost = finest == ranked_.end() ? 0.0 : finest->seconds;
    const auto before = [&](double share) {
        say(fmt::format("reference at {}, 1/{:g} of its automatic step", point.point().name, 1.0 / share), expected(point, cost / share));
    };
    const PointRun* reference = point.reference(reference_share * result.accuracy / tuning_margin, before);
    throw_if_cancelled();
    judged_[i] = reference != nullptr;
    if (reference != nullptr) {
        result.points.push_back(point.point().name);
        result.references.push_back(point.reference_text());
    } else {
        result.left_out.push_back(fmt::format("{}: {}", point.point().name, point.objection()));
    }
    return reference;
}

/// A shorter step or another method helps only where the detail is not what is wrong.
bool Tuner::worth_trying(const TunedChoice& candidate, const TuneResult& result) const {
    const double most = gained_by_halving * result.accuracy / tuning_margin;
    return std::none_of(result.choices.begin(), result.choices.end(), [&](const TunedChoice& before) {
        const bool alike = before.choice.detail == candidate.choice.detail && before.choice.share <= 2.0 * candidate.choice.share;
        return alike && before.tried && std::isfinite(before.error()) && before.error() > most;
    });
}

namespace {

/// A run that cannot begin is one without values.
PointRun run_of(const TuneChoice& choice, PointMeasure& point) {
    try {
        return point.run(choice);
    } catch (const SimulationError& error) {
        PointRun none;
        none.objection = error.what();
        return none;
    }
}

}  // namespace

/// Text of an error that is too large; empty: none is.
std::string Tuner::objection_to(const TunedChoice& candidate, const TuneResult& result) const {
    if (candidate.error() <= result.accuracy / tuning_margin) return "";
    const auto worst = std::max_element(candidate.errors.begin(), candidate.errors.end()) - candidate.errors.begin();
    return fmt::format("{} has an error of {:.2g} % at {}", outputs_[static_cast<std::size_t>(worst)].name, 100.0 * candidate.error(),
                       candidate.worst);
}

/// Measures a candidate at all points, until it fails at one of them.
void Tuner::try_at_points(TunedChoice& candidate, TuneResult& result) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (const auto found = judged_.find(i); found != judged_.end() && !found->second) continue;
        throw_if_cancelled();
        const std::string& place = points_[i].point().name;
        say(fmt::format("{} at {}", candidate.choice.text(), place), expected(points_[i], candidate.seconds));
        const auto key = std::pair(candidate.choice.text(), i);
        if (!runs_.contains(key)) runs_[key] = run_of(candidate.choice, points_[i]);
        const PointRun& run = runs_.at(key);
        throw_if_cancelled();
        const PointRun* reference = reference_at(i, result);
        if (reference == nullptr) continue;
        const std::vector<double> errors = points_[i].errors(run, *reference);
        if (!candidate.tried || largest(errors) > candidate.error()) candidate.worst = place;
        candidate.errors.resize(errors.size(), 0.0);
        for (std::size_t k = 0; k < errors.size(); ++k) candidate.errors[k] = std::max(candidate.errors[k], errors[k]);
        if (!candidate.tried) candidate.step = run.step;
        candidate.tried = true;
        candidate.outcome = run.objection.empty() ? objection_to(candidate, result) : fmt::format("{} at {}", run.objection, place);
        if (!candidate.outcome.empty()) return;
    }
    if (candidate.tried)
        candidate.outcome = "chosen";
    else
        throw SimulationError(fmt::format("{}: no operating point has a reference run for an accuracy of {:g} %:\n  {}", scene_.name,
                                          100.0 * result.accuracy, fmt::join(result.left_out, "\n  ")));
}

void Tuner::try_choices(TuneResult& result) {
    for (const TunedChoice& ranked : ranked_) {
        TunedChoice& candidate = result.choices.emplace_back(ranked);
        if (result.chosen) {
            candidate.outcome = "more expensive than the chosen one";
        } else if (!result.used_up_by.empty() || deadline_.passed()) {
            candidate.outcome = out_of_time;
            if (result.used_up_by.empty()) result.used_up_by = measuring_;
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

TuneResult Tuner::tune(double accuracy) {
    const auto began = WallClock::now();
    deadline_.begin(settings_.budget);
    TuneResult result;
    result.scene = scene_.name;
    result.accuracy = accuracy;
    for (const TunedOutput& output : outputs_) result.outputs.push_back(output.name);
    judged_.clear();
    try {
        prepare();
        try_choices(result);
    } catch (const BudgetUsedUp&) {
        result.used_up_by = measuring_;
    }
    deadline_.clear();  // what is asked of the choice is no part of the search
    result.left_out.insert(result.left_out.end(), left_out_.begin(), left_out_.end());
    std::vector<TradeoffPoint> points;
    for (const TunedChoice& c : result.choices)
        points.push_back({c.choice.text(), c.tried ? c.error() : std::numeric_limits<double>::infinity(), c.seconds});
    const std::vector<bool> front = pareto_front(points);
    for (std::size_t i = 0; i < front.size(); ++i) result.choices[i].front = front[i];
    result.wall = seconds_since(began);
    return result;
}

long TuneResult::tried() const noexcept {
    return std::count_if(choices.begin(), choices.end(), [](const TunedChoice& c) { return c.tried; });
}

std::string TuneResult::why_none() const {
    if (used_up_by.empty()) return fmt::format("no choice has errors times {:g} within the target", tuning_margin);
    const std::string spent = fmt::format("the budget ended during: {}", used_up_by);
    return tried() == 0
               ? "nothing was tried: " + spent
               : fmt::format("none of the {} that were tried has errors times {:g} within the target; {}", tried(), tuning_margin, spent);
}

std::vector<double> Tuner::errors_at(const TuneChoice& choice, OperatingPoint point, double accuracy, std::string& why) {
    PointMeasure measure(std::move(point), finest_, outputs_, cancel_);
    const PointRun* reference = measure.reference(reference_share * accuracy);
    throw_if_cancelled();
    if (reference == nullptr) {
        why = measure.objection();
        return {};
    }
    const PointRun run = measure.run(choice);
    throw_if_cancelled();
    why = run.objection;
    return measure.errors(run, *reference);
}

engine::SavedState Tuner::settled_state(const TuneChoice& choice) {
    engine::SavedState state;
    const PointRun run = points_.front().run(choice, &state);
    throw_if_cancelled();
    if (!run.objection.empty()) throw SimulationError(run.objection);
    const OperatingPoint& point = points_.front().point();
    const model::Parameters parameters = chosen_scene(point.scene, choice, 0.0).parameters;
    turn_shaft(state.state.data(), parameters, 0,
               -parameters.drive.speed.integral(point.from));  // the run begins at t = 0, and so does the governor
    state.time = 0.0;
    const model::ChainLayout at = model::layout_of(parameters);
    state.state.resize(static_cast<std::size_t>(at.ledger_begin()));  // and the ledger
    return state;
}

namespace {

constexpr double shares[] = {1.0, 0.5, 0.25};  ///< shares of the automatic step
constexpr std::size_t max_methods = 3;
constexpr double method_reach = 2.0;    ///< methods that cost this many times as much as the cheapest are left out
constexpr double method_trial = 50e-6;  ///< [s]
constexpr double cost_trial = 1e-3;     ///< [s]
constexpr int rounds = 3;
constexpr double alike = 1.1;  ///< costs within this factor are ranked by work

/// Levels of detail, including the scene's detail if that has no name.
std::vector<std::string> levels_for(const Scene& scene) {
    std::vector<std::string> levels;
    for (const DetailPreset& preset : detail_presets()) levels.emplace_back(preset.name);
    if (level_of(scene).empty()) levels.emplace_back();
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
    std::vector<std::string> methods = methods_;
    if (settings_.methods.empty()) methods.emplace_back(automatic_method);  // which another level may take differently
    for (const std::string& level : levels_for(scene_)) {
        for (const std::string& method : methods) {
            throw_if_cancelled();
            TunedChoice base;
            base.choice = {level, method};
            base.choice.method = method_of(chosen_scene(scene_, base.choice, 0.0));
            const auto same = [&](const auto& other) { return other.first.choice.text() == base.choice.text(); };
            if (std::any_of(bases.begin(), bases.end(), same)) continue;
            try {
                const PointRun run = points_.front().trial(base.choice, cost_trial);
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
