#pragma once
/// Motion of pins side by side, of their halves and of the sheaves at their ends, read from the columns. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/tips/pin_blocks.hpp"
#include "model/variator/rigid/tips/rigid_tip.hpp"

namespace cvtflow::model {
namespace {

/// What the tips of those pins begin with.
template <int W>
class TipMotion : protected PinBlocks<W> {
protected:
    using V = Lanes<W>;
    using D = DoublesOf<W>;
    using PlaneD = DoublePlaneOf<W>;
    using Base = PinBlocks<W>;
    using Base::lanes, Base::read_pins, Base::read_plane_of;
    using typename Base::Blocks;

    /// Places; rates are read where they are needed.
    [[gnu::always_inline]] TipMotion(const RigidCoefficients& c, const TipNumbers<W>& numbers, const SheaveMotion* sheaves,
                                     const RigidKick& kick, RigidColumns& columns, const Blocks& own) noexcept
        : Base(columns, own), c_(c), n_(numbers), kick_(kick) {
        at_ = read_motion(Column::x);
        second_ = select_greater<lanes>(at_.middle.x, D(c.middle), D(1.0), D(0.0));
        for (std::size_t k = 0; k < 2; ++k) {
            read_half(half_[k], k);
            read_side(sheaves[k], sheaves[2 + k], k, side_[k]);
        }
    }

    [[gnu::always_inline]] void read_rates(const SheaveMotion* sheaves) noexcept {
        rate_ = read_motion(Column::vx);
        for (std::size_t k = 0; k < 2; ++k) {
            read_half_rates(half_[k], k);
            read_side_rates(sheaves[k], sheaves[2 + k], side_[k]);
        }
    }

    [[nodiscard]] double side_of(std::size_t tip) const noexcept { return side_[end_of_tip(tip)].side; }

    const RigidCoefficients& c_;
    const TipNumbers<W>& n_;
    const RigidKick& kick_;
    PinMotion<lanes> at_, rate_;
    HalfMotion<W> half_[2];
    SideMotion<W> side_[2];
    D second_;  ///< 1 for pins on the driven pulley

private:
    [[nodiscard, gnu::always_inline]] PinMotion<lanes> read_motion(Column first) const noexcept {
        return {read_plane_of(first), read_plane_of(first + 3), read_plane_of(first + 6), read_pins(first + 2), read_pins(first + 5)};
    }
    [[gnu::always_inline]] void read_half(HalfMotion<W>& half, std::size_t which) noexcept {
        const PlaneD offset = D(share_of(which)) * read_plane_of(Column::part_x), t = read_plane_of(Column::line_x, line_of(which));
        const PlaneD outward{t.y, -t.x}, sphere = D(c_.outward) * outward;
        half.line = as<W>(t);
        half.outward = as<W>(outward);
        half.sphere = as<W>(sphere);
        half.centre = at_.middle + offset + sphere;
        half.rise = D(c_.outward / c_.half_length) * dot(at_.end, outward) - D(share_of(which)) * at_.slide;
        half.bend_rise = D(c_.bend_slope * c_.outward / c_.half_length) * dot(at_.bend, outward);
    }
    [[gnu::always_inline]] void read_half_rates(HalfMotion<W>& half, std::size_t which) noexcept {
        half.turn = read_pins(Column::line_turn, line_of(which));
        half.slope_along = n_.per_half * dot(as<W>(at_.end), half.line);
        const PlaneD velocity = rate_.middle + D(share_of(which)) * read_plane_of(Column::part_vx);
        half.sphere_velocity = velocity + (c_.outward * half.turn) * read_plane_of(Column::line_x, line_of(which));
        half.bend_along = n_.bent_per_half * dot(as<W>(at_.bend), half.line);
        half.bend_rise_rate =
            n_.bent_outward_per_half * dot(as<W>(rate_.bend), half.outward) + n_.outward * (as<W>(half.turn) * half.bend_along);
        half.ahead = V(share_of(which)) * as<W>(rate_.slide);
        half.rise_rate =
            n_.outward_per_half * dot(as<W>(rate_.end), half.outward) + n_.outward * (as<W>(half.turn) * half.slope_along) - half.ahead;
    }

    /// A number of the sheaves of one side, for each pin that of its shaft.
    [[nodiscard]] D of(double SheaveMotion::*number, const SheaveMotion& driving, const SheaveMotion& driven) const noexcept {
        return select_greater<lanes>(second_, D(0.5), D(driven.*number), D(driving.*number));
    }

    [[gnu::always_inline]] void read_side(const SheaveMotion& driving, const SheaveMotion& driven, std::size_t end,
                                          SideMotion<W>& s) noexcept {
        const double side = s.side = end == 0 ? -1.0 : 1.0;
        const auto value = [&](double SheaveMotion::*number) { return of(number, driving, driven); };
        s.sphere = V(side * (c_.lever - 1.0)) * as<W>(at_.end) + V(c_.bend_lever - 1.0) * as<W>(at_.bend);
        s.arm = D(side * c_.lever) * at_.end + D(c_.bend_lever) * at_.bend - PlaneD{value(&SheaveMotion::x), value(&SheaveMotion::y)};
        s.z = at_.z - (value(&SheaveMotion::z) - side * c_.half_length);
        s.tilt_x = value(&SheaveMotion::tilt_x);
        s.tilt_y = value(&SheaveMotion::tilt_y);
    }
    /// Velocities lead by half a step, in which the pins move on above the spinning sheave; those of the beginning trail by as much.
    [[gnu::always_inline]] void read_side_rates(const SheaveMotion& driving, const SheaveMotion& driven, SideMotion<W>& s) noexcept {
        const auto value = [&](double SheaveMotion::*number) { return of(number, driving, driven); };
        s.spin_x = as<W>(value(&SheaveMotion::spin_x));
        s.spin_y = as<W>(value(&SheaveMotion::spin_y));
        s.spin_z = value(&SheaveMotion::spin_z);
        const PlaneD velocity{value(&SheaveMotion::vx), value(&SheaveMotion::vy)};
        s.turned_by = as<W>((0.5 * kick_.step) * s.spin_z);
        s.moved_on = (V(2.0) * s.turned_by) * turned(as<W>(rate_.middle));
        s.velocity = D(s.side) * rate_.end + rate_.bend - velocity + (0.5 * kick_.step * s.spin_z) * turned(rate_.middle);
        s.sphere_velocity = D(s.side * c_.lever) * rate_.end + D(c_.bend_lever) * rate_.bend - velocity;
        s.velocity_z = as<W>(rate_.z - value(&SheaveMotion::vz));
    }
};

}  // namespace
}  // namespace cvtflow::model
