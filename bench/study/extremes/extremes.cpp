#include "bench/study/extremes/extremes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/observe/observation.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

const char* const methods[] = {"rk4", "dopri54", "dumka3-p3", "leapfrog-sweep"};
constexpr double usual_step = 5e-8;   ///< [s]
constexpr double wall_limit = 120.0;  ///< [s]
/// Largest relative error of the energy balance, and ten times less strict of the state against half the step: the start may put all energy
/// into the stiffest mode, which methods damp by 3e-5 a step at a tenth of stability.
constexpr double bound = 5e-3;
/// Additional error that leapfrogs are allowed. Their energy is that of a neighbouring system and swings about ours by (h omega)^2 / 4, and
/// they lag by (h omega)^2 / 24 of the angle; at a tenth of stability h omega = 0.28.
constexpr double swing = 0.02;

/// A key with a value as a row; `beyond` its range it must be refused.
void add(std::vector<Extreme>& rows, const Parameter& parameter, const std::string& value, bool beyond = false) {
    rows.push_back(
        {std::string(parameter.section()), fmt::format("{} = {}", parameter.key, value), {fmt::format("{}={}", parameter.key, value)}});
    if (beyond) rows.back().allowed = {Ending::refused};
}

void add_numbers(std::vector<Extreme>& rows, const Parameter& parameter) {
    const bool list = parameter.kind() == Kind::number_list;
    const auto text = [&](const std::string& number) { return list ? "[" + number + "]" : number; };
    for (const double limit : {parameter.min, parameter.max}) add(rows, parameter, text(number_text(limit)));
    const double beyond =
        1.0 + 1e-9 * (parameter.kind() == Kind::integer ? 1e9 : std::max(std::abs(parameter.max), std::abs(parameter.min)));
    for (const std::string& number :
         {number_text(parameter.min - beyond), number_text(parameter.max + beyond), std::string("nan"), std::string("inf")})
        add(rows, parameter, text(number), true);
    if (parameter.kind() != Kind::time_table) return;
    for (const auto& [from, to] : {std::pair(parameter.min, parameter.max), std::pair(parameter.max, parameter.min)})
        add(rows, parameter, fmt::format("[[0, {}], [1e-12, {}]]", number_text(from), number_text(to)));
}

void add_key(std::vector<Extreme>& rows, const Parameter& parameter) {
    switch (parameter.kind()) {
        case Kind::number:
        case Kind::auto_number:
        case Kind::number_list:
        case Kind::time_table:
        case Kind::integer: return add_numbers(rows, parameter);
        case Kind::choice:
            for (const std::string_view word : parameter.choices) add(rows, parameter, std::string(word));
            return;
        case Kind::boolean:
            for (const char* word : {"true", "false"}) add(rows, parameter, word);
            return;
        case Kind::text:
        case Kind::text_list:
        case Kind::speed_table: return;
    }
}

/// Steps from the shortest to far beyond stability, and states that no run comes to.
void add_starts(std::vector<Extreme>& rows) {
    for (double step = 1e-12; step < 2e-2; step *= 10.0) {
        rows.push_back({"run", fmt::format("run.step = {:g}", step), {}});
        rows.back().step = step;
        rows.back().allowed.push_back(Ending::announced);
    }
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double velocity : {std::numeric_limits<double>::quiet_NaN(), infinity, 1e300, 1e154, 2e4}) {
        rows.push_back({"start", fmt::format("a pin at {:g} m/s", velocity), {}, {Ending::fault}});
        rows.back().velocity = velocity;
    }
    rows.push_back(
        {"chain", "free ring of 10,000", {"chain.pins=10000", "detail.pulleys=absent", "start.layout=ring", "start.ring_speed=2"}});
    rows.back().allowed = {Ending::right};
    rows.back().steps = 10;
    rows.back().nightly = true;
}

/// The levels of the catalogue, and one with lumped plates and rigid sheaves that it does not have.
std::vector<std::pair<std::string, Scene>> details(const Scene& scene) {
    std::vector<std::pair<std::string, Scene>> all{{"lumped", scene}};
    set_values(all.front().second, std::vector<std::string>{"detail.plates=lumped", "detail.pulleys=rigid"});
    for (const DetailPreset& preset : detail_presets().subspan(1)) {  // rigid pins count no transitions and take none of these methods
        all.emplace_back(preset.name, scene);
        apply_detail(all.back().second, preset.name);
    }
    return all;
}

