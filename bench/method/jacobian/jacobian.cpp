#include "bench/method/jacobian/jacobian.hpp"

#include <algorithm>
#include <optional>

#include "bench/method/jacobian/link_rows.hpp"
#include "model/basis/isa.hpp"

namespace cvtflow::bench {

AccelerationJacobian::AccelerationJacobian(const ChainLayout& layout)
    : links_(layout.links),
      size_(layout.link_size()),
      border_(layout.pulley_size + layout.controls),
      columns_begin_(6 * links_ * size_ * size_),
      rows_begin_(columns_begin_ + 2 * links_ * size_ * border_),
      corner_begin_(rows_begin_ + 2 * links_ * size_ * border_),
      numbers_(static_cast<std::size_t>(corner_begin_ + 2 * border_ * border_), 0.0) {}

namespace {

[[nodiscard]] bool touches(const Phase* phases) noexcept {
    return std::any_of(phases, phases + tips_per_link, [](Phase phase) { return phase != Phase::free; });
}

[[nodiscard]] DualFrame dual_frame(const double* state) noexcept {
    constexpr int n = link_layout.link_size(), xa = link_layout.x(End::rear, 0), ya = link_layout.y(End::rear, 0),
                  xb = link_layout.x(End::front, 0), yb = link_layout.y(End::front, 0);
    using T = Dual<4>;
    T q[link_layout.link_size()], v[link_layout.link_size()];  // of a link whose rear half is at the origin
    q[link_layout.x(End::front, 0)] = T::variable(state[xb] - state[xa], 0);
    q[link_layout.y(End::front, 0)] = T::variable(state[yb] - state[ya], 1);
    v[link_layout.x(End::front, 0)] = T::variable(state[n + xb] - state[n + xa], 2);
    v[link_layout.y(End::front, 0)] = T::variable(state[n + yb] - state[n + ya], 3);
    return link_frame(q, v);
}

/// Rows of a link, brought to the blocks of the Jacobian.
void store(const ExactJacobian& exact, LinkRows& rows, int link, std::optional<int> shaft, AccelerationJacobian& out) noexcept {
    constexpr int n = LinkRows::size;
    const int border = out.border();
    for (const With with : {With::position, With::velocity}) {
        for (int near = 0; near < 3; ++near) {
            double* block = out.link(link, static_cast<Near>(near), with);
            for (int r = 0; r < n; ++r) std::copy_n(rows.row(r) + LinkRows::column(near, with, 0), n, block + r * n);
        }
        std::fill_n(out.columns(link, with), n * border, 0.0);
    }
    if (!shaft) return;
    for (int side = 0; side < 2; ++side) {
        const auto& map = exact.sheave(2 * *shaft + side);
        for (int d = 0; d < sheave_directions; ++d) {
            const int coordinate = map.coordinate[static_cast<std::size_t>(d)];
            if (coordinate < 0) continue;
            double* columns = out.columns(link, d < sheave_positions ? With::position : With::velocity) + coordinate;
            for (int r = 0; r < n; ++r) columns[r * border] += rows.row(r)[LinkRows::sheave_column(side, d)];
        }
    }
}

void add_tips(const ExactJacobian& exact, const Coefficients& c, const double* state, const DualFrame& frame, const Phase* phases, int link,
              int shaft, const SheaveMotion* sheaves, LinkRows& rows, AccelerationJacobian& out, SheaveStiffness* stiffness) noexcept {
    for (int tip = 0; tip < tips_per_link; ++tip) {
        if (phases[tip] == Phase::free) continue;
        const int side = tip % 2, number = 2 * shaft + side;
        const TipRows effect(c, state, frame, sheaves[number], tip < 2 ? End::rear : End::front, side, phases[tip]);
        effect.add_to(rows);
        effect.add_to_sheave(exact.sheave(number), link, out, stiffness[side]);
    }
}

void link_jacobian(const ExactJacobian& exact, const Variator& variator, const double* state, const Phase* phases, int link,
                   AccelerationJacobian& out, SheaveStiffness* stiffness, const SheaveMotion* sheaves) noexcept {
    const Coefficients& c = variator.chain().coefficients();
    const ChainLayout& layout = variator.layout();
    const auto of = [&](int number) { return state + layout.link_begin(number); };
    const double *before = of(layout.previous(link)), *here = of(link), *after = of(layout.next(link));
    const DualFrame frame_before = dual_frame(before), frame = dual_frame(here), frame_after = dual_frame(after);
    LinkRows rows;
    add_inner(c, c.kind(link), here, rows);
    add_plates(c, c.kind(link), here, rows);
    const JointLinks rear{before, here, frame_before, frame, 0}, front{here, after, frame, frame_after, 1};
    JointRows(c, rear, true).add_to(rear, rows);
    JointRows(c, front, false).add_to(front, rows);
    for (const With with : {With::position, With::velocity}) std::fill_n(out.rows(link, with), LinkRows::size * out.border(), 0.0);
    stiffness[0] = stiffness[1] = {};
    const auto shaft = touches(phases) ? std::optional(variator.chain().shaft_of(here)) : std::nullopt;
    if (shaft) add_tips(exact, c, here, frame, phases, link, *shaft, sheaves, rows, out, stiffness);
    rows.fold_moment(frame);
    rows.accelerate(variator.chain().inertia());
    store(exact, rows, link, shaft, out);
}

}  // namespace

ExactJacobian::ExactJacobian(const Variator& variator)
    : variator_(variator),
      stiffness_(2 * static_cast<std::size_t>(variator.layout().links)),
      tail_(static_cast<std::size_t>(variator.layout().size() - variator.layout().pulley_begin())),
      above_(tail_),
      below_(tail_) {
    link_ = &link_jacobian;
    if (variator.layout().pulley_size != 0) find_maps();
}

/// Both maps are linear: found by unit motions and unit loads.
void ExactJacobian::find_maps() {
    const int half = variator_.layout().pulley_size;
    const PulleyModel& pulleys = variator_.pulleys();
    std::vector<double> block(static_cast<std::size_t>(2 * half), 0.0), slope(block);
    const auto motion = [](const SheaveMotion& s) {
        return std::array{s.x, s.y, s.z, s.tilt_x, s.tilt_y, s.vx, s.vy, s.vz, s.spin_x, s.spin_y, s.spin_z};
    };
    SheaveMotion rest[4], moved[4];
    pulleys.motions(block.data(), rest);
    for (SheaveMap& map : sheaves_) map.coordinate.fill(-1);
    for (int k = 0; k < 2 * half; ++k) {
        block[static_cast<std::size_t>(k)] = 1.0;
        pulleys.motions(block.data(), moved);
        block[static_cast<std::size_t>(k)] = 0.0;
        for (std::size_t s = 0; s < 4; ++s) {
            for (std::size_t d = 0; d < sheave_directions; ++d) {
                if (motion(moved[s])[d] != motion(rest[s])[d]) sheaves_[s].coordinate[d] = k % half;
            }
        }
    }
    for (std::size_t s = 0; s < 4; ++s) {
        for (std::size_t load = 0; load < 6; ++load) {
            SheaveForces unit{};
            unit[s][load] = 1.0;
            pulleys.slope(block.data(), Inputs{}, unit, slope.data(), nullptr);
            for (int k = 0; k < half; ++k) {
                if (const double factor = slope[static_cast<std::size_t>(half + k)]; factor != 0.0)
                    sheaves_[s].effects[load].push_back({k, factor});
            }
        }
    }
}

void ExactJacobian::links(const double* state, const Phase* phases, int first, int last, AccelerationJacobian& out) noexcept {
    SheaveMotion sheaves[4]{};
    if (variator_.layout().pulley_size != 0) variator_.pulleys().motions(state + variator_.layout().pulley_begin(), sheaves);
    for (int link = first; link < last; ++link)
        link_(*this, variator_, state, phases + tips_per_link * link, link, out, stiffness_.data() + 2 * link, sheaves);
}

/// Central differences of the pulleys alone: no chain force changes with them here.
void ExactJacobian::own_corner(double t, const double* state, AccelerationJacobian& out) noexcept {
    const ChainLayout& at = variator_.layout();
    const int half = at.pulley_size, border = out.border();
    const double* tail = state + at.pulley_begin();
    const auto rates = [&](std::vector<double>& slope) {
        const Inputs inputs = variator_.pulleys().inputs().at(t, tail_.data());
        variator_.pulleys().slope(tail_.data(), inputs, SheaveForces{}, slope.data(), nullptr);
        std::copy_n(inputs.control_rate.begin(), at.controls, slope.begin() + 2 * at.pulley_size);
    };
    std::copy_n(tail, tail_.size(), tail_.begin());
    for (int k = 0; k < half + border; ++k) {
        const With with = k < half ? With::position : With::velocity;
        const std::size_t moved = static_cast<std::size_t>(k);
        const double step = with == With::position ? 1e-8 : 1e-6;
        tail_[moved] = tail[k] + step;
        rates(above_);
        tail_[moved] = tail[k] - step;
        rates(below_);
        const double taken = (tail[k] + step) - (tail[k] - step);
        tail_[moved] = tail[k];
        double* column = out.corner(with) + (with == With::position ? k : k - half);
        for (int row = 0; row < border; ++row) {
            const std::size_t r = static_cast<std::size_t>(half + row);
            column[row * border] = (above_[r] - below_[r]) / taken;
        }
    }
}

void ExactJacobian::corner(double t, const double* state, const Phase* phases, AccelerationJacobian& out) noexcept {
    const ChainLayout& at = variator_.layout();
    if (at.pulley_size == 0) return;
    own_corner(t, state, out);
    for (int link = 0; link < at.links; ++link) {
        if (!touches(phases + tips_per_link * link)) continue;
        const int shaft = variator_.chain().shaft_of(state + at.link_begin(link));
        for (int side = 0; side < 2; ++side) {
            const SheaveMap& map = sheave(2 * shaft + side);
            const SheaveStiffness& stiffness = stiffness_[static_cast<std::size_t>(2 * link + side)];
            for (std::size_t d = 0; d < sheave_directions; ++d) {
                if (map.coordinate[d] < 0) continue;
                double* column = out.corner(d < sheave_positions ? With::position : With::velocity) + map.coordinate[d];
                for (std::size_t load = 0; load < 6; ++load) {
                    for (const auto& effect : map.effects[load])
                        column[effect.coordinate * out.border()] += effect.factor * stiffness[load][d];
                }
            }
        }
    }
}

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

/// Colour of a link; links beyond the last multiple of three have separate colours.
int ColouredJacobian::colour(int link) const noexcept {
    const int regular = layout_.links < 3 ? 0 : layout_.links - layout_.links % 3;
    return link < regular ? link % 3 : colours_ - (layout_.links - link);
}

void ColouredJacobian::evaluate(int batch, const BasePoint& base, AccelerationJacobian& out) noexcept {
    Scratch& room = scratch_[static_cast<std::size_t>(batch)];
    model::fill_window(variator_, base.state, room.evaluation);
    std::copy_n(base.state + layout_.pulley_begin(), room.tail.size(), room.tail.begin());
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(groups()) * k / batches()); };
    for (int group = cut(batch); group < cut(batch + 1); ++group) {
        if (group < chain_groups()) {
            if (layout_.pulley_size != 0) variator_.pulleys().motions(base.state + layout_.pulley_begin(), room.evaluation.sheaves);
            chain_group(group, base, room, out);
        } else {
            pulley_group(group - chain_groups(), base, room, out);
        }
    }
}

