/// Kernels of a chain of pin halves: slopes, observation (model/EQUATIONS.md section 9), depths of tips.

#include <algorithm>
#include <array>

#include "model/basis/native_lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/link_pass.hpp"

namespace cvtflow::model {
namespace {

/// Energies and losses of links side by side, in the order of Account.
template <int W>
struct LaneBooks {
    static constexpr bool observed = true;
    static constexpr std::size_t numbers = loss_kinds + energy_kinds;
    static_assert(sizeof(Account) == numbers * sizeof(double));

    std::array<Lanes<W>, numbers> rows;
    Lanes<W> tension{0.0};  ///< elastic tensions of plates [N]
    LaneBooks() noexcept { rows.fill(Lanes<W>(0.0)); }

    void lose(Loss kind, const Lanes<W>& watts) noexcept { rows[static_cast<std::size_t>(kind)] += watts; }
    void store(Energy kind, const Lanes<W>& joules, double factor = 1.0) noexcept {
        rows[loss_kinds + static_cast<std::size_t>(kind)] += factor * joules;
    }
};

/// Energy and losses of one contact, or of one point of it: of joints and of tips.
template <int W>
struct ContactBooks {
    static constexpr bool observed = true;
    static constexpr std::size_t numbers = 3;

    std::array<Lanes<W>, numbers> rows;  ///< energy, loss by damping, loss by friction
    double factor = 1.0;                 ///< factor on the energy
    ContactBooks() noexcept { rows.fill(Lanes<W>(0.0)); }

    void lose(Loss kind, const Lanes<W>& watts) noexcept { rows[kind == Loss::joint_damping || kind == Loss::tip_damping ? 1 : 2] = watts; }
    void store(Energy, const Lanes<W>& joules, double share = 1.0) noexcept {
        rows[0] = joules;
        factor = share;
    }
    /// Books sums of such rows.
    static void book(const Lanes<W>* sums, double factor, Energy energy, Loss damping, Loss friction, LaneBooks<W>& books) noexcept {
        books.store(energy, sums[0], factor);
        books.lose(damping, sums[1]);
        books.lose(friction, sums[2]);
    }
};

/// Groups of W links; `group` counts from the range's first, `count` of the lanes represent links.
template <int W>
class ObservationWriter : public SlopeWriter<W> {
public:
    using V = Lanes<W>;
    using Books = LaneBooks<W>;
    using PointBooks = ContactBooks<W>;

    /// Both of the range's first link on. @param contacts nullptr: not needed
    ObservationWriter(const SlopeWriter<W>& slopes, Account* accounts, LinkContact* contacts) noexcept
        : SlopeWriter<W>(slopes), c_(slopes.coefficients()), accounts_(accounts), contacts_(contacts) {}

    [[nodiscard]] const auto& tips() const noexcept { return *this; }
    [[nodiscard]] V sliding(Zero to, int plate, const PlateStretch<W>& stretch, const V& speed, Books& books) const noexcept {
        books.tension += stretch.elastic;
        return SlopeWriter<W>::sliding(to, plate, stretch, speed, books);
    }

    /// Books sums over the points of a joint. @param total terms of its force, then those of `of_point`
    template <std::size_t rows>
    static void book_point(const std::array<V, rows>& total, const PointBooks& of_point, Books& books) noexcept {
        PointBooks::book(&total[rows - PointBooks::numbers], of_point.factor, Energy::joints, Loss::joint_damping, Loss::joint_friction,
                         books);
    }
    /// Books tips, summed in the tree of sum().
    void book_tips(int group, int count, const std::array<PointBooks, tips_per_link>& of_tips) const noexcept {
        std::array<V, PointBooks::numbers> total;
        for (std::size_t row = 0; row < total.size(); ++row)
            total[row] = (of_tips[0].rows[row] + of_tips[2].rows[row]) + (of_tips[1].rows[row] + of_tips[3].rows[row]);
        Books books;
        PointBooks::book(total.data(), of_tips[0].factor, Energy::tips, Loss::tip_damping, Loss::tip_friction, books);
        book(AccountPart::tips, group, count, books);
    }

    void book(AccountPart part, int group, int count, const Books& books) const noexcept {
        alignas(64) double column[W][Books::numbers];
        std::array<double*, W> to;
        for (std::size_t lane = 0; lane < W; ++lane) to[lane] = column[lane];
        store_rows<W, static_cast<int>(Books::numbers)>(books.rows.data(), to, std::clamp(count, 0, W));
        for (int lane = 0; lane < std::min(count, W); ++lane) {
            Account& account = accounts_[account_parts * (group + lane) + static_cast<int>(part)];
            const double* of_link = column[static_cast<std::size_t>(lane)];
            for (std::size_t kind = 0; kind < loss_kinds; ++kind) account.loss[kind] += of_link[kind];
            for (std::size_t kind = 0; kind < energy_kinds; ++kind) account.energy[kind] += of_link[loss_kinds + kind];
            if (part == AccountPart::link && contacts_ != nullptr)  // no tips so far
                contacts_[group + lane] = {.tension = books.tension[static_cast<std::size_t>(lane)]};
        }
    }

