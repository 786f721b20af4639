#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

namespace {

/// Role of all samples where periods count: samples are equally spaced, whatever the outputs, and scalars use them alone.
constexpr Occasion each_sample{.sample = true, .output = true, .last = true};

}  // namespace

void CaseScalars::clear() {
    reducers_.resize(sweep_.scalars.size());
    for (Reducer& reducer : reducers_) reducer.clear();
    early_count_ = 0;
    means_.clear();
    output_before_ = -std::numeric_limits<double>::infinity();
}

void CaseScalars::observe(CaseSite& site, const RunSettings& run, double end) noexcept {
    site_ = &site;
    followed_pin_ = run.followed_pin;
    end_ = end - 1e-9 * run.output_interval;
    output_interval_ =
        site.simulation.part().outputs_together() > 1 ? run.output_interval * (1.0 - 1e-9) : std::numeric_limits<double>::infinity();
}

void CaseScalars::seek_steady(const SteadyRule& rule) noexcept {
    means_.seek_steady(rule);
    sections_.clear(by_periods() && sweep_.strand() > 1 ? static_cast<int>(rule.repeats) : 0);
}

bool CaseScalars::counts(double time) const noexcept { return !site_->simulation.needs_settling() && time >= sweep_.from * (1.0 - 1e-12); }

void CaseScalars::sample(double time, const Workspace& workspace, const Counters& counters) {
    if (sections_.due(time)) sections_.add(time, workspace);
    if (output_due(time)) return output(time, workspace, counters);
    if (due(time)) reduce(time, workspace, counters, by_periods() ? each_sample : Occasion{.sample = true});
}

/// Takes an output as a sample where samples are farther apart than outputs, as at rest.
void CaseScalars::output(double time, const Workspace& workspace, const Counters& counters) {
    if (!counts(time)) return;
    if (by_periods()) {
        sample(time, workspace, counters);
        return;
    }
    const bool last = time >= end_;
    reduce(time, workspace, counters, {last || due(time) || means_.curve().last().time <= output_before_, true, last});
    output_before_ = time;
}

void CaseScalars::reduce(double time, const Workspace& workspace, const Counters& counters, const Occasion& when) {
    bool chain = when.sample;
    for (std::size_t i = 0; i < sweep_.scalars.size() && !chain; ++i)
        chain = reducers_[i].needs_chain(sweep_.scalars[i], time, when, counters);
    model::Observer& observer = site_->observer;
    const Instant now{chain ? workspace.observed_by(observer, time) : workspace.shafts_observed_by(observer, time), workspace, counters,
                      followed_pin_, observer};
    if (when.sample) add_sample(means_, now.observation, workspace, time);
    const std::span<Reducer> present = present_reducers();
    for (std::size_t i = 0; i < present.size(); ++i) present[i].read(sweep_.scalars[i], now, when, values_);
    if (when.sample && !by_periods()) keep_early();
}

/// Pin periods are counted back from the end, by their length there.
void CaseScalars::keep_early() {
    constexpr double kept = 2.0;  // pin periods: a machine that slows down to half of its speed
    const MeanCurve& curve = means_.curve();
    if (curve.last().time - curve.first().time > kept * curve.pin_period()) return;
    if (early_.size() == early_count_) early_.emplace_back();
    Early& here = early_[early_count_++];
    here.time = curve.last().time;
    here.reducers = reducers_;
}

/// A scalar over whole pin periods, as in the summary of a run.
Reducer CaseScalars::over_periods(std::size_t scalar, double begin) const {
    Reducer whole = reducers_[scalar];
    const std::span<const Early> early = std::span(early_).first(early_count_);
    if (early.empty()) return whole;
    const auto after = std::ranges::lower_bound(early, begin, {}, &Early::time);
    const Early& later = after == early.end() ? early.back() : *after;
    const Early& earlier = after == early.begin() ? later : after[-1];
    whole.begin_at(sweep_.scalars[scalar], begin, earlier.reducers[scalar], later.reducers[scalar]);
    return whole;
}

/// Reducers of the present pin period where periods count, else of the case. Integrals begin at the last sample of the period before.
std::span<Reducer> CaseScalars::present_reducers() {
    const std::size_t count = sweep_.scalars.size(), first = by_periods() ? (means_.curve().points().size() - 1) * count : 0;
    for (std::size_t next = reducers_.size(); next < first + count; ++next)
        reducers_.push_back(reducers_[next - count].continued(sweep_.scalars[next % count]));
    return {reducers_.data() + first, count};
}

void CaseScalars::write(CaseResult& result) const {
    const SpanMeans means = means_.all();
    for (std::size_t i = 0; i < sweep_.scalars.size(); ++i) {
        if (by_periods())
            write_steady(i, result);
        else
            result.scalars[i] = over_periods(i, means.begin).result(sweep_.scalars[i]);
        const Scalar& scalar = sweep_.scalars[i];
        if (std::isfinite(result.scalars[i]) && scalar.terms[0].reduction == Reduction::mean) {  // as in the summary of a run
            if (scalar.is("loss_slip")) result.scalars[i] = means.loss_slip;
            if (scalar.is("thrust_ratio")) result.scalars[i] = means.clamping[0] / means.clamping[1];
        }
        if (result.status != CaseStatus::ok || std::isfinite(result.scalars[i]) || sweep_.scalars[i].may_be_undefined()) continue;
        result.status = CaseStatus::undefined;
        result.error = fmt::format("{} is not a finite number", sweep_.scalars[i].text);
    }
}

/// A scalar over the pin periods of the means, and its error by their batches.
void CaseScalars::write_steady(std::size_t i, CaseResult& result) const {
    const SteadyMeans& means = means_.steady();
    const Scalar& scalar = sweep_.scalars[i];
    std::vector<double> values(means.batches);
    Reducer all;
    for (std::size_t batch = 0; batch < means.batches; ++batch) {
        Reducer part;
        for (std::size_t period = 0; period < means.batch; ++period)
            part.add(scalar, reducers_[(means.begin + batch * means.batch + period) * sweep_.scalars.size() + i]);
        values[batch] = part.result(scalar);
        all.add(scalar, part);
    }
    result.scalars[i] = all.result(scalar);
    if (means.batches == 0) return;
    result.settled_for = means_.all().begin;
    if (!scalar.averages() || result.scalars[i] == 0.0) return;
    const double value = result.scalars[i], scale = scalar.error_scale(value);
    const bool slips = scalar.is("slip") || scalar.is("friction_slip"), off_target = scalar.is("control/error");
    const bool of_ratio = scalar.is("ratio") || off_target;
    const double smallest = scalar.is("slip") ? min_plain_slip : scalar.is("friction_slip") ? min_steady_slip : off_target ? 1.0 : 0.0;
    const double size = std::max(scale, smallest), unseen = of_ratio ? means.unseen_ratio : means.unseen;
    const double by_slip = of_ratio ? size : scalar.is("efficiency") ? 1.0 : 0.0;  // what a slip of all changes of it
    const double slipping = slips ? scale : by_slip * std::abs(means.error[5].mean);
    MeanError error = error_of_mean(values);
    if (slipping > 0.0 && !of_ratio) error.drift *= means.to_come;
    result.errors[i] = means.off_target + std::hypot(unseen * size, means.unseen_slip * slipping, error.sum()) / scale;
}

}  // namespace cvtflow::tasks