/// Adds a step to one coordinate of every link of a colour in the window, which contains the first and the last link twice.
void ColouredJacobian::move_colour(int which, int offset, double step, const BasePoint& base, Scratch& room) const noexcept {
    for (int place = 0; place < layout_.links + 2; ++place) {
        const int link = (place + layout_.links - 1) % layout_.links;
        if (colour(link) == which)
            room.evaluation.window[static_cast<std::size_t>(place * layout_.link_block() + offset)] =
                base.state[layout_.link_begin(link) + offset] + step;
    }
}

/// Column of the pulleys' rows that one coordinate of a link fills through its reactions.
void ColouredJacobian::reaction_column(int link, int column, With with, double step, const BasePoint& base, Scratch& room,
                                       AccelerationJacobian& out) const noexcept {
    double* rows = out.rows(link, with);
    const int size = layout_.link_size();
    if (!touches(base, link)) {
        for (int row = 0; row < out.border(); ++row) rows[row * size + column] = 0.0;
        return;
    }
    model::SheaveForces rate{};
    add_rate(room.evaluation.loads[static_cast<std::size_t>(link)], base.loads[link], step, rate);
    variator_.pulleys().slope(room.zero.data(), model::Inputs{}, rate, room.reaction.data(), nullptr);
    for (int row = 0; row < layout_.pulley_size; ++row)
        rows[row * size + column] = room.reaction[static_cast<std::size_t>(layout_.pulley_size + row)];
}

