#include "tasks/batch/case_engine.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/text.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::string_view statuses[] = {"ok",      "unreliable", "diverged", "budget",     "bad_parameters",
                                         "crashed", "undefined",  "stopped",  "not_steady", "cycle_missed"};
constexpr double brief_periods = 48.0;  ///< pin periods after which means count where a solved neighbour's sheave is held

[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

/// The state comes by reset().
[[nodiscard]] Scene without_state(Scene scene) {
    scene.state_file.clear();
    return scene;
}

void judge(const Fault& fault, CaseResult& result) {
    switch (fault.kind) {
        case FaultKind::none: result.status = CaseStatus::ok; return;
        case FaultKind::cancelled: result.status = CaseStatus::stopped; return;
        case FaultKind::max_steps:
        case FaultKind::max_wall: result.status = CaseStatus::budget; break;
        case FaultKind::not_steady: result.status = CaseStatus::not_steady; break;
        default: result.status = CaseStatus::diverged; break;
    }
    result.error = fault.message();
}

/// Whether what came out can be believed, and what is odd about it.
void judge_energy(const Simulation& simulation, const RunMeans& means, CaseResult& result) {
    const EnergyBalance balance = simulation.workspace().energy.balance(means.mark());
    result.residual = balance.relative();
    result.balance_error_ratio = simulation.balance_error_ratio(means.mark());
    if (simulation.workspace().layout().pulley_size != 0) {
        result.efficiency = means.all().efficiency;
        name_notes(means, balance, result.notes);
    }
    if (result.status != CaseStatus::ok) return;
    if (result.balance_error_ratio > 1.0) {
        result.status = CaseStatus::unreliable;
        result.error = fmt::format("the residual of the energy balance is {:.2g} times the tolerance", result.balance_error_ratio);
    } else if (const SpanMeans whole = means.all(); whole.cycle_missed()) {
        result.status = CaseStatus::cycle_missed;
        result.error = means.cycle_miss().text(whole);
    }
}

}  // namespace

std::span<const std::string_view> status_names() noexcept { return statuses; }
std::string_view status_name(CaseStatus status) noexcept { return statuses[static_cast<int>(status)]; }

CaseEngine::CaseEngine(const Sweep& sweep, StartStates& starts, BatchControl& control, CasePlaces places)
    : sweep_(sweep),
      starts_(starts),
      control_(control),
      places_(std::move(places)),
      scene_(sweep.scene),
      scalars_(sweep),
      ends_(sweep, places_.continuation) {
    result_.scalars.resize(sweep.scalars.size());
    result_.errors.resize(sweep.scalars.size());
}

const CaseResult& CaseEngine::run(long number) {
    result_.number = number;
    result_.error.clear();
    result_.status = CaseStatus::ok;
    prepare();
    try {
        sweep_.apply_case(number, scene_);
        result_.error = violations(scene_);
        if (!result_.error.empty())
            result_.status = CaseStatus::bad_parameters;
        else
            integrate();
    } catch (const engine::RecordError&) {
        throw;
    } catch (const std::filesystem::filesystem_error& error) {
        throw engine::RecordError(engine::error_text(error));
    } catch (const StartFault& fault) {
        judge(fault.fault, result_);
        if (result_.status != CaseStatus::stopped) result_.error = fault.what();
    } catch (const std::bad_alloc&) {
        result_.status = CaseStatus::crashed;
        result_.error = "out of memory";
    } catch (const std::exception& error) {  // errors of the scene: a chain that does not close, a state that does not fit
        result_.status = CaseStatus::bad_parameters;
        result_.error = engine::error_text(error);
    }
    result_.wall = elapsed();
    if (!has_scalars(result_.status)) std::fill(result_.scalars.begin(), result_.scalars.end(), std::numeric_limits<double>::quiet_NaN());
    return result_;
}

const CaseResult& CaseEngine::run_from_own_start(long number, double until) {
    own_start_ = true;
    longer_ = until;
    const CaseResult& result = run(number);
    own_start_ = false;
    longer_ = 0.0;
    return result;
}

const CaseResult& CaseEngine::book_crash(long number, const std::string& why) {
    prepare();
    result_.number = number;
    result_.start = {};
    result_.status = CaseStatus::crashed;
    result_.error = why;
    result_.wall = 0.0;
    std::fill(result_.scalars.begin(), result_.scalars.end(), std::numeric_limits<double>::quiet_NaN());
    return result_;
}

void CaseEngine::prepare() {
    started_ = std::chrono::steady_clock::now();
    history_ = {};
    recorder_.reset();
    scalars_.clear();
    std::fill(result_.errors.begin(), result_.errors.end(), std::numeric_limits<double>::quiet_NaN());
    result_.settled_for = std::numeric_limits<double>::quiet_NaN();
    result_.efficiency = result_.residual = result_.balance_error_ratio = std::numeric_limits<double>::quiet_NaN();
    result_.notes.clear();
    result_.counters = result_.settling = {};
    result_.hash = result_.start_state = 0;
}

