#include "bench/lab/command/accuracy/pareto_front.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/lab/text/method_choice_text.hpp"
#include "bench/lab/text/watch_text.hpp"
#include "bench/study/tradeoff/recommendation.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

void declare_front(CLI::App& app, CLI::Option* front, FrontArguments& arguments) {
    app.add_option("--confirm", arguments.confirm, "With --front: length of the run that confirms a recommendation")
        ->type_name("TIME")
        ->capture_default_str()
        ->needs(front);
    app.add_option("--confirm-against", arguments.reference,
                   "Reference of that run (default: leapfrog-chebyshev at a quarter of its automatic step, refined)")
        ->type_name("CHOICE")
        ->needs(front);
}

ConfirmSettings confirm_settings(const FrontArguments& arguments, double interval) {
    ConfirmSettings settings;
    settings.duration = read_time("--confirm", arguments.confirm);
    settings.interval = interval;
    if (!arguments.reference.empty()) settings.reference = read_choice(arguments.reference);
    return settings;
}

void require_reliable(const std::string& scene, const std::string& choice, const Trajectory& reference) {
    if (!reference.watch.reliable())
        throw tasks::SimulationError(fmt::format("{}: the reference {} is {}", scene, choice, unreliable_remark({}, reference.watch)));
}

namespace {

const ConfirmSettings& announced(const ConfirmSettings& settings, const std::function<void(const std::string&)>& progress) {
    progress(fmt::format("the reference of the confirmation, over {}", time_text(settings.duration)));
    return settings;
}

/// The next choice to confirm: the cheapest that is on the front or would be recommended. nullptr: none
ComparedChoice* next_candidate(std::vector<ComparedChoice>& choices) {
    std::vector<tasks::TradeoffPoint> points;
    for (const ComparedChoice& choice : choices) points.push_back(choice.point());
    std::vector<bool> requested = tasks::pareto_front(points);
    for (std::size_t k = 0; k < choices.size(); ++k) choices[k].front_result.front = requested[k];
    for (const double error : recommended_errors) {
        if (const auto best = recommended(points, error, tradeoff_safety)) requested[*best] = true;
    }
    ComparedChoice* cheapest = nullptr;
    for (std::size_t k = 0; k < choices.size(); ++k) {
        if (!requested[k] || choices[k].front_result.confirmed) continue;
        if (cheapest == nullptr || choices[k].median() < cheapest->median()) cheapest = &choices[k];
    }
    return cheapest;
}

}  // namespace

ParetoFront::ParetoFront(const tasks::Scene& scene, const ConfirmSettings& settings, const engine::Cancellation& cancel,
                         std::function<void(const std::string&)> progress)
    : cancel_(cancel),
      progress_(std::move(progress)),
      duration_(settings.duration),
      confirmation_(scene, announced(settings, progress_), cancel) {}

/// Rejects choices whose step is unstable, and those whose short run is unreliable.
void ParetoFront::judge_steps(std::vector<ComparedChoice>& choices) {
    progress_("largest stable steps");
    for (ComparedChoice& choice : choices) {
        choice.front_result.stable_step = confirmation_.stable_step(choice.settings);
        if (confirmation_.beyond_stability(choice.settings))
            choice.front_result.objection = "beyond stability";
        else if (!choice.run.fault && !choice.run.watch.reliable())
            choice.front_result.objection = "unreliable";
    }
}

void ParetoFront::judge(std::vector<ComparedChoice>& choices, CompareSetting& setting) {
    judge_steps(choices);
    for (ComparedChoice* choice = next_candidate(choices); choice != nullptr && !cancel_.requested(); choice = next_candidate(choices)) {
        progress_(fmt::format("{} over {}, about {} of wall time", choice->choice, time_text(duration_),
                              time_text(duration_ * choice->median())));
        choice->front_result.confirmed = confirmation_.check(choice->settings);
        choice->front_result.objection = choice->front_result.confirmed->objection;
    }
    setting.front = true;
    setting.confirm = duration_;
    setting.confirm_reference = confirmation_.reference_text();
    setting.confirm_watch = confirmation_.reference().watch;
}

}  // namespace cvtflow::bench
