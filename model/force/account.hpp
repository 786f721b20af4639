#pragma once
/// Sums of an observing evaluation besides forces: stored energies [J] and dissipated powers [W] by kind.

#include <array>
#include <cstddef>
#include <span>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Kinds of stored energy.
enum class Energy { kinetic, inner, pack, plates, joints, tips, supports };
inline constexpr int energy_kinds = 7;

/// Part of a link. Each link has one account per part, so that sums do not depend on the order in which parts are computed.
enum class AccountPart { joint, link, tips };
inline constexpr int account_parts = 3;

struct Account {
    std::array<double, loss_kinds> loss{};      ///< [W], each ≥ 0
    std::array<double, energy_kinds> energy{};  ///< [J]

    /// power [W]
    void lose(Loss kind, double power) noexcept { loss[static_cast<std::size_t>(kind)] += power; }
    /// joules [J]
    void store(Energy kind, double joules) noexcept { energy[static_cast<std::size_t>(kind)] += joules; }
    [[nodiscard]] double operator[](Loss kind) const noexcept { return loss[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] double operator[](Energy kind) const noexcept { return energy[static_cast<std::size_t>(kind)]; }
};

/// Sum of accounts, in their order.
[[nodiscard]] inline Account total_of(std::span<const Account> accounts) noexcept {
    Account total;
    for (const Account& account : accounts) {
        for (std::size_t kind = 0; kind < loss_kinds; ++kind) total.loss[kind] += account.loss[kind];
        for (std::size_t kind = 0; kind < energy_kinds; ++kind) total.energy[kind] += account.energy[kind];
    }
    return total;
}

namespace {

/// Books of forces that are not observed: they keep nothing, so that compilers leave out what is booked. Others have, with observed = true,
///     void store(Energy kind, const Real& joules, double factor = 1.0);   what is stored, times a factor [J]
///     void lose(Loss kind, const Real& watts);                            what is lost [W]
/// where Real is a number or lanes: of links side by side (model/kernels/chain_kernels.cpp).
struct NoBooks {
    static constexpr bool observed = false;
    static constexpr std::size_t numbers = 0;
    static void store(Energy, const auto&, double = 1.0) noexcept {}
    static void lose(Loss, const auto&) noexcept {}
};

}  // namespace

}  // namespace cvtflow::model
