#include "bench/study/extremes/extremes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <set>

#include "model/observe/observation.hpp"
#include "tasks/method/auto_step.hpp"

namespace cvtflow::bench {

using namespace tasks;

const std::vector<Extreme>& extremes() {
    static const std::vector<Extreme> rows = [] {
        std::vector<Extreme> all;
        add_friction_rows(all);
        add_size_rows(all);
        add_operation_rows(all);
        add_contact_rows(all);
        add_step_rows(all);
        add_number_rows(all);
        add_limit_rows(all);
        return all;
    }();
    return rows;
}

namespace {

/// Factor on the largest stable step above which a step counts as beyond stability. The estimate is good to some per cent, and a
/// method that is a little unstable in a few contacts only (RK4 at 50 ns on the baseline: 1.1) still gives good results.
constexpr double beyond_stability = 1.25;

const char* const methods[] = {"rk4", "dopri54", "dumka3-p3", "leapfrog-chebyshev"};

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

constexpr double usual_step = 5e-8;
constexpr double wall_limit = 120.0;

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

double length(const std::vector<double>& a) { return distance(a, std::vector<double>(a.size())); }

/// Residual over the energy that passed or is stored; a thousandth of the whole counts as passed, so that a system at rest need not balance
/// rounding.
double imbalance(const Account& before, const Account& after) {
    const double error = (after.energy - before.energy) - (after.put_in - before.put_in) + (after.lost - before.lost);
    const double passed = after.passed - before.passed + std::abs(after.energy - before.energy);
    return std::abs(error) / std::max({passed, 1e-3 * std::abs(before.energy), 1e-12});
}

[[nodiscard]] bool finite(const Account& account) {
    return std::isfinite(account.energy) &&
           std::all_of(account.unknowns.begin(), account.unknowns.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

std::string_view ending_name(Ending ending) noexcept {
    constexpr std::string_view names[] = {"right", "refused", "fault", "announced", "wrong"};
    return names[static_cast<int>(ending)];
}

struct ExtremeJudge::Level {
    std::string name;
    Scene scene;
    IntegrationState settled;
};

ExtremeJudge::ExtremeJudge(const Scene& tiny) {
    SilentObserver silent;
    const engine::Cancellation never;
    for (const auto& [name, scene] : details(tiny)) {
        Level level{name, scene, {}};
        set_values(level.scene, std::vector<std::string>{"start.settling_time=1 ms", "start.ramp_time=0.8 ms", "record.ledger=true",
                                                         "run.schedule=serial"});
        Simulation simulation(level.scene);
        if (const Fault fault = simulation.advance({.until = 0.0}, silent, never))
            throw SimulationError(fmt::format("detail {} does not settle: {}", name, fault.message()));
        level.settled = simulation.integration_state();
        level.scene.parameters.start.settling_time = 0.0;
        levels_.push_back(std::move(level));
    }
}

ExtremeJudge::~ExtremeJudge() = default;

namespace {

/// A simulation of the row at its start, ready to run with a step.
class JudgedTrial {
public:
    /// @param nominal the row's step, which its preparation may depend on   @param step the one to run with
    JudgedTrial(const Extreme& row, Scene scene, const IntegrationState& settled, double nominal, double step, double span)
        : simulation_(with_step(std::move(scene), step, span)) {
        IntegrationState start = simulation_.integration_state();
        if (!row.geometric && settled.state.size() == start.state.size() && settled.phases.size() == start.phases.size()) start = settled;
        simulation_.restore(start);
        if (row.prepare != nullptr) {
            row.prepare(simulation_, nominal, start);
            simulation_.restore(start);
        }
        probed_ = run(0.0);  // phases are those of the start
    }
    [[nodiscard]] Simulation& simulation() noexcept { return simulation_; }
    [[nodiscard]] Fault run(double span) {
        if (probed_) return probed_;
        SilentObserver silent;
        const engine::Cancellation never;
        return simulation_.advance({.until = simulation_.time() + span, .new_part = true}, silent, never);
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

/// Stable step of both the row's and RK4's at its start; zero or infinite values mean that there is no answer.
[[nodiscard]] double stable_step(const Simulation& simulation, const std::string& method) {
    const Workspace& w = simulation.workspace();
    const auto limit = [&](const Method& of) {
        AutoStep step(w.variator, w.parameters, of);
        (void)step.longest(simulation.time(), w.state(), w.tips.phases.data());
        return step.stable_step();
    };
    return std::min(limit(method), limit("rk4"));
}

[[nodiscard]] double step_for(const Extreme& row, double stable) {
    if (row.step > 0.0) return row.step;
    return std::isfinite(stable) && stable > 0.0 ? std::min(usual_step, 0.1 * stable) : usual_step;
}

/// Objection to a complete run; empty: none.
[[nodiscard]] std::string objection(const Extreme& row, const ExtremeCase& result, long transitions) {
    const double bound = row.bound + (result.method.starts_with("leapfrog") ? row.swing : 0.0);
    if (result.balance > bound) return fmt::format("energy balance {:.2g}, bound {:.2g}", result.balance, bound);
    if (result.refinement > 10.0 * bound)
        return fmt::format("half the step changes the result by {:.2g}, bound {:.2g}", result.refinement, 10.0 * bound);
    if (transitions < row.min_transitions) return fmt::format("{} transitions, {} expected", transitions, row.min_transitions);
    return "";
}

void compare_halved(const Extreme& row, const Scene& scene, const IntegrationState& settled, double span, JudgedTrial& coarse,
                    const Account& before, ExtremeCase& result) {
    const Account after = account_of(coarse.simulation());
    JudgedTrial fine(row, scene, settled, result.step, 0.5 * result.step, span);
    result.fault = fine.run(0.5 * span);
    const Account halfway = account_of(fine.simulation());
    if (!result.fault) result.fault = fine.run(0.5 * span);
    if (result.fault) {
        result.ending = Ending::fault;
        result.message = "at half the step: " + result.fault.message();
        return;
    }
    const Account finer = account_of(fine.simulation());
    if (!finite(after) || !finite(finer)) {
        result.message = "not finite and not said";
        return;
    }
    result.balance = imbalance(before, after);
    // An oscillation that is back where it began at the end was elsewhere before.
    const double moved =
        std::max({distance(finer.unknowns, before.unknowns), distance(halfway.unknowns, before.unknowns), 1e-9 * length(before.unknowns)});
    result.refinement = moved > 0.0 ? distance(after.unknowns, finer.unknowns) / moved : 0.0;
    result.message = objection(row, result, coarse.simulation().counters().detected);
    const bool beyond = result.step > beyond_stability * result.stable_step;
    result.ending = result.message.empty() ? Ending::right : beyond ? Ending::announced : Ending::wrong;
}

}  // namespace

ExtremeCase ExtremeJudge::run(const Extreme& row, const Level& level, const std::string& method) const {
    ExtremeCase result;
    result.method = method;
    result.detail = level.name;
    const auto started = std::chrono::steady_clock::now();
    try {
        Scene scene = level.scene;
        scene.run.method = method;
        set_values(scene, row.settings);
        result.stable_step = stable_step(JudgedTrial(row, scene, level.settled, usual_step, usual_step, 1e-5).simulation(), method);
        result.step = step_for(row, result.stable_step);
        const double span = static_cast<double>(row.steps) * result.step;
        JudgedTrial coarse(row, scene, level.settled, result.step, result.step, span);
        const Account before = account_of(coarse.simulation());
        result.fault = coarse.run(span);
        result.steps = coarse.simulation().counters().steps;
        if (result.fault) {
            result.ending = Ending::fault;
            result.message = result.fault.message();
        } else {
            compare_halved(row, scene, level.settled, span, coarse, before, result);
        }
    } catch (const std::exception& error) {  // SceneError, SimulationError, std::invalid_argument: the scene is refused in words
        result.ending = Ending::refused;
        result.message = error.what();
    }
    result.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return result;
}

namespace {

[[nodiscard]] bool allowed(const Extreme& row, const ExtremeCase& one) {
    const bool ending = std::find(row.allowed.begin(), row.allowed.end(), one.ending) != row.allowed.end();
    if (!ending || one.wall > wall_limit) return false;
    return one.ending != Ending::fault || row.faults.empty() ||
           std::find(row.faults.begin(), row.faults.end(), one.fault.kind) != row.faults.end();
}

}  // namespace

ExtremeResult ExtremeJudge::judge(const Extreme& row) {
    ExtremeResult result{&row, {}, true};
    for (const Level& level : levels_) {
        for (const char* method : methods) {
            result.cases.push_back(run(row, level, method));
            result.passed = result.passed && allowed(row, result.cases.back());
        }
    }
    return result;
}

std::string ExtremeResult::outcome() const {
    std::string text;
    for (const Ending ending : {Ending::right, Ending::refused, Ending::fault, Ending::announced, Ending::wrong}) {
        std::vector<const ExtremeCase*> like;
        for (const ExtremeCase& one : cases) {
            if (one.ending == ending) like.push_back(&one);
        }
        if (like.empty()) continue;
        const auto worst = [&](double ExtremeCase::*member) {
            double most = 0.0;
            for (const ExtremeCase* one : like) most = std::max(most, one->*member);
            return most;
        };
        long steps = 0;
        for (const ExtremeCase* one : like) steps = std::max(steps, one->steps);
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", like.size(), ending_name(ending));
        if (ending == Ending::right)
            text += fmt::format(" (balance {:.0e}, half step {:.0e})", worst(&ExtremeCase::balance), worst(&ExtremeCase::refinement));
        if (ending == Ending::fault) {
            std::set<std::string> names;
            for (const ExtremeCase* one : like) names.insert(one->fault.name());
            text += fmt::format(" ({} after {} steps at most)", fmt::join(names, ", "), steps);
        }
        if (ending == Ending::announced) text += fmt::format(" (stable up to {:.2g} s)", worst(&ExtremeCase::stable_step));
        if (ending == Ending::refused || ending == Ending::wrong)
            text += fmt::format(" ({})", like.front()->message.substr(0, like.front()->message.find('\n')));
    }
    return text;
}

}  // namespace cvtflow::bench
