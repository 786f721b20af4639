#include <fmt/format.h>
#include <cmath>
#include <limits>

#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

namespace {

/// Where periods count, all samples lie equally far apart, whatever the outputs do, and scalars are of nothing else.
constexpr Occasion each_sample{.sample = true, .output = true, .last = true};

}  // namespace

void CaseScalars::clear() {
    reducers_.resize(sweep_.scalars.size());
    for (Reducer& reducer : reducers_) reducer.clear();
    means_.clear();
    output_before_ = -std::numeric_limits<double>::infinity();
}

void CaseScalars::sample(const CaseInstant& now) {
    if (due(now.time)) reduce(now, by_periods() ? each_sample : Occasion{.sample = true});
}

/// Where samples lie apart by more than outputs, as at rest, outputs are samples.
void CaseScalars::output(const CaseInstant& now, bool last) {
    if (by_periods()) return sample(now);
    reduce(now, {last || due(now.time) || means_.curve().last().time <= output_before_, true, last});
    output_before_ = now.time;
}

void CaseScalars::reduce(const CaseInstant& at, const Occasion& when) {
    bool chain = when.sample;
    for (std::size_t i = 0; i < sweep_.scalars.size() && !chain; ++i)
        chain = reducers_[i].needs_chain(sweep_.scalars[i], at.time, when, at.counters);
    const Workspace& w = at.workspace;
    const Instant now{chain ? w.observed_by(at.observer, at.time) : w.shafts_observed_by(at.observer, at.time), w, at.counters,
                      at.followed_pin, at.observer};
    if (when.sample) add_sample(means_, now.observation, w, at.time);
    const std::span<Reducer> present = present_reducers();
    for (std::size_t i = 0; i < present.size(); ++i) present[i].read(sweep_.scalars[i], now, when, values_);
}

/// Where periods count, each has its own. Integrals begin at the last sample of the period before: they add up.
std::span<Reducer> CaseScalars::present_reducers() {
    const std::size_t count = sweep_.scalars.size(), first = by_periods() ? (means_.curve().points().size() - 1) * count : 0;
    for (std::size_t next = reducers_.size(); next < first + count; ++next)
        reducers_.push_back(reducers_[next - count].continued(sweep_.scalars[next % count]));
    return {reducers_.data() + first, count};
}

void CaseScalars::write(CaseResult& result) const {
    for (std::size_t i = 0; i < sweep_.scalars.size(); ++i) {
        if (by_periods())
            write_steady(i, result);
        else
            result.scalars[i] = reducers_[i].result(sweep_.scalars[i]);
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
    result.errors[i] = means.off_target + error_of_mean(values).sum() / scalar.error_scale(result.scalars[i]);
}

void CaseScalars::save(std::vector<double>& memory) const {
    memory.push_back(static_cast<double>(reducers_.size()));
    for (const Reducer& reducer : reducers_) reducer.save(memory);
    means_.save(memory);
}

std::span<const double> CaseScalars::load(std::span<const double> memory, double time) {
    output_before_ = time;
    reducers_.resize(static_cast<std::size_t>(pop_integer(memory, 0, std::numeric_limits<int>::max())));
    for (Reducer& reducer : reducers_) memory = reducer.load(memory);
    return means_.load(memory);
}

}  // namespace cvtflow::tasks
