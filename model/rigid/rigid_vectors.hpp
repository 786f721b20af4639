#pragma once
/// Plane vectors of pins side by side, how columns are read and written, sums over pins, friction of a contact, and linear equations around
/// the ring of links. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "model/basis/lanes.hpp"
#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_kernels.hpp"

namespace cvtflow::model {

namespace {

using PinLanes = Lanes<rigid_lanes>;

/// Numbers of tips in a step: floats, after differences of places and velocities in doubles. Twice as many pins side by side, as each waits
/// for roots and divisions most of the time.
inline constexpr int rigid_singles = singles<2 * rigid_lanes>;

template <int W>
struct PlaneOf {
    Lanes<W> x, y;
    friend PlaneOf operator+(const PlaneOf& a, const PlaneOf& b) noexcept { return {a.x + b.x, a.y + b.y}; }
    friend PlaneOf operator-(const PlaneOf& a, const PlaneOf& b) noexcept { return {a.x - b.x, a.y - b.y}; }
    friend PlaneOf operator*(const Lanes<W>& f, const PlaneOf& a) noexcept { return {f * a.x, f * a.y}; }
    friend Lanes<W> dot(const PlaneOf& a, const PlaneOf& b) noexcept { return a.x * b.x + a.y * b.y; }
    /// z component of the cross product.
    friend Lanes<W> cross(const PlaneOf& a, const PlaneOf& b) noexcept { return a.x * b.y - a.y * b.x; }
    /// k×a
    friend PlaneOf turned(const PlaneOf& a) noexcept { return {-a.y, a.x}; }
};
using Plane = PlaneOf<rigid_lanes>;

/// As many doubles as a width has numbers.
template <int W>
using DoublesOf = Lanes<lane_count<W>>;
template <int W>
using DoublePlaneOf = PlaneOf<lane_count<W>>;

/// Doubles as numbers of a width.
template <int W>
[[nodiscard, gnu::always_inline]] inline Lanes<W> convert(const DoublesOf<W>& v) noexcept {
    if constexpr (is_single<W>) {
        return narrow<lane_count<W>>(v);
    } else {
        return v;
    }
}
template <int W>
[[nodiscard, gnu::always_inline]] inline PlaneOf<W> convert(const DoublePlaneOf<W>& v) noexcept {
    return {convert<W>(v.x), convert<W>(v.y)};
}
/// Numbers of a width as doubles.
template <int W>
[[nodiscard, gnu::always_inline]] inline DoublesOf<W> widened(const Lanes<W>& v) noexcept {
    if constexpr (is_single<W>) {
        return widen<lane_count<W>>(v);
    } else {
        return v;
    }
}

/// Entries i … i + 7 of a column.
template <class C>
[[nodiscard, gnu::always_inline]] inline PinLanes read(const C& columns, Column c, int i) noexcept {
    return load<rigid_lanes>(columns[c] + i);
}
/// A column and the one behind it.
template <class C>
[[nodiscard, gnu::always_inline]] inline Plane read_plane(const C& columns, Column c, int i) noexcept {
    return {read(columns, c, i), read(columns, c + 1, i)};
}
template <class C>
[[gnu::always_inline]] inline void write(C& columns, Column c, int i, const PinLanes& value) noexcept {
    value.copy_to(columns[c] + i);
}
template <class C>
[[gnu::always_inline]] inline void write_plane(C& columns, Column c, int i, const Plane& value) noexcept {
    write(columns, c, i, value.x);
    write(columns, c + 1, i, value.y);
}

/// Lanes from, from + 1, … of two vectors behind each other, 0 < from < W.
template <int from, int W = rigid_lanes>
[[nodiscard, gnu::always_inline]] inline Lanes<W> lanes_across(const Lanes<W>& first, const Lanes<W>& second) noexcept {
    if constexpr (native_lanes == W) {
        return slide<W, from>(first, second);
    } else if constexpr (2 * native_lanes == W) {
        constexpr int within = from % native_lanes;
        if constexpr (from < native_lanes)
            return {slide<native_lanes, within>(first.low, first.high), slide<native_lanes, within>(first.high, second.low)};
        else
            return {slide<native_lanes, within>(first.high, second.low), slide<native_lanes, within>(second.low, second.high)};
    } else {
        alignas(64) double both[2 * W];
        first.copy_to(both);
        second.copy_to(both + W);
        return load<W>(both + from);
    }
}

/// Vectors of pins i - 1 … i + 6, given those of pins i - 8 … i - 1 and i … i + 7.
[[nodiscard, gnu::always_inline]] inline Plane shifted_by_one_pin(const Plane& before, const Plane& now) noexcept {
    return {lanes_across<rigid_lanes - 1>(before.x, now.x), lanes_across<rigid_lanes - 1>(before.y, now.y)};
}

/// Power that a damping force takes away, and the force into its column. A force acts over a step, and the velocity that begins it is
/// the one that ended the step before: its share of the work is the mean of both steps' forces times it.
template <class C>
[[nodiscard, gnu::always_inline]] inline PinLanes drag_power(const RigidKick& kick, C& columns, Column c, int i, const PinLanes& force,
                                                             const PinLanes& rate) noexcept {
    const PinLanes acting = kick.implicit() ? 0.5 * (force + read(columns, c, i)) : force;
    write(columns, c, i, force);
    return acting * rate;
}

/// 1 for the first lanes, 0 for the others.
[[nodiscard, gnu::always_inline]] inline PinLanes first_lanes(int count) noexcept {
    static constexpr std::array<double, 2 * rigid_lanes> ones_and_zeros{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    return load<rigid_lanes>(ones_and_zeros.data() + (rigid_lanes - count));
}

/// 1 for pins first … first + 7, 0 for those that only fill the last vector.
[[nodiscard, gnu::always_inline]] inline PinLanes present(int pins, int first) noexcept {
    return first_lanes(std::min(rigid_lanes, pins - first));
}

/// A sum over pins, without those that only fill the last vector.
class PinSum {
public:
    template <class C>
    explicit PinSum(const C& columns) noexcept : pins_(columns.pins()) {}
    [[gnu::always_inline]] void add(int first, const PinLanes& terms) noexcept { add(present(pins_, first), terms); }
    [[gnu::always_inline]] void add(const PinLanes& present, const PinLanes& terms) noexcept { total_ += present * terms; }
    [[nodiscard]] double value() const noexcept { return sum<rigid_lanes>(total_); }

private:
    int pins_;
    PinLanes total_{0.0};
};

/// Sums over pins of what their tips do to the four sheaves.
template <int W>
class ReactionSum {
public:
    using Sides = std::array<std::array<Lanes<W>, 6>, 2>;
    ReactionSum() noexcept {
        for (Sides& sides : on_) sides[0].fill(Lanes<W>(0.0)), sides[1].fill(Lanes<W>(0.0));
    }
    /// @param second 1 for pins that belong to the driven shaft   @param present 0 for pins that only fill the last vector
    /// @param forces of each side's tips on the pins: the opposite of those on the sheaves
    [[gnu::always_inline]] void subtract(const Lanes<W>& second, const Lanes<W>& present, const Sides& forces) noexcept {
        const Lanes<W> here = present * second;
        subtract(present - here, forces, on_[0]);
        subtract(here, forces, on_[1]);
    }
    void store(SheaveForces& to) const noexcept {
        for (std::size_t sheave = 0; sheave < 4; ++sheave) {
            std::array<DoublesOf<W>, 6> wide;
            for (std::size_t k = 0; k < 6; ++k) wide[k] = widened<W>(on_[sheave / 2][sheave % 2][k]);
            sums<lane_count<W>, 6>(wide, to[sheave].data());
        }
    }

private:
    [[gnu::always_inline]] static void subtract(const Lanes<W>& share, const Sides& forces, Sides& from) noexcept {
        if (all_at_most<W>(share, 0.0)) return;
        for (std::size_t side = 0; side < 2; ++side) {
            for (std::size_t k = 0; k < 6; ++k) from[side][k] -= share * forces[side][k];
        }
    }
    std::array<Sides, 2> on_;
};

/// Sliding speed v that solves v + r C s(v) = w, with the law's share s: the contact slides by w without friction, and friction C s slows
/// it by r C s. The left side is concave, so Newton's method climbs towards the solution from below.
template <int W>
[[nodiscard]] inline Lanes<W> sliding_speed(const FrictionCurve& curve, const Lanes<W>& braking, const Lanes<W>& speed) noexcept {
    Lanes<W> v = larger<W>(speed - braking, speed / (1.0 + curve.inverse_saturation_speed * braking));
    for (int iteration = 0; iteration < 3; ++iteration) {
        const Lanes<W> excess = v + braking * friction_share<W>(curve, v) - speed;
        v -= excess / (1.0 + braking * slip_tangent<W>(curve, v));
    }
    return positive_part<W>(v);
}

/// Friction per free sliding velocity, so that F = -factor u.
/// @param capacity C = μ N, most friction [N]   @param response r of the sliding velocity to friction [m/s/N]
/// @param speed |u| of the velocity without friction [m/s]
template <int W>
[[nodiscard]] inline Lanes<W> friction_factor(const FrictionCurve& curve, const Lanes<W>& capacity, const Lanes<W>& response,
                                              const Lanes<W>& speed) noexcept {
    const Lanes<W> braking = response * capacity;
    if (curve.law == FrictionLaw::piecewise) {  // the speed is known: D = max(|u| - r C, v0)
        return capacity / larger<W>(speed, curve.saturation_speed + braking);
    }
    const Lanes<W> secant = slip_factor<W>(curve, sliding_speed<W>(curve, braking, speed));
    return capacity * secant / (1.0 + braking * secant);
}

/// How the links of the chain are shared out over lanes: lane L has links begin(L) … begin(L + 1) - 1, in the last of its rows; rows in
/// front of them are absent. A chain of fewer than 8 links is repeated, which does not change the solution.
struct RingShares {
    int pins, links, rows;

    explicit RingShares(int pins_of_chain) noexcept
        : pins(pins_of_chain),
          links(pins >= rigid_lanes ? pins : (rigid_lanes + pins - 1) / pins * pins),
          rows(std::max(2, (links + rigid_lanes - 1) / rigid_lanes)) {}

    [[nodiscard]] int begin(int lane) const noexcept { return links * lane / rigid_lanes; }
    [[nodiscard]] int absent(int lane) const noexcept { return rows - (begin(lane + 1) - begin(lane)); }
    /// Calls visit(place in the rows, link). In a chain that is repeated, links after the last one are copies in the columns.
    template <class Visit>
    void for_links(const Visit& visit) const noexcept {
        for (int lane = 0; lane < rigid_lanes; ++lane) {
            const int skipped = absent(lane), first = begin(lane) - skipped;
            for (int row = skipped; row < rows; ++row) visit(row * rigid_lanes + lane, first + row);
        }
    }
    [[nodiscard]] PinLanes absent_rows() const noexcept {
        PinLanes all;
        for (int lane = 0; lane < rigid_lanes; ++lane) all.set(static_cast<std::size_t>(lane), absent(lane));
        return all;
    }
};

/// Lane L + by of a vector, around the ring of lanes.
template <int by, int W = rigid_lanes>
[[nodiscard]] inline Lanes<W> neighbour(const Lanes<W>& lanes) noexcept {
    return lanes_across<(by + W) % W>(lanes, lanes);
}

/// x_L = free + behind x_{L-by} + ahead x_{L+by}: one unknown per lane.
struct LaneRing {
    PinLanes free, behind, ahead;

    /// The ring of lanes at twice the distance.
    template <int by>
    [[nodiscard]] LaneRing halved() const noexcept {
        const PinLanes to = neighbour<-by>(ahead), from = neighbour<by>(behind);
        const PinLanes inverse = 1.0 / (1.0 - behind * to - ahead * from);
        return {(free + behind * neighbour<-by>(free) + ahead * neighbour<by>(free)) * inverse, behind * neighbour<-by>(behind) * inverse,
                ahead * neighbour<by>(ahead) * inverse};
    }
    [[nodiscard]] PinLanes solution() const noexcept {
        static_assert(rigid_lanes == 8);
        const LaneRing opposite = halved<1>().halved<2>();  // both neighbours are the same lane
        const PinLanes both = opposite.behind + opposite.ahead;
        return (opposite.free + both * neighbour<4>(opposite.free)) / (1.0 - both * neighbour<4>(both));
    }
};

/// x of all links, (1 + excess_i) x_i - rear_i x_{i-1} - front_i x_{i+1} = rhs_i around the ring, however much one link depends on others
/// far away. Each lane eliminates its links but the last, x_r = free + behind x_{last of the lane before} + ahead x_{r+1}; the remaining
/// system has one unknown per lane.
class LinkRing {
public:
    explicit LinkRing(RigidColumns& columns) noexcept
        : shares_(columns.pins()), columns_(columns), last_((shares_.rows - 1) * rigid_lanes) {}

    void solve(Column excess, Column rear, Column front, Column rhs, Column solution) noexcept {
        gather(excess, Column::ring_excess);
        gather(rear, Column::ring_rear);
        gather(front, Column::ring_front);
        gather(rhs, Column::ring_rhs);
        eliminate();
        substitute();
        double* to = columns_[solution];
        const double* from = columns_[Column::ring_solution];
        shares_.for_links([&](int place, int link) { to[link] = from[place]; });
    }

private:
    [[nodiscard]] PinLanes get(Column c, int at) const noexcept { return read(columns_, c, at); }
    void put(Column c, int at, const PinLanes& value) noexcept { write(columns_, c, at, value); }
    void gather(Column of, Column to) noexcept {
        double* rows = columns_[to];
        const double* from = columns_[of];
        shares_.for_links([&](int place, int link) { rows[place] = from[link]; });
    }
    /// Rows x = free + behind x_{last of the lane before} + ahead x_{next row}; first_…: x of a lane's first link by x of both last ones.
    void eliminate() noexcept {
        const PinLanes absent = shares_.absent_rows(), none(0.0);
        PinLanes free(0.0), behind(1.0), ahead(0.0), first_free(0.0), first_behind(0.0), first_ahead(1.0);
        int row = 0;
        for (int at = 0; at < last_; at += rigid_lanes, ++row) {
            const PinLanes back = get(Column::ring_rear, at), number(row);
            const PinLanes inverse = 1.0 / ((1.0 + get(Column::ring_excess, at)) - back * ahead);  // each row waits for this
            free = (get(Column::ring_rhs, at) + back * free) * inverse;
            behind = select_greater<rigid_lanes>(absent, number, behind, back * behind * inverse);
            ahead = get(Column::ring_front, at) * inverse;
            first_free += first_ahead * free;
            first_behind += select_greater<rigid_lanes>(absent, number, none, first_ahead * behind);
            first_ahead = select_greater<rigid_lanes>(absent, number, first_ahead, first_ahead * ahead);
            put(Column::ring_solution, at, free);
            put(Column::ring_lower, at, behind);
            put(Column::ring_upper, at, ahead);
        }
        const PinLanes back = get(Column::ring_rear, last_), on = get(Column::ring_front, last_);
        const PinLanes inverse = 1.0 / ((1.0 + get(Column::ring_excess, last_)) - back * ahead - on * neighbour<1>(first_behind));
        put(Column::ring_solution, last_,
            LaneRing{(get(Column::ring_rhs, last_) + back * free + on * neighbour<1>(first_free)) * inverse, back * behind * inverse,
                     on * neighbour<1>(first_ahead) * inverse}
                .solution());
    }
    void substitute() noexcept {
        PinLanes solution = get(Column::ring_solution, last_);
        const PinLanes before = neighbour<-1>(solution);
        for (int at = last_ - rigid_lanes; at >= 0; at -= rigid_lanes) {
            solution = get(Column::ring_solution, at) + get(Column::ring_lower, at) * before + get(Column::ring_upper, at) * solution;
            put(Column::ring_solution, at, solution);
        }
    }

    const RingShares shares_;
    const RigidView columns_;
    const int last_;  ///< where the last row begins
};

/// Unknowns x_i = free_i + behind_i x_{i-1} + ahead_i x_{i+1} around the ring of links, for couplings that fade within a few links: each
/// level puts the equations of both neighbours into a link's own, so that it depends on links twice as far away. Links more than 16 away
/// are left out. Factors of 1/4 have become 4e-10 there, those of 0.36 1e-6. In floats, of several systems side by side, in memory of the
/// caller's.
class FadingRing {
public:
    static constexpr int W = rigid_singles, levels = 4, reach = 1 << (levels - 1);
    using V = Lanes<W>;

    [[nodiscard]] static std::size_t bytes(int pins, int systems) noexcept {
        return static_cast<std::size_t>(systems * arrays * stride_of(pins)) * sizeof(float);
    }
    /// @param memory [bytes()], of zeros at first, on a cache line
    FadingRing(int pins, std::byte* memory) noexcept : pins_(pins), stride_(stride_of(pins)), values_(reinterpret_cast<float*>(memory)) {}

    // Where a system's factors and free parts are to be written, entry i that of link i; then eliminate() and solve().
    [[nodiscard]] float* behind(int system) noexcept { return array(system, 0); }
    [[nodiscard]] float* ahead(int system) noexcept { return array(system, 2); }
    [[nodiscard]] float* free(int system) noexcept { return array(system, 4); }

    void eliminate(int system) noexcept {
        wrap(behind(system));
        wrap(ahead(system));
        eliminate_level<0>(system);
    }
    /// @return where the unknowns are
    [[nodiscard]] const float* solve(int system) noexcept {
        for (int level = 0, distance = 1; level < levels; ++level, distance *= 2) {
            float *from = array(system, 4 + level % 2), *to = array(system, 5 - level % 2);
            wrap(from);
            const float *own = factors(system, level, 0), *rear = factors(system, level, 1), *front = factors(system, level, 2);
            for (int i = 0; i < pins_; i += lanes) {
                const V x = load<W>(own + i) * load<W>(from + i) + load<W>(rear + i) * load<W>(from + i - distance) +
                            load<W>(front + i) * load<W>(from + i + distance);
                x.copy_to(to + i);
            }
        }
        return array(system, 4 + levels % 2);
    }

private:
    static constexpr int lanes = lane_count<W>, arrays = 6 + 3 * levels;

    [[nodiscard]] static int stride_of(int pins) noexcept { return (pins + lanes - 1) / lanes * lanes + 2 * lanes; }
    [[nodiscard]] float* array(int system, int number) noexcept { return values_ + ((system * arrays + number) * stride_ + lanes); }
    [[nodiscard]] float* factors(int system, int level, int which) noexcept { return array(system, 6 + 3 * level + which); }
    /// Copies of neighbours at both ends.
    void wrap(float* values) const noexcept {
        if (pins_ >= reach) {
            std::array<float, reach> first, last;  // copied at once, see RigidColumns::wrap()
            std::memcpy(first.data(), values, sizeof first);
            std::memcpy(last.data(), values + (pins_ - reach), sizeof last);
            std::memcpy(values + pins_, first.data(), sizeof first);
            std::memcpy(values - reach, last.data(), sizeof last);
        } else {
            for (int k = 0; k < reach; ++k) values[pins_ + k] = values[k];
            for (int k = 1; k <= reach; ++k) values[-k] = values[pins_ - k];
        }
    }
    /// 1/(1 - e) to e^8.
    [[nodiscard]] static V growth(const V& e) noexcept {
        const V square = e * e;
        return (1.0 + e) * ((1.0 + square) * (1.0 + square * square));
    }
    template <int level>
    void eliminate_level(int system) noexcept {
        constexpr int distance = 1 << level;
        const float *behind = array(system, level % 2), *ahead = array(system, 2 + level % 2);
        float *next_behind = array(system, 1 - level % 2), *next_ahead = array(system, 3 - level % 2);
        float *own = factors(system, level, 0), *rear = factors(system, level, 1), *front = factors(system, level, 2);
        for (int i = 0; i < pins_; i += lanes) {
            const V back = load<W>(behind + i), on = load<W>(ahead + i);
            const V echo = back * load<W>(ahead + i - distance) + on * load<W>(behind + i + distance);
            const V inverse = level == 0 ? 1.0 / (1.0 - echo) : growth(echo);
            const V from_rear = back * inverse, from_front = on * inverse;
            inverse.copy_to(own + i);
            from_rear.copy_to(rear + i);
            from_front.copy_to(front + i);
            (from_rear * load<W>(behind + i - distance)).copy_to(next_behind + i);
            (from_front * load<W>(ahead + i + distance)).copy_to(next_ahead + i);
        }
        if constexpr (level + 1 < levels) {
            wrap(next_behind);
            wrap(next_ahead);
            eliminate_level<level + 1>(system);
        }
    }

    const int pins_, stride_;
    float* const values_;
};

}  // namespace

}  // namespace cvtflow::model