/// Energies, their flow through the ledger, and the unknowns.
struct Account {
    double energy = 0.0, lost = 0.0, put_in = 0.0, passed = 0.0;
    std::vector<double> unknowns;
};

Account account_of(const Simulation& simulation) {
    const model::ChainLayout& at = simulation.workspace().layout();
    model::Observer observer(simulation.workspace().variator);
    const auto& energies = simulation.workspace().observed_by(observer, simulation.time()).account.energy;
    Account account;
    account.energy = std::accumulate(energies.begin(), energies.end(), 0.0);
    for (int k = 0; k < model::loss_kinds + model::work_kinds; ++k) {
        const double entry = simulation.workspace().state()[at.ledger_begin() + k];
        (k < model::loss_kinds ? account.lost : account.put_in) += entry;
        account.passed += std::abs(entry);
    }
    account.unknowns.assign(simulation.workspace().state(), simulation.workspace().state() + at.ledger_begin());
    return account;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum);
}

/// Residual over the energy that passed or is stored; a thousandth of the whole counts as passed, so that a system at rest need not balance
/// rounding.
double imbalance(const Account& before, const Account& after) {
    const double error = (after.energy - before.energy) - (after.put_in - before.put_in) + (after.lost - before.lost);
    const double passed = after.passed - before.passed + std::abs(after.energy - before.energy);
    return std::abs(error) / std::max({passed, 1e-3 * std::abs(before.energy), 1e-12});
}

[[nodiscard]] bool finite(const Account& account) {
    return std::isfinite(account.energy) && std::ranges::all_of(account.unknowns, [](double x) { return std::isfinite(x); });
}

/// A simulation of the row at its start, ready to run with a step.
class JudgedTrial {
public:
    JudgedTrial(const Extreme& row, Scene scene, const IntegrationState& settled, double step, double span)
        : simulation_(with_step(std::move(scene), step, span)) {
        IntegrationState start = simulation_.integration_state();
        if (settled.state.size() == start.state.size() && settled.phases.size() == start.phases.size()) start = settled;
        const model::ChainLayout& at = simulation_.workspace().layout();
        if (row.velocity != 0.0) start.state[static_cast<std::size_t>(at.link_begin(2) + at.link_size())] = row.velocity;
        simulation_.restore(start);
        probed_ = run(0.0);  // phases are those of the start
    }
    [[nodiscard]] const Simulation& simulation() const noexcept { return simulation_; }
    [[nodiscard]] Fault run(double span) {
        if (probed_) return probed_;
        SilentObserver silent;
        return simulation_.advance({.until = simulation_.time() + span, .new_part = true}, silent, engine::Cancellation());
    }

private:
    static Scene with_step(Scene scene, double step, double span) {
        scene.run.step = step;
        scene.run.output_interval = span;
        return scene;
    }
    Simulation simulation_;
    Fault probed_;
};

/// The largest step that the program states at a simulation's present state; 0 or infinite: there is no answer.
[[nodiscard]] double stated_step(const Simulation& simulation, const Method& method) {
    const Workspace& w = simulation.workspace();
    AutoStep step(w.variator, w.parameters, method);
    (void)step.longest(simulation.time(), w.state(), w.tips.phases.data());
    return step.stable_step();
}

void ends_by(ExtremeCase& result, Ending ending, const std::string& message) { result.ending = ending, result.message = message; }

