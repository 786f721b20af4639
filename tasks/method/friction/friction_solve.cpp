#include "tasks/method/friction/friction_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/basis/portable_math.hpp"

namespace cvtflow::tasks {

namespace {

/// Along the step the energy's slope must fall to this part of what it was.
constexpr double flat = 0.5;
constexpr int max_searches = 12;
/// Where in the bracket a share may lie.
constexpr double margin = 0.05;
/// Iterations after which saturation speeds are changed: by which factor upwards, and how far at most; by which at first downwards. A
/// stride that fails is repeated shorter and with twice the iterations.
constexpr int first_patience = 10, max_patience = 320;
constexpr double continuation_step = 10.0, max_continuation = 1e5, first_stride = 2.0, min_stride = 1.01;
/// A stride that took no more iterations than these is followed by a longer one.
constexpr int few_tries = 5;
constexpr double longer = 1.3;

}  // namespace

std::string text(const SolveStatistics& s) {
    const double solves = s.solves > 0 ? static_cast<double>(s.solves) : 1.0;
    std::string line = fmt::format("{:.2f} iterations per friction solve (max {}), {:.2f} searches",
                                   static_cast<double>(s.iterations) / solves, s.most, static_cast<double>(s.searches) / solves);
    if (s.continued > 0) line += fmt::format(", {} solves by continuation from higher saturation speeds", s.continued);
    if (s.unconverged > 0)
        line += fmt::format("; {} of {} solves did not converge and used the last iterate (residual up to {:.2g} m/s)", s.unconverged,
                            s.solves, s.worst);
    return line;
}

FrictionSolve::FrictionSolve(const Workspace& w)
    : space_(w.variator.chain(), w.parameters.detail.stick_slip),
      joints_(model::SlipStretches(w.layout().links), space_.contacts().joint_slips()) {
    for (int k = 0; k < stretches().length(); ++k) groups_.emplace_back(w.variator.chain(), stretches(), k);
}

double FrictionSolve::tolerance(double step) noexcept {
    const double share = std::min(step / usual_step, 1.0);
    return std::max(usual_tolerance * share * share, min_tolerance);
}

NextCycle FrictionSolve::begin(double step) noexcept {
    ++statistics_.solves;
    tolerance_ = tolerance(step);
    iterations_ = tries_ = 0;
    continuation_ = continuation_before_ = 1.0;
    solved_ = 0.0;
    stride_ = first_stride;
    patience_ = first_patience;
    keeps_ = returns_ = false;
    steps_ = searching_ = false;
    fraction_ = 1.0;
    return iterate_cycle;
}

NextCycle FrictionSolve::next() noexcept {
    double before = 0.0, after = 0.0;
    residual_ = 0.0;
    for (const model::SlipGroup& group : groups_) {
        before += group.slope_before;
        after += group.slope_after;
        if (!(group.residual <= residual_)) residual_ = group.residual;
    }
    if (!std::isfinite(residual_)) return NextCycle::failed();
    if (!searching_) {
        ++iterations_;
        ++tries_;
        continuation_before_ = continuation_;
        keeps_ = returns_ = false;
        low_ = searches_ = 0;
        high_ = 1.0;
        slope_low_ = before;
        slope_high_ = after;
    } else {
        (after > 0.0 ? high_ : low_) = fraction_;
        (after > 0.0 ? slope_high_ : slope_low_) = after;
    }
    // The first step starts from slips that belong to no forces: it is taken whole.
    const bool good = residual_ <= tolerance_ || (tries_ == 1 && !searching_) || std::abs(after) <= flat * std::abs(before) ||
                      (after <= 0.0 && !searching_);
    return good || searches_ >= max_searches ? accept() : judge();
}

/// The secant's zero of the slope within the bracket; every other time its middle: slopes have kinks, past which a secant creeps.
NextCycle FrictionSolve::judge() noexcept {
    const double width = high_ - low_;
    const double zero = searches_ % 2 == 0 ? low_ - slope_low_ * width / (slope_high_ - slope_low_) : low_ + 0.5 * width;
    fraction_ = std::clamp(zero, low_ + margin * width, high_ - margin * width);
    ++searches_;
    ++statistics_.searches;
    searching_ = true;
    return search_cycle;
}

NextCycle FrictionSolve::accept() noexcept {
    steps_ = true;
    searching_ = false;
    settled_ = std::exchange(fraction_, 1.0);
    const bool converged = residual_ <= tolerance_, ends = converged && continuation_ == 1.0;
    if (ends || iterations_ >= max_iterations) return finish(ends);
    if (converged) return lower_speeds();
    return tries_ < patience_ ? iterate_cycle : raise_speeds();
}

/// Continues a solution from higher saturation speeds to the given ones.
NextCycle FrictionSolve::lower_speeds() noexcept {
    if (solved_ > 0.0 && tries_ <= few_tries) stride_ = std::min(model::portable_pow(stride_, longer), continuation_step);
    solved_ = continuation_;
    continuation_ = std::max(continuation_ / stride_, 1.0);
    keeps_ = true;
    patience_ = first_patience;
    tries_ = 0;
    return iterate_cycle;
}

/// No solution was found: to higher saturation speeds, or back to the last solution and on from there by a shorter stride.
NextCycle FrictionSolve::raise_speeds() noexcept {
    tries_ = 0;
    if (solved_ == 0.0) {
        continuation_ = std::min(continuation_step * continuation_, max_continuation);
        return iterate_cycle;
    }
    stride_ = std::max(std::sqrt(stride_), min_stride);
    patience_ = std::min(2 * patience_, max_patience);
    continuation_ = std::max(solved_ / stride_, 1.0);
    continuation_before_ = solved_;
    returns_ = true;
    return iterate_cycle;
}

NextCycle FrictionSolve::finish(bool converged) noexcept {
    statistics_.iterations += iterations_;
    statistics_.most = std::max<long>(statistics_.most, iterations_);
    if (solved_ > 0.0) ++statistics_.continued;
    for (model::SlipGroup& group : groups_) group.continuation = 1.0;
    if (!converged) {
        ++statistics_.unconverged;
        statistics_.worst = std::max(statistics_.worst, residual_);
    }
    return NextCycle::done();
}

void FrictionSolve::settle(int number) noexcept {
    if (!steps_) return;
    model::SlipGroup& g = group(number);
    if (settled_ == 1.0) {
        std::swap(g.slip, g.next_slip);
        std::swap(g.force, g.next_force);
        return;
    }
    for (int row = 0; row < space_.contacts().slips(); ++row) {
        for (int lane = 0; lane < model::slip_lanes; ++lane) {
            g.slip.at(row)[lane] += settled_ * (g.next_slip.at(row)[lane] - g.slip.at(row)[lane]);
            g.force.at(row)[lane] += settled_ * (g.next_force.at(row)[lane] - g.force.at(row)[lane]);
        }
    }
}

/// Where a contact sticks and its saturation speed changes, its slip changes with it, so that its force stays what it is.
void FrictionSolve::keep_forces(int number) noexcept {
    model::SlipGroup& g = group(number);
    const model::Coefficients& c = space_.chain().coefficients();
    const double ratio = continuation_ / continuation_before_;
    for (int contact = 0; contact < space_.contacts().count(); ++contact) {
        const bool joint = contact >= model::SlipContacts::first_joint;
        const model::FrictionCurve& curve = joint                                    ? c.joint.friction
                                            : contact == model::SlipContacts::plates ? c.plate_friction
                                                                                     : space_.tip_curve();
        const double stuck = continuation_before_ * curve.saturation_speed;
        for (int lane = 0; lane < model::slip_lanes; ++lane) {
            double &first = g.slip.at(2 * contact)[lane], &second = g.slip.at(2 * contact + 1)[lane];
            if (first * first + second * second > stuck * stuck) continue;
            first *= ratio;
            second *= ratio;
        }
    }
}

void FrictionSolve::change_speeds(int number) noexcept {
    model::SlipGroup& g = group(number);
    const int numbers = space_.contacts().slips() * model::slip_lanes;
    if (keeps_) std::copy_n(g.slip.at(0), numbers, g.solved_slip.at(0));
    if (returns_) std::copy_n(g.solved_slip.at(0), numbers, g.slip.at(0));
    if (continuation_ != continuation_before_) keep_forces(number);
    g.continuation = continuation_;
}

void FrictionSolve::eliminate(int number) noexcept {
    settle(number);
    change_speeds(number);
    space_.eliminate(group(number));
}

void FrictionSolve::substitute(int number) noexcept {
    space_.substitute(joints_.unknowns.at(number * space_.contacts().joint_slips()), group(number));
}

void FrictionSolve::search(int number) noexcept {
    if (!searching_) assemble(number, group(number).next_slip);
    space_.search(fraction_, group(number));
}

void FrictionSolve::assemble(int number, model::LaneRows& slips, model::LaneRows model::SlipGroup::*parts) noexcept {
    const model::SlipContacts& contacts = space_.contacts();
    const int size = contacts.joint_slips(), rear = 2 * contacts.joint(model::End::rear, 0), front = rear + size;
    const model::LaneRows& own = group(number).*parts;
    std::copy_n(own.at(0), model::slip_lanes * model::SlipContacts::local_slips, slips.at(0));
    const double *before[model::slip_lanes], *after[model::slip_lanes];  // the neighbours' first rows
    for (int lane = 0; lane < model::slip_lanes; ++lane) {
        const int stretch = std::min(lane, stretches().count() - 1);
        const model::SlipStretches::Place rearward = stretches().before({number, stretch}), forward = stretches().after({number, stretch});
        before[lane] = (group(rearward.group).*parts).at(front) + rearward.lane;
        after[lane] = (group(forward.group).*parts).at(rear) + forward.lane;
    }
    for (int k = 0; k < size; ++k) {
        const double *own_rear = own.at(rear + k), *own_front = own.at(front + k);
        double *at_rear = slips.at(rear + k), *at_front = slips.at(front + k);
        for (int lane = 0; lane < model::slip_lanes; ++lane) {
            at_rear[lane] = own_rear[lane] + before[lane][k * model::slip_lanes];
            at_front[lane] = after[lane][k * model::slip_lanes] + own_front[lane];
        }
    }
}

}  // namespace cvtflow::tasks