void ColouredJacobian::chain_group(int group, const BasePoint& base, Scratch& room, AccelerationJacobian& out) const noexcept {
    const int size = layout_.link_size();
    const int which = group / (2 * size), offset = group % (2 * size), column = offset % size;
    const With with = offset < size ? With::position : With::velocity;
    const double step = with == With::position ? position_step : velocity_step;
    move_colour(which, offset, step, base, room);
    variator_.chain().slopes({0, layout_.links, room.evaluation.window.data(), room.evaluation.sheaves, base.phases}, room.slope.data(),
                             room.evaluation.loads.data());
    for (int link = 0; link < layout_.links; ++link) {
        if (colour(link) != which) continue;
        const double moved = base.state[layout_.link_begin(link) + offset];
        const double taken = (moved + step) - moved;
        const auto fill = [&](int of, Near near) {
            double* block = out.link(of, near, with);
            const int begin = layout_.link_begin(of) + size;
            for (int row = 0; row < size; ++row)
                block[row * size + column] = (room.slope[static_cast<std::size_t>(begin + row)] - base.slope[begin + row]) / taken;
        };
        fill(layout_.previous(link), Near::after);
        fill(link, Near::same);
        fill(layout_.next(link), Near::before);
        if (out.border() != 0) reaction_column(link, column, with, taken, base, room, out);
    }
    move_colour(which, offset, 0.0, base, room);
}

