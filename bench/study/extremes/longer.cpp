#include "bench/study/extremes/longer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "engine/executor/tbb/job_pool.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Means up to a time, and from a later one on.
class BothMeans final : public RunObserver {
public:
    BothMeans(const model::Variator& variator, double until, double from) : observer_(variator), until_(until), from_(from) {}
    void output(double time, const Workspace& w, const Counters& counters) override { sample(time, w, counters); }
    [[nodiscard]] bool samples(double time) const noexcept override { return (time <= until_ ? brief : late).curve().due(time); }
    void sample(double time, const Workspace& w, const Counters&) override {
        const model::Observation& now = w.observed_by(observer_, time);
        if (time <= until_ * (1.0 + 1e-9)) brief.add(now, w.energy.sums(time), w.pin_period());
        if (time >= from_) late.add(now, w.energy.sums(time), w.pin_period());
    }
    void transition(const TransitionRecord&) override {}
    RunMeans brief, late;

private:
    model::Observer observer_;
    double until_, from_;  ///< [s]
};

void compare_means(const SpanMeans& brief, const SpanMeans& late, LongerTicket& ticket) {
    constexpr double min_slip = 3e-3, min_share_of_tight = 0.1;
    const auto thrust = [](const SpanMeans& m) { return m.clamping[1] != 0.0 ? m.clamping[0] / m.clamping[1] : 0.0; };
    const auto put = [&](std::string_view quantity, double is, double was, double least) {
        const double off = std::abs(is - was) / std::max(std::abs(was), least);
        if (off > ticket.off) ticket.off = off, ticket.quantity = quantity;
    };
    put("ratio", brief.ratio, late.ratio, 0.0);
    put("thrust ratio", thrust(brief), thrust(late), 0.0);
    put("tight tension", brief.tight, late.tight, 0.0);
    put("slack tension", brief.slack, late.slack, min_share_of_tight * late.tight);
    put("slip", brief.slip, late.slip, min_slip);
    put("slip by friction", brief.friction_slip, late.friction_slip, min_slip);
    put("losses", brief.lost, late.lost, 0.0);
}

void settle_and_run(const Scene& scene, const LotteryRules& rules, LongerTicket& ticket) {
    Simulation simulation(scene, Schedule{});
    BothMeans means(simulation.workspace().variator, rules.duration, 0.5 * rules.longer * rules.duration);
    const engine::Cancellation never;
    Fault fault = simulation.advance({.until = 0.0}, means, never);
    means.brief.clear();
    if (!fault) fault = simulation.advance({.until = rules.duration}, means, never);
    ticket.status = fault ? fault.name() : "finished";
    if (fault) return;
    name_notes(means.brief, simulation.workspace().energy.balance(), ticket.notes);
    fault = simulation.advance({.until = rules.longer * rules.duration}, means, never);
    ticket.later = fault ? fault.name() : "";
    if (!fault) compare_means(means.brief.all(), means.late.all(), ticket);
}

[[nodiscard]] LongerTicket play_machine(std::uint64_t seed, long number, const LotteryRules& rules) {
    const auto began = std::chrono::steady_clock::now();
    LongerTicket ticket;
    ticket.number = number;
    try {
        settle_and_run(lottery_scene(seed, number, rules), rules, ticket);
    } catch (const std::exception& error) {
        ticket.status = std::string("refused: ") + error.what();
    }
    ticket.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return ticket;
}

}  // namespace

std::vector<LongerTicket> play_longer(std::uint64_t seed, long first, long count, int threads, const LotteryRules& rules) {
    std::vector<LongerTicket> tickets(static_cast<std::size_t>(count));
    long next = 0;
    engine::run_jobs(
        threads, false, [&](int) { return next < count ? std::optional(next++) : std::nullopt; },
        [&](int, long k) { tickets[static_cast<std::size_t>(k)] = play_machine(seed, first + k, rules); });
    return tickets;
}

}  // namespace cvtflow::bench
