#pragma once
/// One pass over a range of whole pins: forces of links and tips on pins, joints as constraints. (model/EQUATIONS.md section 10)
///
///     states of pins first-3 … last+2 ─► lines and halves ─► links first-2 … last: forces on halves ─► moments on the links' directions
///                                                        └─► tips of pins first-1 … last ────────────┘ ─► forces on pins first … last-1

#include "model/kernels/chain_parts.hpp"
#include "model/kernels/lanes/lane_pass.hpp"
#include "model/kernels/pins/pin_tips.hpp"

namespace cvtflow::model {
namespace {

/// Where the results of a range go.
struct PinResults {
    double* slope;  ///< [unknowns, per second], nullptr: to the contacts
    LinkLoad* loads;
    Account* accounts;      ///< of the range's first pin on, only for observing passes
    LinkContact* contacts;  ///< likewise; nullptr: not needed
};

/// `own` counts pins from the range's first, `at` the columns of a chunk: pin_halo of them lie before its own pins.
/// @tparam Observe whether accounts are kept
template <int P, int W, bool Observe, class Contacts = NoContacts>
class PinPass {
public:
    using V = Lanes<W>;
    using Accounts = LaneAccounts<W>;
    static constexpr int size = pin_at<P>.link_size(), block = pin_at<P>.link_block();

    PinPass(const ChainModel& model, const Coefficients& coefficients, const ChainRange& range, const PinResults& results,
            const Contacts& contacts) noexcept
        : model_(model),
          c_(coefficients),
          range_(range),
          results_(results),
          contacts_(contacts),
          links_(model, coefficients, range, results.loads, contacts),
          motion_(coefficients.joint) {}

    void run() noexcept {
        const int pins = range_.last - range_.first, chunks = (pins + max_pins - 1) / max_pins;
        for (int chunk = 0; chunk < chunks; ++chunk) {
            first_ = pins * chunk / chunks;
            count_ = pins * (chunk + 1) / chunks - first_;
            run_chunk();
        }
    }

private:
    void run_chunk() noexcept {
        const int end = pin_halo + count_;
        motion_.read(range_.window + first_ * block, end + pin_halo);
        motion_.lines(0, end + 2);
        motion_.roll(1, end + 2);
        over_columns<W>(1, end + 1, [&](int at) { link(at); });
        over_columns<W>(2, end + 1, [&](int at) {
            tips(at);
            constrain(at);
        });
        over_columns<W>(2, end, [&](int at) { turn(at); });
        over_columns<W>(pin_halo, end, [&](int at) { finish(at); });
    }

    /// Pin of a column, counted from the range's first; its number in the chain.
    [[nodiscard]] int own(int at) const noexcept { return first_ + at - pin_halo; }
    [[nodiscard]] int number(int at) const noexcept { return model_.layout().wrapped(range_.first + own(at)); }
    [[nodiscard]] bool is_own(int at) const noexcept { return at >= pin_halo && at < pin_halo + count_; }

    /// Accounts of the pins at, … that are the range's own.
    void give(const Accounts& accounts, int at, AccountPart part) const noexcept {
        std::array<Account*, W> to{};
        for (int lane = 0; lane < W; ++lane) {
            if (is_own(at + lane))
                to[static_cast<std::size_t>(lane)] = results_.accounts + account_parts * own(at + lane) + static_cast<int>(part);
        }
        accounts.copy_to(to);
    }

    /// Destination of the loads of the pins at, …, if observed.
    [[nodiscard]] std::array<LinkContact*, W> contacts(int at) const noexcept {
        std::array<LinkContact*, W> to{};
        if (!Observe || results_.contacts == nullptr) return to;
        for (int lane = 0; lane < W; ++lane) {
            if (is_own(at + lane)) to[static_cast<std::size_t>(lane)] = results_.contacts + own(at + lane);
        }
        return to;
    }

