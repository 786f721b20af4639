#pragma once
/// The tips of the whole chain, of pins that may touch. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/tips/near_pins.hpp"
#include "model/variator/rigid/tips/tip_group.hpp"

namespace cvtflow::model {
namespace {

/// What the tips of a whole chain add up to.
template <int W>
class TipSums {
public:
    TipSums(const RigidCoefficients& c, const RigidKick& kick) noexcept : numbers_(c, kick) {}

    [[gnu::noinline]] void add(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                               const typename TipGroup<W>::Blocks& blocks) noexcept {
        TipGroup<W> group(c, numbers_, sheaves, kick, columns, blocks);
        group.place();
        group.bound(bounds_);
        if constexpr (!is_single<W>) group.show_depths();
        if (group.free()) return group.release();
        group.press(sheaves, account_);
        group.predict();
        group.rub(on_sheaves_, creep_, account_);
    }
    void store(const RigidCoefficients& c, RigidReaction& reaction, Account& account) const noexcept {
        on_sheaves_.store(reaction.sheaves);
        creep_.store(reaction);
        bounds_.store(c, reaction);
        account.store(Energy::tips, total(account_.energy));
        account.lose(Loss::tip_damping, total(account_.damping));
        account.lose(Loss::tip_friction, total(account_.friction));
        account.lose(Loss::plate_friction, total(account_.plates));
    }

private:
    [[nodiscard]] static double total(const Lanes<W>& terms) noexcept { return sum<lane_count<W>>(widened<W>(terms)); }

    TipNumbers<W> numbers_;
    TipAccount<W> account_;
    ReactionSum<W> on_sheaves_;
    CreepSum creep_;
    TipBounds<W> bounds_;
};

/// Two blocks at a time.
inline void press_near_tips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                            RigidReaction& reaction, Account& account) noexcept {
    find_near_pins(c, sheaves, kick, columns);
    TipSums<rigid_singles> sums(c, kick);
    PinBlock waiting{0, 0};
    const int beyond = over_near_pins(columns, [&](const PinBlock& block) {
        if (waiting.count != 0) sums.add(c, sheaves, kick, columns, {waiting, block});
        waiting = waiting.count != 0 ? PinBlock{0, 0} : block;
    });
    if (waiting.count != 0) sums.add(c, sheaves, kick, columns, {waiting, {waiting.first, 0}});
    finish_near_pins(columns, beyond);
    sums.store(c, reaction, account);
}

inline void press_tips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                       RigidReaction& reaction, Account& account) noexcept {
    if (kick.implicit()) return press_near_tips(c, sheaves, kick, columns, reaction, account);
    TipSums<rigid_lanes> sums(c, kick);
    unwrap_tips(columns, over_near_pins(columns, [&](const PinBlock& block) { sums.add(c, sheaves, kick, columns, {block}); }));
    std::fill_n(columns[Column::written], columns.padded(), 1.0);
    sums.store(c, reaction, account);
}

inline void tip_depths(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, double* depth) noexcept {
    const RigidKick kick;
    const TipNumbers<rigid_lanes> numbers(c, kick);
    TipGroup<rigid_lanes> group(c, numbers, sheaves, kick, columns, {PinBlock{0, rigid_lanes}});
    group.place();
    for (std::size_t tip = 0; tip < rigid_tips; ++tip) group.depth(tip).copy_to(depth + tip * rigid_lanes);
}

/// Finds the pins that may touch, and presses their tips for the rates at which they lengthen; plates wait for these.
inline void lengthen_pins(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns) noexcept {
    const RigidKick kick;
    find_near_pins(c, sheaves, kick, columns);
    clear_tips(columns);
    const TipNumbers<rigid_lanes> numbers(c, kick);
    TipAccount<rigid_lanes> ignored;
    unwrap_tips(columns, over_near_pins(columns, [&](const PinBlock& block) {
                    TipGroup<rigid_lanes> group(c, numbers, sheaves, kick, columns, {block});
                    group.place();
                    if (!group.free()) group.press(sheaves, ignored);
                }));
}

/// M_i = n_i·(A_i g_i + A_{i+1} g_{i+1}) + moments of the tips on the halves that turn with pitch line i.
inline void tip_moments(RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane normal = turned(read_plane(columns, Column::line_x, i));
        const Plane lean = read_plane(columns, Column::tip_lean_x, i) + read_plane(columns, Column::tip_lean_x, i + 1);
        write(columns, Column::tip_moment_before, i, read(columns, Column::tip_moment, i));
        write(columns, Column::tip_moment, i,
              dot(normal, lean) + read(columns, Column::tip_rear, i) + read(columns, Column::tip_front, i + 1));
    }
}

}  // namespace
}  // namespace cvtflow::model
