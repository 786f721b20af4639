#pragma once
/// Accounts of links or pins side by side, lane by lane: what a force books on an Account of one link, in the same order.

#include <algorithm>

#include "model/basis/lanes.hpp"
#include "model/force/account.hpp"

namespace cvtflow::model {
namespace {

/// As Account, of W links.
template <int W>
class LaneAccounts {
public:
    using V = Lanes<W>;

    LaneAccounts() noexcept {
        loss_.fill(V(0.0));
        energy_.fill(V(0.0));
    }

    /// power [W]
    void lose(Loss kind, const V& power) noexcept { loss_[static_cast<std::size_t>(kind)] += power; }
    /// joules [J]
    void store(Energy kind, const V& joules) noexcept { energy_[static_cast<std::size_t>(kind)] += joules; }

    /// The account of each lane to the accounts that are given; nullptr: not needed for that lane's.
    void copy_to(const std::array<Account*, W>& accounts) const noexcept {
        copy(loss_, accounts, [](Account& account) { return account.loss.data(); });
        copy(energy_, accounts, [](Account& account) { return account.energy.data(); });
    }

private:
    template <std::size_t kinds, class Numbers>
    static void copy(const std::array<V, kinds>& rows, const std::array<Account*, W>& accounts, const Numbers& numbers_of) noexcept {
        alignas(64) double numbers[kinds][W];
        for (std::size_t kind = 0; kind < kinds; ++kind) rows[kind].copy_to(numbers[kind]);
        for (std::size_t lane = 0; lane < W; ++lane) {
            if (accounts[lane] == nullptr) continue;
            for (std::size_t kind = 0; kind < kinds; ++kind) numbers_of(*accounts[lane])[kind] = numbers[kind][lane];
        }
    }

    std::array<V, loss_kinds> loss_;
    std::array<V, energy_kinds> energy_;
};

/// Value of lanes for an account: the sum if they are parts of one link, each by itself if they are links.
template <int W>
[[nodiscard]] inline double booked(const Account*, const Lanes<W>& lanes) noexcept {
    return sum<W>(lanes);
}
template <int W>
[[nodiscard]] inline const Lanes<W>& booked(const LaneAccounts<W>*, const Lanes<W>& lanes) noexcept {
    return lanes;
}

}  // namespace
}  // namespace cvtflow::model