double CaseEngine::elapsed() const { return seconds_since(started_); }

void CaseEngine::begin(const ContinuedStart& from) {
    if (at_ == nullptr || !fits(at_->simulation, scene_)) at_ = std::make_unique<CaseSite>(without_state(scene_), Schedule{});
    at_->simulation.reset(scene_, from.state.get(), from.state ? nullptr : starts_.placed(result_.number, scene_).get());
    if (from.sheave) {
        model::HeldInputs held = at_->simulation.workspace().variator.pulleys().torques().held();
        held.sheave = from.sheave;
        at_->simulation.hold(held);
    }
    if (!sweep_.records || own_start_) return;
    record_options_.file = case_record(case_file(places_.records, "case", result_.number), scene_);
    recorder_ = std::make_unique<RunRecorder>(scene_, at_->simulation, record_options_);
}

void CaseEngine::integrate() {
    const ContinuedStart start = own_start_ ? ContinuedStart{} : ends_.start(result_.number, scene_);
    Fault fault = attempt(start);
    if (start.sheave && astray()) {
        prepare();
        result_.error.clear();
        fault = attempt(ends_.plain());
    }
    result_.hash = at_->simulation.hash();
    result_.counters = at_->simulation.counters();
    scalars_.write(result_);
    if (result_.status == CaseStatus::stopped) return recorder_.reset();
    if (recorder_) {
        RunReport report;
        report.fault = fault;
        report.step_setting = scene_.run.step;
        std::exchange(recorder_, nullptr)->finish(at_->simulation, report, elapsed());
    }
    const bool slides = result_.status == CaseStatus::not_steady && scalars_.means().steady().sliding > 0.0;
    if ((result_.status == CaseStatus::ok || (result_.status == CaseStatus::not_steady && !slides)) && !own_start_)
        ends_.keep(result_.number, scene_, at_->simulation, scalars_.sections(), scalars_.means());
}

/// Runs the case from a start, and judges it.
Fault CaseEngine::attempt(ContinuedStart from) {
    result_.start = from.extrapolated ? "extrapolated" : from.state ? "continued" : starts_.kind(scene_);
    SteadyRule rule = steady_rule(scene_);
    if (longer_ > 0.0) {
        rule.tolerance = 0.0;
        rule.limit = std::numeric_limits<double>::infinity();
    } else if (from.sheave) {
        rule.controlled = 0.0;
        rule.brief = brief_periods;
        rule.cylinder = from.cylinder;
    }
    RunMeans& means = scalars_.means();
    scalars_.seek_steady(rule);
    end_ = longer_ > 0.0 ? RunEnd{longer_, longer_} : end_of(scene_);
    if (!from.state) from.state = starts_.of_case(result_.number, scene_, control_.stop());
    result_.start_state = from.state ? content_hash(*from.state) : 0;
    begin(from);
    const Fault fault = run();
    result_.settling = history_.settling;
    if (longer_ > 0.0) means.conclude();
    judge(fault, result_);
    judge_energy(at_->simulation, means, result_);
    return fault;
}

/// Whether a start whose sheave was held from its begin on has led nowhere.
bool CaseEngine::astray() {
    const bool can_be = result_.status == CaseStatus::ok || result_.status == CaseStatus::not_steady;
    return result_.status != CaseStatus::stopped && (!can_be || scalars_.means().steady().astray);
}

/// Settling, if the case needs it, and the run.
Fault CaseEngine::run() {
    scalars_.observe(*at_, scene_.run, end_.time);
    RunLoop loop(at_->simulation, history_, scalars_.means(), *this, scalars_, never_);
    loop.record(recorder_.get());
    const Fault fault = loop.settle(-scene_.parameters.start.settling_time);
    return fault ? fault : loop.run(end_);
}

/// Whether a request to stop leaves the case no time to end. time [s]
bool CaseEngine::due(double time, const Counters& /*counters*/) {
    if (!control_.stop().requested()) return false;
    const double begin = at_->simulation.needs_settling() ? -scene_.parameters.start.settling_time : 0.0;
    const double share = (time - begin) / std::max(1e-300, end_.latest - begin);
    const double left = share > 0.0 ? elapsed() * (1.0 - share) / share : std::numeric_limits<double>::infinity();
    return left > control_.grace_left();
}

double BatchProgress::left() const noexcept {
    const long open = cases - before - done;
    if (open == 0) return 0.0;
    if (warm == 0 || done < 2 * warm) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(open) * (wall - warm_wall) / static_cast<double>(done - warm);
}

double BatchControl::grace_left() {
    return mutex_.guard([&] {
        if (asked_ == std::chrono::steady_clock::time_point{}) asked_ = std::chrono::steady_clock::now();
        return grace_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - asked_).count();
    });
}

void BatchControl::tell(const std::string& what) {
    mutex_.guard([&] {
        if (notice_) notice_(what);
    });
}

}  // namespace cvtflow::tasks