/// A pulley's coordinate or velocity, or the control integral, moves alone: the touching links and the pulleys depend on it.
void ColouredJacobian::pulley_group(int index, const BasePoint& base, Scratch& room, AccelerationJacobian& out) const noexcept {
    const int size = layout_.link_size(), half = layout_.pulley_size, border = out.border();
    const With with = index < half ? With::position : With::velocity;
    const int column = index < half ? index : index - half;  // the integral follows the velocities
    const double step = with == With::position ? position_step : velocity_step;
    const double stood = base.state[layout_.pulley_begin() + index];
    room.tail[static_cast<std::size_t>(index)] = stood + step;
    const double taken = (stood + step) - stood;
    variator_.pulleys().motions(room.tail.data(), room.evaluation.sheaves);
    variator_.chain().slopes({0, layout_.links, room.evaluation.window.data(), room.evaluation.sheaves, base.phases}, room.slope.data(),
                             room.evaluation.loads.data());
    variator_.close(base.time, room.tail.data(), variator_.sheave_forces(base.phases, room.evaluation.loads.data()), base.accounts,
                    room.slope.data() + layout_.pulley_begin());
    room.tail[static_cast<std::size_t>(index)] = stood;
    const auto rate = [&](int at) { return (room.slope[static_cast<std::size_t>(at)] - base.slope[at]) / taken; };
    for (int link = 0; link < layout_.links; ++link) {
        double* columns = out.columns(link, with);
        for (int row = 0; row < size; ++row) columns[row * border + column] = rate(layout_.link_begin(link) + size + row);
    }
    for (int row = 0; row < border; ++row) out.corner(with)[row * border + column] = rate(layout_.pulley_begin() + half + row);
}

bool is_velocity(const ChainLayout& at, int index) noexcept {
    if (index < at.pulley_begin()) return index % at.link_block() >= at.link_size();
    return index >= at.pulley_begin() + at.pulley_size;
}

std::vector<double> difference_jacobian(const Variator& variator, double t, const std::vector<double>& state,
                                        const std::vector<Phase>& phases) {
    const ChainLayout& at = variator.layout();
    const std::size_t n = state.size();
    EvaluationScratch scratch(at);
    std::vector<double> moved = state;
    std::vector<double> above(n);
    std::vector<double> below(n);
    std::vector<double> matrix(n * n);
    for (std::size_t k = 0; k < n; ++k) {
        const double step = is_velocity(at, static_cast<int>(k)) ? 1e-6 : 1e-9;
        const double up = state[k] + step;
        const double down = state[k] - step;
        moved[k] = up;
        right_hand_side(variator, t, moved.data(), phases.data(), above.data(), scratch);
        moved[k] = down;
        right_hand_side(variator, t, moved.data(), phases.data(), below.data(), scratch);
        moved[k] = state[k];
        for (std::size_t row = 0; row < n; ++row) matrix[k * n + row] = (above[row] - below[row]) / (up - down);
    }
    return matrix;
}

}  // namespace cvtflow::bench