    /// A tip of links that touch somewhere.
    void tip(const TipLinks<W>& links, int number, const TipGeometry<V>& g, const TipMotion<V>& m, const TipForces<V>& t,
             const SheaveMotionLanes<W>&, const V& shaft) const noexcept {
        if (contacts_ == nullptr) return;
        const int group = links.group;
        const auto& words = links.touches;
        const auto corner = static_cast<std::size_t>(number);
        const V shaft_x = shaft * c_.centre_distance;
        const auto put = [&](double(LinkContact::*member)[tips_per_link], const V& lanes) {
            for (std::size_t lane = 0; lane < W; ++lane) {
                if (words[lane] != 0) (contacts_[group + static_cast<int>(lane)].*member)[corner] = lanes[lane];
            }
        };
        for (std::size_t lane = 0; lane < W; ++lane) {
            if (words[lane] != 0) contacts_[group + static_cast<int>(lane)].shaft = static_cast<int>(shaft[lane]);
        }
        put(&LinkContact::depth, g.depth);
        put(&LinkContact::normal, t.normal);
        put(&LinkContact::axial, -(t.normal * g.normal.z + t.friction.z));
        const V x = g.end.x + m.lever_x - shaft_x, y = g.end.y + m.lever_y, radius = sqrt(x * x + y * y);
        const V push_x = -(t.normal * g.normal.x + t.friction.x), push_y = -(t.normal * g.normal.y + t.friction.y);
        put(&LinkContact::tangential, (x * push_y - y * push_x) / radius);
        put(&LinkContact::radial, (x * push_x + y * push_y) / radius);
        put(&LinkContact::radius, radius);
        const Vector3<V> slip = tangential(m.material, g.normal);
        const V square = dot(slip, slip), power = -dot(t.friction, m.material);
        put(&LinkContact::sliding, sqrt(square));
        put(&LinkContact::power, power);
        const V grip = power / larger<W>(square, V(1e-300));
        const Vector3<V>& arm = m.sheave_arm;
        const V arm_square = arm.x * arm.x + arm.y * arm.y, around = arm.x * slip.y - arm.y * slip.x;
        put(&LinkContact::hold, grip * arm_square);
        put(&LinkContact::drag, grip * around);
        put(&LinkContact::creep_power, grip * around * around / arm_square);
    }

private:
    const Coefficients& c_;
    Account* accounts_;
    LinkContact* contacts_;
};

/// Tips of links side by side against their sheaves, without forces: for detection after every step.
template <int W>
class LaneProbe {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<W>;

    LaneProbe(const Coefficients& c, const SheaveMotion* sheaves, bool with_slip) noexcept
        : c_(c), sheaves_(sheaves), with_slip_(with_slip) {}

    /// @param states blocks of `links` neighbouring links [unknowns]
    void run(const double* states, int links, TipProbe* probes) const noexcept {
        for (int first = 0; first < links; first += W)
            group(states + first * link_layout.link_block(), std::min(W, links - first), probes + first);
    }

private:
    static constexpr int numbers = sizeof(TipProbe) / sizeof(double);
    static constexpr int depth_row = 0, slip_row = tips_per_link, radius_row = 2 * tips_per_link;
    static_assert(numbers == radius_row + 1);

    /// states [unknowns]
    void group(const double* states, int count, TipProbe* probes) const noexcept {
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = states + std::min(lane, count - 1) * link_layout.link_block();
        Columns columns;
        load_rows<W, link_layout.link_block()>(from, columns.state.data());
        columns.frame = link_frame(columns.q(), columns.v());
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of(c_, sheaves_, columns, sheaves);
        std::array<V, numbers> rows;
        probe(OneTip<W, End::rear, 0>{}, 0, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::rear, 1>{}, 1, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 0>{}, 2, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 1>{}, 3, columns, sheaves.data(), rows.data());
        const V* q = columns.q();
        const V x = 0.5 * (q[link_layout.x(End::rear, 0)] + q[link_layout.x(End::front, 0)]) - shaft * c_.centre_distance;
        const V y = 0.5 * (q[link_layout.y(End::rear, 0)] + q[link_layout.y(End::front, 0)]);
        rows[radius_row] = sqrt(x * x + y * y);
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) to[static_cast<std::size_t>(lane)] = reinterpret_cast<double*>(probes + lane);
        store_rows<W, numbers>(rows.data(), to, count);
    }

    template <class Corner>
    void probe(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves, V* rows) const noexcept {
        const auto sheave = sheaves_at(corner, sheaves);
        const auto geometry = tip_geometry(c_, corner, columns.frame, columns.q(), sheave);
        rows[depth_row + number] = geometry.depth;
        rows[slip_row + number] = V(0.0);
        if (!with_slip_) return;
        const auto slip = tangential(tip_motion(c_, corner, columns.frame, columns.v(), sheave, geometry).material, geometry.normal);
        rows[slip_row + number] = sqrt(dot(slip, slip));
    }

    const Coefficients& c_;
    const SheaveMotion* sheaves_;
    bool with_slip_;
};

void probe_links(const ChainModel& model, const double* states, int links, const SheaveMotion* sheaves, bool with_slip,
                 TipProbe* probes) noexcept {
    LaneProbe<native_lanes>(model.coefficients(), sheaves, with_slip).run(states, links, probes);
}

void slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads) noexcept {
    LinkPass(SlopeWriter<native_lanes>{model, range, slope, loads}).run();
}

void observed_slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                     LinkContact* contacts) noexcept {
    LinkPass(ObservationWriter<native_lanes>({model, range, slope, loads}, accounts, contacts)).run();
}

}  // namespace

template <>
ChainKernels chain_kernels<compiled_isa>() noexcept {
    if constexpr (slopes_alone)
        return {slopes, nullptr, nullptr};
    else
        return {slopes, observed_slopes, probe_links};
}

}  // namespace cvtflow::model
