#include "bench/method/implicit/coloured_jacobian.hpp"

#include <algorithm>

namespace cvtflow::bench {

namespace {

using bench::AccelerationJacobian;
using bench::Near;
using bench::With;

[[nodiscard]] bool touches(const BasePoint& base, int link) noexcept {
    const model::Phase* phases = base.phases + model::tips_per_link * link;
    return std::any_of(phases, phases + model::tips_per_link, [](model::Phase phase) { return phase != model::Phase::free; });
}

/// Rate of change of a link's reactions on its two sheaves.
void add_rate(const model::LinkLoad& above, const model::LinkLoad& below, double step, model::SheaveForces& rate) noexcept {
    for (int side = 0; side < 2; ++side) {
        const model::SheaveLoad &a = above.load, &b = below.load;
        rate[static_cast<std::size_t>(2 * below.shaft + side)] = {(a.fx[side] - b.fx[side]) / step, (a.fy[side] - b.fy[side]) / step,
                                                                  (a.mx[side] - b.mx[side]) / step, (a.my[side] - b.my[side]) / step,
                                                                  (a.fz[side] - b.fz[side]) / step, (a.mz[side] - b.mz[side]) / step};
    }
}

}  // namespace

ColouredJacobian::Scratch::Scratch(const model::ChainLayout& layout)
    : evaluation(layout),
      slope(static_cast<std::size_t>(layout.size())),
      tail(static_cast<std::size_t>(layout.size() - layout.pulley_begin())),
      zero(static_cast<std::size_t>(2 * layout.pulley_size)),
      reaction(zero) {}

ColouredJacobian::ColouredJacobian(const model::Variator& variator, int batches)
    : variator_(variator),
      layout_(variator.layout()),
      colours_(layout_.links < 3 ? layout_.links : 3 + layout_.links % 3),
      scratch_(static_cast<std::size_t>(batches), Scratch(layout_)) {}

/// Links beyond the last multiple of three have colours of their own.
int ColouredJacobian::colour(int link) const noexcept {
    const int regular = layout_.links < 3 ? 0 : layout_.links - layout_.links % 3;
    return link < regular ? link % 3 : colours_ - (layout_.links - link);
}

void ColouredJacobian::evaluate(int batch, const BasePoint& base, AccelerationJacobian& out) noexcept {
    Scratch& own = scratch_[static_cast<std::size_t>(batch)];
    model::fill_window(variator_, base.state, own.evaluation);
    std::copy_n(base.state + layout_.pulley_begin(), own.tail.size(), own.tail.begin());
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(groups()) * k / batches()); };
    for (int group = cut(batch); group < cut(batch + 1); ++group) {
        if (group < chain_groups()) {
            if (layout_.pulley_size != 0) variator_.pulleys().motions(base.state + layout_.pulley_begin(), own.evaluation.sheaves);
            chain_group(group, base, own, out);
        } else {
            pulley_group(group - chain_groups(), base, own, out);
        }
    }
}

/// Adds a step to one coordinate of every link of a colour in the window, which contains the first and the last link twice.
void ColouredJacobian::move_colour(int which, int offset, double step, const BasePoint& base, Scratch& own) const noexcept {
    for (int place = 0; place < layout_.links + 2; ++place) {
        const int link = (place + layout_.links - 1) % layout_.links;
        if (colour(link) == which)
            own.evaluation.window[static_cast<std::size_t>(place * layout_.link_block() + offset)] =
                base.state[layout_.link_begin(link) + offset] + step;
    }
}

/// Column of the pulleys' rows that one coordinate of a link fills through its reactions.
void ColouredJacobian::reaction_column(int link, int column, With with, double step, const BasePoint& base, Scratch& own,
                                       AccelerationJacobian& out) const noexcept {
    double* rows = out.rows(link, with);
    const int size = layout_.link_size();
    if (!touches(base, link)) {
        for (int row = 0; row < out.border(); ++row) rows[row * size + column] = 0.0;
        return;
    }
    model::SheaveForces rate{};
    add_rate(own.evaluation.loads[static_cast<std::size_t>(link)], base.loads[link], step, rate);
    variator_.pulleys().slope(own.zero.data(), model::Inputs{}, rate, own.reaction.data(), nullptr);
    for (int row = 0; row < layout_.pulley_size; ++row)
        rows[row * size + column] = own.reaction[static_cast<std::size_t>(layout_.pulley_size + row)];
}

void ColouredJacobian::chain_group(int group, const BasePoint& base, Scratch& own, AccelerationJacobian& out) const noexcept {
    const int size = layout_.link_size();
    const int which = group / (2 * size), offset = group % (2 * size), column = offset % size;
    const With with = offset < size ? With::position : With::velocity;
    const double step = with == With::position ? position_step : velocity_step;
    move_colour(which, offset, step, base, own);
    variator_.chain().slopes({0, layout_.links, own.evaluation.window.data(), own.evaluation.sheaves, base.phases}, own.slope.data(),
                             own.evaluation.loads.data());
    for (int link = 0; link < layout_.links; ++link) {
        if (colour(link) != which) continue;
        const double moved = base.state[layout_.link_begin(link) + offset];
        const double taken = (moved + step) - moved;
        const auto fill = [&](int of, Near near) {
            double* block = out.link(of, near, with);
            const int begin = layout_.link_begin(of) + size;
            for (int row = 0; row < size; ++row)
                block[row * size + column] = (own.slope[static_cast<std::size_t>(begin + row)] - base.slope[begin + row]) / taken;
        };
        fill(layout_.previous(link), Near::after);
        fill(link, Near::same);
        fill(layout_.next(link), Near::before);
        if (out.border() != 0) reaction_column(link, column, with, taken, base, own, out);
    }
    move_colour(which, offset, 0.0, base, own);
}

/// A pulley's coordinate or velocity, or the control integral, moves alone: the links that touch and the pulleys see it.
void ColouredJacobian::pulley_group(int index, const BasePoint& base, Scratch& own, AccelerationJacobian& out) const noexcept {
    const int size = layout_.link_size(), half = layout_.pulley_size, border = out.border();
    const With with = index < half ? With::position : With::velocity;
    const int column = index < half ? index : index - half;  // the integral follows the velocities
    const double step = with == With::position ? position_step : velocity_step;
    const double stood = base.state[layout_.pulley_begin() + index];
    own.tail[static_cast<std::size_t>(index)] = stood + step;
    const double taken = (stood + step) - stood;
    variator_.pulleys().motions(own.tail.data(), own.evaluation.sheaves);
    variator_.chain().slopes({0, layout_.links, own.evaluation.window.data(), own.evaluation.sheaves, base.phases}, own.slope.data(),
                             own.evaluation.loads.data());
    variator_.close(base.time, own.tail.data(), variator_.sheave_forces(base.phases, own.evaluation.loads.data()), base.accounts,
                    own.slope.data() + layout_.pulley_begin());
    own.tail[static_cast<std::size_t>(index)] = stood;
    const auto rate = [&](int at) { return (own.slope[static_cast<std::size_t>(at)] - base.slope[at]) / taken; };
    for (int link = 0; link < layout_.links; ++link) {
        double* columns = out.columns(link, with);
        for (int row = 0; row < size; ++row) columns[row * border + column] = rate(layout_.link_begin(link) + size + row);
    }
    for (int row = 0; row < border; ++row) out.corner(with)[row * border + column] = rate(layout_.pulley_begin() + half + row);
}

}  // namespace cvtflow::bench
