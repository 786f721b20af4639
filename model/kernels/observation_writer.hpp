#pragma once
/// Writes what links carry while their forces are computed, links side by side in lanes: energies, losses, contacts. (model/EQUATIONS.md
/// section 9)

#include <algorithm>
#include <array>

#include "model/chain/chain_model.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/contact_writer.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// Energies and losses of links side by side, in the order of Account.
template <int W>
struct LaneBooks {
    static constexpr bool observed = true;
    static constexpr std::size_t numbers = loss_kinds + energy_kinds;
    static_assert(sizeof(Account) == numbers * sizeof(double));

    std::array<Lanes<W>, numbers> rows;
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
class ObservationWriter : public NoContacts {
public:
    using V = Lanes<W>;
    using Books = LaneBooks<W>;
    using PointBooks = ContactBooks<W>;

    /// Both of the range's first link on. @param contacts nullptr: not needed
    ObservationWriter(const Coefficients& c, Account* accounts, LinkContact* contacts) noexcept
        : c_(c), accounts_(accounts), contacts_(contacts) {}

    /// Books sums over the points of a joint. @param total terms of its force, then those of `of_point`
    template <std::size_t rows>
    static void book_point(const std::array<V, rows>& total, const PointBooks& of_point, Books& books) noexcept {
        PointBooks::book(&total[rows - PointBooks::numbers], of_point.factor, Energy::joints, Loss::joint_damping, Loss::joint_friction,
                         books);
    }
    static void book_plates(const std::array<V, plate_rows<Books>>& total, Books& books) noexcept {
        model::book_plates(total.data(), books);
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
        }
    }

    /// Links that carry a tension, and no tips so far.
    void tension(int group, int count, const KindLanes<W>& kind, const V* q) const noexcept {
        if (contacts_ == nullptr) return;
        const V sum = elastic_tension(c_, kind, q);
        for (int lane = 0; lane < std::min(count, W); ++lane) contacts_[group + lane] = {.tension = sum[static_cast<std::size_t>(lane)]};
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

}  // namespace
}  // namespace cvtflow::model