    /// The plates' elastic tensions of the links behind the pins at, …; their tips are none yet.
    void note_tension(int at, const KindLanes<W>& kind, const LinkColumns<P, W>& columns) const noexcept {
        if (results_.contacts == nullptr) return;
        alignas(64) double tension[W];
        elastic_tension<P>(c_, kind, columns.q()).copy_to(tension);
        const auto to = contacts(at);
        for (std::size_t lane = 0; lane < W; ++lane) {
            if (to[lane] != nullptr) *to[lane] = {tension[lane], {}, {}, {}};
        }
    }

    /// Elasticity and plates of the links behind the pins at, …: forces on their halves.
    void link(int at) noexcept {
        LinkColumns<P, W> columns;
        motion_.link_columns(at, columns);
        std::array<V, model::at<P>.link_size()> f;
        f.fill(V(0.0));
        const KindLanes<W> kind = kinds(at);
        Accounts accounts;
        const V moment = inner_elasticity<P, Observe>(c_, kind, columns.frame, columns.q(), columns.v(), f.data(), &accounts);
        if constexpr (Observe) {
            links_.plates(kind, columns, f.data(), own(at), W, &accounts);
            give(accounts, at, AccountPart::link);
            note_tension(at, kind, columns);
        } else {
            links_.plates(kind, columns, f.data(), own(at), W);
        }
        if constexpr (Contacts::wanted) {
            const PitchLine<V> line = motion_.line(at);
            contacts_.frame(own(at), W, {line.along.x, line.along.y, line.inverse_length, line.turning});
        }
        add_moment<P>(columns.frame, moment, f.data());
        for (int row = 0; row < size; ++row) {
            forces_.put(rear_row + row, at, f[static_cast<std::size_t>(half_row(End::rear, row))]);
            forces_.put(front_row + row, at + 1, f[static_cast<std::size_t>(half_row(End::front, row))]);
        }
    }

    /// Row of a link's coordinates where coordinate `row` of the pin at one of its ends is.
    [[nodiscard]] static constexpr int half_row(End end, int row) noexcept {
        constexpr int n = P + 1;
        if (row < n) return model::at<P>.x(end, row);
        if (row < 2 * n) return model::at<P>.y(end, row - n);
        return model::at<P>.z(end) + row - 2 * n;
    }

    [[nodiscard]] KindLanes<W> kinds(int at) const noexcept {
        constexpr int numbers = sizeof(LinkKind) / sizeof(double);
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = reinterpret_cast<const double*>(&c_.kind(number(at + lane)));
        std::array<V, numbers> rows;
        load_rows<W, numbers>(from, rows.data());
        KindLanes<W> kinds;
        static_assert(sizeof kinds == sizeof rows);
        std::memcpy(static_cast<void*>(&kinds), rows.data(), sizeof kinds);
        return kinds;
    }

    void tips(int at) noexcept {
        alignas(4) Phase phases[tips_per_link * W];
        for (int lane = 0; lane < W; ++lane)
            std::memcpy(phases + tips_per_link * lane, range_.phases + tips_per_link * number(at + lane), tips_per_link);
        LinkColumns<P, W> columns;
        motion_.pin_as_link(at, columns);
        PinShare<P, W> share;
        LinkLoad loads[W];
        Accounts accounts;
        PinTips<P, W, Observe, Contacts>(c_, range_.sheaves, phases, own(at), contacts_)
            .share(columns, share, loads, accounts, contacts(at));
        if constexpr (Observe) give(accounts, at, AccountPart::tips);
        for (int row = 0; row < size; ++row) forces_.put(tip_row + row, at, share.force[static_cast<std::size_t>(row)]);
        forces_.put(tip_moment_row, at, share.moment);
        for (int lane = 0; lane < W; ++lane) {
            if (is_own(at + lane) && any_touching(phases + tips_per_link * lane)) results_.loads[own(at + lane)] = loads[lane];
        }
    }

