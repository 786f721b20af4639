#include "tasks/tuning/tuner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tasks/tuning/detail_state.hpp"
#include "tasks/tuning/pareto.hpp"

namespace cvtflow::tasks {

namespace {

using WallClock = std::chrono::steady_clock;

constexpr double gained_by_halving = 4.0;  ///< at most, by a method of second order

double seconds_since(WallClock::time_point then) { return std::chrono::duration<double>(WallClock::now() - then).count(); }

/// An operating point begins anew with its inputs held, which a far end that turns on by itself does not allow.
void require_held_inputs(const Scene& scene) {
    const model::Parameters& p = scene.parameters;
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
    for (const OperatingPoint& point : points_of(scene, settings_.times)) points_.emplace_back(point, finest_, outputs_, cancel);
}

Tuner::Tuner(const Sweep& sweep, TuneSettings settings, const engine::Cancellation& cancel)
    : scene_(sweep.scene), settings_(std::move(settings)), cancel_(cancel), finest_(detail_presets().back().name) {
    require_held_inputs(sweep.scene);
    settings_.same_everywhere = true;
    outputs_ = tuned_outputs(sweep.scalars);
    for (const long number : corner_cases(sweep)) points_.emplace_back(point_of_case(sweep, number), finest_, outputs_, cancel);
    if (!points_.empty()) return;
    Scene first = sweep.scene;
    sweep.apply_case(0, first);
    throw SceneError(fmt::format("{}: every case at the corners of its axes is invalid; case 0: {}", sweep.name, violations(first)));
}

void Tuner::say(const std::string& what) const {
    if (settings_.progress) settings_.progress(what);
}

void Tuner::require_going_on() const {
    if (cancel_.requested()) throw SimulationError("interrupted");
}

void Tuner::find_references(double accuracy, TuneResult& result) {
    judged_.clear();
    for (std::size_t i = 0; i < points_.size(); ++i) {
        PointMeasure& point = points_[i];
        say("reference at " + point.point().name);
        require_going_on();
        if (point.reference(reference_share * accuracy / tuning_margin) == nullptr) {
            require_going_on();
            result.left_out.push_back(fmt::format("{}: {}", point.point().name, point.objection()));
            continue;
        }
        judged_.push_back(i);
        result.points.push_back(point.point().name);
        result.references.push_back(point.reference_text());
    }
    if (!judged_.empty()) return;
    throw SimulationError(fmt::format("{}: no operating point has a reference run for an accuracy of {:g} %:\n  {}", scene_.name,
                                      100.0 * accuracy, fmt::join(result.left_out, "\n  ")));
}

/// A shorter step or another method helps only where the detail is not what is wrong.
bool Tuner::worth_trying(const TunedChoice& candidate, const TuneResult& result) const {
    const double most = gained_by_halving * result.accuracy / tuning_margin;
    return std::none_of(result.choices.begin(), result.choices.end(), [&](const TunedChoice& before) {
        const bool alike = before.choice.detail == candidate.choice.detail && before.choice.share <= 2.0 * candidate.choice.share;
        return alike && before.tried && std::isfinite(before.error()) && before.error() > most;
    });
}

/// Until it fails at one of them.
void Tuner::try_at_points(TunedChoice& candidate, double allowed) {
    for (const std::size_t i : judged_) {
        require_going_on();
        say(fmt::format("{} at {}", candidate.choice.text(), points_[i].point().name));
        const auto key = std::pair(candidate.choice.text(), i);
        if (!runs_.contains(key)) runs_[key] = points_[i].run(candidate.choice);
        const PointRun& run = runs_.at(key);
        require_going_on();
        const std::vector<double> errors = points_[i].errors(run, *points_[i].reference(1e300));
        if (!candidate.tried || largest(errors) > candidate.error()) candidate.worst = points_[i].point().name;
        candidate.errors.resize(errors.size(), 0.0);
        for (std::size_t k = 0; k < errors.size(); ++k) candidate.errors[k] = std::max(candidate.errors[k], errors[k]);
        if (!candidate.tried) candidate.step = run.step;
        candidate.tried = true;
        if (!run.objection.empty()) {
            candidate.standing = fmt::format("{} at {}", run.objection, points_[i].point().name);
            return;
        }
        if (!(candidate.error() <= allowed)) {
            const auto worst = std::max_element(candidate.errors.begin(), candidate.errors.end()) - candidate.errors.begin();
            candidate.standing = fmt::format("{} has an error of {:.2g} % at {}", outputs_[static_cast<std::size_t>(worst)].name,
                                             100.0 * candidate.error(), candidate.worst);
            return;
        }
    }
    candidate.standing = "chosen";
}

TuneResult Tuner::tune(double accuracy) {
    const auto began = WallClock::now();
    TuneResult result;
    result.scene = scene_.name;
    result.accuracy = accuracy;
    for (const TunedOutput& output : outputs_) result.outputs.push_back(output.name);
    prepare();
    find_references(accuracy, result);
    result.left_out.insert(result.left_out.end(), left_out_.begin(), left_out_.end());
    for (const TunedChoice& ranked : ranked_) {
        TunedChoice& candidate = result.choices.emplace_back(ranked);
        if (result.chosen)
            candidate.standing = "more expensive than the chosen one";
        else if (settings_.budget > 0.0 && seconds_since(began) > settings_.budget)
            candidate.standing = "budget used up";
        else if (!worth_trying(candidate, result))
            candidate.standing = "insufficient detail";
        else
            try_at_points(candidate, accuracy / tuning_margin);
        if (candidate.standing == "chosen") result.chosen = result.choices.size() - 1;
    }
    std::vector<TradeoffPoint> points;
    for (const TunedChoice& c : result.choices)
        points.push_back({c.choice.text(), c.tried ? c.error() : std::numeric_limits<double>::infinity(), c.seconds});
    const std::vector<bool> front = pareto_front(points);
    for (std::size_t i = 0; i < front.size(); ++i) result.choices[i].front = front[i];
    result.wall = seconds_since(began);
    return result;
}

std::vector<double> Tuner::errors_at(const TuneChoice& choice, OperatingPoint point, double accuracy, std::string& why) {
    PointMeasure measure(std::move(point), finest_, outputs_, cancel_);
    const PointRun* should = measure.reference(reference_share * accuracy);
    require_going_on();
    if (should == nullptr) {
        why = measure.objection();
        return {};
    }
    const PointRun run = measure.run(choice);
    require_going_on();
    why = run.objection;
    return measure.errors(run, *should);
}

engine::SavedState Tuner::settled_state(const TuneChoice& choice) {
    engine::SavedState state;
    const PointRun run = points_.front().run(choice, state);
    require_going_on();
    if (!run.objection.empty()) throw SimulationError(run.objection);
    const OperatingPoint& point = points_.front().point();
    const model::Parameters parameters = chosen_scene(point.scene, choice, 0.0).parameters;
    turn_shaft(state, parameters, 0, -parameters.drive.speed.integral(point.from));  // the run begins at t = 0, and so does the governor
    state.time = 0.0;
    const model::ChainLayout at = model::layout_of(parameters);
    state.state.resize(static_cast<std::size_t>(at.ledger_begin()));  // and the ledger
    return state;
}

}  // namespace cvtflow::tasks