/// Runs with the case's step and with half of it, and compares.
void compare_halved(const Extreme& row, const Scene& scene, const IntegrationState& settled, double stated, ExtremeCase& result) {
    const double span = static_cast<double>(row.steps) * result.step;
    JudgedTrial coarse(row, scene, settled, result.step, span), fine(row, scene, settled, 0.5 * result.step, span);
    const Account before = account_of(coarse.simulation());
    Fault fault = coarse.run(span);
    if (!fault) fault = fine.run(0.5 * span);
    if (fault) return ends_by(result, Ending::fault, fault.message());
    const Account halfway = account_of(fine.simulation());
    fault = fine.run(0.5 * span);
    if (fault) return ends_by(result, Ending::fault, fault.message());
    const Account after = account_of(coarse.simulation()), finer = account_of(fine.simulation());
    if (!finite(after) || !finite(finer)) return ends_by(result, Ending::wrong, "not finite and not said");
    result.balance = imbalance(before, after);
    // An oscillation that is back where it began at the end was elsewhere before.
    const double length = distance(before.unknowns, std::vector<double>(before.unknowns.size()));
    const double moved = std::max({distance(finer.unknowns, before.unknowns), distance(halfway.unknowns, before.unknowns), 1e-9 * length});
    result.refinement = moved > 0.0 ? distance(after.unknowns, finer.unknowns) / moved : 0.0;
    const double allowed = bound + (result.method.starts_with("leapfrog") ? swing : 0.0);
    if (result.balance <= allowed && result.refinement <= 10.0 * allowed) return ends_by(result, Ending::right, "");
    ends_by(result, result.step > stated ? Ending::announced : Ending::wrong,
            fmt::format("energy balance {:.2g}, half the step changes the result by {:.2g}", result.balance, result.refinement));
}

}  // namespace

std::string_view ending_name(Ending ending) noexcept {
    constexpr std::string_view names[] = {"right", "refused", "fault", "announced", "wrong"};
    return names[static_cast<int>(ending)];
}

const std::vector<Extreme>& extremes() {
    static const std::vector<Extreme> rows = [] {
        std::vector<Extreme> all;
        for (const Parameter& parameter : parameter_table()) {
            const std::string_view section = parameter.section();
            if (section != "run" && section != "scene" && section != "record" && parameter.key != level_key) add_key(all, parameter);
        }
        add_starts(all);
        return all;
    }();
    return rows;
}

ExtremeJudge::ExtremeJudge(const Scene& tiny) {
    SilentObserver silent;
    for (const auto& [name, scene] : details(tiny)) {
        Level level{name, scene, {}};
        set_values(level.scene, std::vector<std::string>{"start.settling_time=1 ms", "start.ramp_time=0.8 ms", "record.ledger=true",
                                                         "run.schedule=serial"});
        Simulation simulation(level.scene);
        if (const Fault fault = simulation.advance({.until = 0.0}, silent, engine::Cancellation()))
            throw SimulationError(fmt::format("detail {} does not settle: {}", name, fault.message()));
        level.settled = simulation.integration_state();
        level.scene.parameters.start.settling_time = 0.0;
        levels_.push_back(std::move(level));
    }
}

ExtremeCase ExtremeJudge::run(const Extreme& row, const Level& level, const std::string& method) {
    ExtremeCase result{method, level.name};
    const auto started = std::chrono::steady_clock::now();
    try {
        Scene scene = level.scene;
        scene.run.method = method;
        set_values(scene, row.settings);
        const JudgedTrial start(row, scene, level.settled, usual_step, 1e-5);
        const double stated = stated_step(start.simulation(), method), stable = std::min(stated, stated_step(start.simulation(), "rk4"));
        result.step = row.step > 0.0 ? row.step : std::isfinite(stable) && stable > 0.0 ? std::min(usual_step, 0.1 * stable) : usual_step;
        compare_halved(row, scene, level.settled, stated, result);
    } catch (const std::exception& error) {  // SceneError, SimulationError, std::invalid_argument: the scene is refused in words
        ends_by(result, Ending::refused, error.what());
    }
    result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return result;
}

ExtremeResult ExtremeJudge::judge(const Extreme& row) const {
    ExtremeResult result{{}, true};
    for (const Level& level : levels_) {
        for (const char* method : methods) {
            const ExtremeCase& one = result.cases.emplace_back(run(row, level, method));
            result.passed = result.passed && std::ranges::count(row.allowed, one.ending) > 0 && one.wall <= wall_limit;
        }
    }
    return result;
}

std::string ExtremeResult::outcome() const {
    std::string text;
    for (const Ending ending : {Ending::right, Ending::refused, Ending::fault, Ending::announced, Ending::wrong}) {
        const auto like = [&](const ExtremeCase& one) { return one.ending == ending; };
        const auto first = std::ranges::find_if(cases, like);
        if (first == cases.end()) continue;
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", std::ranges::count_if(cases, like), ending_name(ending));
        if (!first->message.empty()) text += fmt::format(" ({})", first->message.substr(0, first->message.find('\n')));
    }
    return text;
}

}  // namespace cvtflow::bench