    /// What the forces on the halves of a pin do to the angle between its links, and its resistance to rolling.
    void constrain(int at) noexcept {
        constexpr int y = pin_at<P>.y(End::rear, 0);
        const auto of = [&](int row) { return Plane<V>{get(row, at), get(row + y, at)}; };
        const Plane<V> g = V(0.5) * (of(front_row) - of(rear_row));
        forces_.put(constraint_row, at, motion_.derived(at, g));
        const V normal = positive_part<W>(-dot(g, motion_.bisector(at))), arm = c_.joint.rolling_arm * sqrt(normal);
        const V sliding = arm * motion_.bending(at);
        const V friction = c_.joint.friction.coefficient * normal * slip_factor<W>(c_.joint.friction, abs(sliding)) * sliding;
        forces_.put(rolling_row, at, V(arm * friction));
        if constexpr (Observe) {
            Accounts accounts;
            accounts.lose(Loss::joint_friction, friction * sliding);
            give(accounts, at, AccountPart::joint);
        }
    }

    /// Moments on the directions of the links behind the pins at, …: couples on the pins at their ends.
    void turn(int at) noexcept {
        const PitchLine<V> line = motion_.line(at);
        const Plane<V> both = forces_.template plane<W>(constraint_row, at) + forces_.template plane<W>(constraint_row, at + 1);
        const V moment = (line.along.x * both.y - line.along.y * both.x) + 0.5 * (get(tip_moment_row, at) + get(tip_moment_row, at + 1)) +
                         (get(rolling_row, at + 1) - get(rolling_row, at));
        const V couple = moment * line.inverse_length;
        forces_.put(couple_row, at, Plane<V>{-(couple * line.along.y), couple * line.along.x});
    }

    void finish(int at) noexcept {
        constexpr int y = pin_at<P>.y(End::rear, 0);
        std::array<V, size> f;
        for (int row = 0; row < size; ++row)
            f[static_cast<std::size_t>(row)] = get(rear_row + row, at) + get(front_row + row, at) + get(tip_row + row, at);
        const Plane<V> couple = forces_.template plane<W>(couple_row, at - 1) - forces_.template plane<W>(couple_row, at);
        f[0] += couple.x;
        f[y] += couple.y;
        accelerate_pins<P, W>(model_.inertia().lateral, model_.inertia().axial, f.data());
        if constexpr (Contacts::relative) {
            std::array<V, size> v;
            motion_.velocities(at, v.data());
            contacts_.template velocities<size>(own(at), std::min(W, count_ - (at - pin_halo)), v.data());
        }
        if constexpr (Contacts::wanted) {
            contacts_.accelerations(own(at), W, f.data(), size);
        } else {
            const int pins = std::min(W, count_ - (at - pin_halo));
            std::array<double*, W> to{};
            for (int lane = 0; lane < pins; ++lane) {
                double* slope = results_.slope + own(at + lane) * block;
                std::memcpy(slope, range_.window + (own(at + lane) + pin_halo) * block + size, size * sizeof(double));
                to[static_cast<std::size_t>(lane)] = slope + size;
            }
            store_rows<W, size>(f.data(), to, pins);
        }
    }

    [[nodiscard]] V get(int row, int at) const noexcept { return forces_.template get<W>(row, at); }

    static constexpr int rear_row = 0, front_row = size, tip_row = 2 * size, tip_moment_row = 3 * size, constraint_row = tip_moment_row + 1,
                         rolling_row = constraint_row + 2, couple_row = rolling_row + 1, rows = couple_row + 2;

    const ChainModel& model_;
    const Coefficients& c_;
    const ChainRange& range_;
    const PinResults& results_;
    const Contacts& contacts_;
    LanePass<P, W, Contacts> links_;
    PinMotion<P, W> motion_;
    PinRows<rows> forces_;
    int first_ = 0, count_ = 0;  ///< of the chunk
};

}  // namespace
}  // namespace cvtflow::model
