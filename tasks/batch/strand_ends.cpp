#include "tasks/batch/strand_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/start/shift_ratio.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace {

/// Numbers beside a mean state: means of S_1 [N] and of the ratio [1], which are extrapolated with it; SteadyRule::cylinder [W], negative
/// where no sheave was held.
using Beside = std::array<double, 3>;
enum Solved { force, ratio, cylinder };

[[nodiscard]] std::optional<Beside> beside(const StartStates::State& end) {
    if (!end || end->means.size() <= cylinder) return {};
    return Beside{end->means[force], end->means[ratio], end->means[cylinder]};
}

/// Value of a key in a case; not a number where it has none.
[[nodiscard]] double value_in(const Sweep& sweep, const std::string& key, long number) {
    for (std::size_t axis = 0; axis < sweep.axes.size(); ++axis) {
        const auto& keys = sweep.axes[axis].keys;
        const auto at = std::ranges::find(keys, key, &Parameter::key);
        if (at == keys.end()) continue;
        const AxisValue& value = sweep.axes[axis].at(sweep.row(number, axis), static_cast<std::size_t>(at - keys.begin()));
        if (const auto* of_case = std::get_if<double>(&value)) return *of_case;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

/// A step from one case to another, along a key, that a start repeats.
struct StrandEnds::Step {
    long from, back, ahead;  ///< cases: of the state, and of the step
    const std::string* key;
};

std::string StrandEnds::file(long number) const { return case_file(folder_, "end", number); }

bool StrandEnds::exists(long number) const {
    std::error_code missing;
    if (!std::filesystem::exists(file(number), missing)) return false;
    try {
        static_cast<void>(engine::read_state(file(number)));
        return true;
    } catch (const engine::RecordError&) {
        return false;
    }
}

StartStates::State StrandEnds::at(long number) {
    if (const auto known = ends_.find(number); known != ends_.end()) return known->second;
    std::error_code missing;
    if (!std::filesystem::exists(file(number), missing)) return nullptr;
    return ends_[number] = std::make_shared<engine::SavedState>(engine::read_state(file(number)));
}

void StrandEnds::forget(long strand) {
    remove_ends(folder_, sweep_, strand);
    ends_.clear();
}

ContinuedStart StrandEnds::start(long number, const Scene& scene) {
    if (sweep_.strand() == 1) return {};
    if (strand_ >= 0 && strand_ != number / sweep_.strand()) forget(strand_);
    strand_ = number / sweep_.strand();
    const long line = sweep_.line, first = strand_ * sweep_.strand(), begin = number - number % line, before = number - line;
    long from = number - 1;
    while (from >= begin && !at(from)) --from;
    if (from < begin) from = before;
    if (from < first || !at(from) || !start_fits(*at(from), scene)) return {};
    plain_ = at(from);
    ContinuedStart start{plain_};
    if (from != before && from != number - 1) return start;
    Step step{from, before - line, before, &sweep_.across};
    if (from == number - 1) {
        const bool as_before = before >= first && beside(at(before)) && beside(at(before - 1));
        step = {from, as_before ? before - 1 : std::max(begin, number - 2), as_before ? before : from, &sweep_.continuation};
    }
    if (beside(at(from))) take(step, number, scene, start);
    return start;
}

void StrandEnds::take(const Step& step, long number, const Scene& scene, ContinuedStart& start) {
    constexpr double farthest = 2.0, largest_move = 0.03;  // share of the step; change of the ratio
    constexpr double shock = 2.0 * EnergyLedger::window;   // what is not quite a motion begins with one, as where a case settles [s]
    const model::ChainLayout layout = model::layout_of(scene.parameters);
    auto moved = std::make_shared<engine::SavedState>(*start.state);
    moved->time = -shock;
    turn_shaft(moved->state.data(), scene.parameters, 0, scene.parameters.drive.speed.integral(moved->time));
    start.state = moved;
    Beside solved = *beside(start.state);
    const StartStates::State back = step.back < strand_ * sweep_.strand() ? nullptr : at(step.back), ahead = at(step.ahead);
    const auto value = [&](long of) { return value_in(sweep_, *step.key, of); };
    const double share = (value(number) - value(step.from)) / (value(step.ahead) - value(step.back));
    if (beside(back) && beside(ahead) && share > 0.0 && share <= farthest) {
        const auto motion = static_cast<std::size_t>(layout.control_begin());
        for (std::size_t k = 0; k < motion; ++k) moved->state[k] += share * (ahead->state[k] - back->state[k]);
        for (const std::size_t k : {force, ratio}) solved[k] += share * ((*beside(ahead))[k] - (*beside(back))[k]);
        start = {moved, {}, 0.0, true};
    }
    const double target = scene.parameters.control.ratio.at(0.0);
    const bool along_the_line = step.from == number - 1;
    if (scene.when_steady != WhenSteady::hold || solved[cylinder] < 0.0 || !(start.extrapolated || along_the_line)) return;
    if (!(std::abs(solved[ratio] / target - 1.0) < largest_move)) return;
    if (!model::shift_ratio(scene.parameters, solved[ratio], target, moved->state.data())) return;
    model::PulleyCoordinates coordinates;
    coordinates.adopt(scene.parameters);
    const double opening = coordinates.opening(moved->state.data() + layout.pulley_begin(), 0);
    start = {moved, model::HeldSheave{opening, std::max(0.0, solved[force])}, solved[cylinder], start.extrapolated};
}

void StrandEnds::keep(long number, const Scene& scene, Simulation& simulation, const SectionMean& sections, const RunMeans& means) {
    if (sweep_.strand() == 1) return;
    simulation.move_offset();
    auto saved = std::make_shared<engine::SavedState>(simulation.saved_state());
    turn_shaft(saved->state.data(), scene.parameters, 0, -scene.parameters.drive.speed.integral(saved->time));
    saved->time = 0.0;
    if (sections.put(*saved, simulation.workspace().layout())) {
        const SpanMeans all = means.all();
        saved->means = {all.clamping[0], all.ratio, means.rule().holds_sheave() ? means.rule().cylinder : -1.0};
        saved->balance_error_ratio =
            simulation.balance_error_ratio(means.mark());  // what was before the means is no part of the mean state
    }
    ends_[number] = saved;
    try {
        std::filesystem::create_directories(folder_);
        engine::write_state({file(number), engine::is_state_file, remove_by_hand}, *saved,
                            false);  // a strand without a readable end begins anew
    } catch (const engine::RecordError&) {
        if (!exists(number)) throw;  // another process has written the same bits
    }
}

}  // namespace cvtflow::tasks
