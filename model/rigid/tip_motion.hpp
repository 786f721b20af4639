#pragma once
/// Contributions of the halves and ends of pins to the place and the motion of their tips, in blocks of pins side by side. Places are
/// computed in doubles once for each half and each end; the rest for a tip is small against them. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>

#include "model/force/sheave_motion.hpp"
#include "model/rigid/rigid_coefficients.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Pins side by side, of which the first `count` are valid: the others, if any, are copies or are in another block as well.
struct PinBlock {
    int first, count;
};

/// Columns of pins side by side, in blocks of eight.
/// @tparam W width of the results
template <int W>
class PinBlocks {
public:
    using Real = NumberOf<W>;
    using Columns = PinColumns;
    static constexpr int lanes = lane_count<W>, count = lanes / rigid_lanes;
    using Blocks = std::array<PinBlock, count>;

    PinBlocks(const Columns& columns, const Blocks& blocks) noexcept : columns_(columns), blocks_(blocks) {}

    [[nodiscard]] const Columns& columns() const noexcept { return columns_; }
    /// Pins of block 0 or 1.
    [[nodiscard]] const PinBlock& operator[](int block) const noexcept { return blocks_[static_cast<std::size_t>(block)]; }
    /// Entries of a row for all pins, or for the pins `offset` after them.
    template <class Number>
    [[nodiscard, gnu::always_inline]] auto read(const Number* row, int offset = 0) const noexcept {
        return joined([&](const PinBlock& block) { return model::read(row, block.first + offset); });
    }
    template <class Number>
    [[nodiscard, gnu::always_inline]] auto read(const PlaneRowOf<Number>& rows, int offset = 0) const noexcept {
        return PlaneOf{read(rows.x, offset), read(rows.y, offset)};
    }
    [[gnu::always_inline]] void write(Real* row, const Lanes<W>& values) noexcept {
        over_blocks([&](int block) { model::write(row, blocks_[static_cast<std::size_t>(block)].first, piece(values, block)); });
    }
    /// Numbers of the pins of one block.
    [[nodiscard, gnu::always_inline]] static PinLanes piece(const Lanes<W>& values, int block) noexcept {
        if constexpr (count == 1) {
            return values;
        } else {
            return half<W>(values, block);
        }
    }
    [[gnu::always_inline]] static void over_blocks(const auto& visit) noexcept {
        for (int block = 0; block < count; ++block) visit(block);
    }
    /// 1 for the valid pins of a block, 0 for the others.
    [[nodiscard, gnu::always_inline]] PinLanes present(int block) const noexcept { return first_lanes((*this)[block].count); }

private:
    [[nodiscard, gnu::always_inline]] auto joined(const auto& of_block) const noexcept {
        if constexpr (count == 1) {
            return of_block(blocks_[0]);
        } else {
            return join(of_block(blocks_[0]), of_block(blocks_[1]));
        }
    }

    const Columns& columns_;
    Blocks blocks_;
};

/// Numbers of all tips in the width W: derived once per pass and not for each tip.
template <int W>
struct TipNumbers {
    /// A sheave; place and spin are those against the sheave at -z of its shaft.
    struct Sheave {
        Lanes<W> x, y, tilt_x, tilt_y, vx, vy, spin_x, spin_y, spin_z, faster;
    };
    /// @param of [4]
    TipNumbers(const RigidCoefficients& c, const SheaveMotion* of, const RigidKick& kick) noexcept
        : sine(c.sine),
          cosine(c.cosine),
          radius(c.radius),
          inverse_reach(c.inverse_reach),
          softness(c.softness),
          hertz(c.hertz),
          damping(c.damping),
          per_cosine(1.0 / c.cosine),
          lever(c.lever),
          outward(c.outward),
          inward(c.radius * c.cosine),
          stiffness(c.cosine * c.hertz / c.softness),
          outward_per_half(c.outward / c.half_length),
          per_half(1.0 / c.half_length),
          bend_lever(c.bend_lever),
          bent_outward_per_half(c.bend_slope * c.outward / c.half_length),
          bent_per_half(c.bend_slope / c.half_length),
          per_mass(kick.until_friction() / c.mass),
          per_half_mass(2.0 * kick.until_friction() / c.mass),
          per_tilt(kick.until_friction() / c.tilt_mass),
          per_bend(kick.until_friction() / c.bend_mass),
          per_mass_or_bend(kick.until_friction() * (1.0 / c.mass + 1.0 / c.bend_mass)),
          lead(-0.5 * kick.step),
          friction(c.tip_friction.coefficient),
          response(1.2 * kick.until_friction() * (1.0 / c.mass + 1.0 / c.tilt_mass + 1.0 / c.bend_mass)),
          further_steps(c.further_steps + (is_single<W> ? 0 : 2)) {
        for (std::size_t k = 0; k < sheaves.size(); ++k) {
            const SheaveMotion &at = of[k], &low = of[k / 2 * 2];
            sheaves[k] = {at.x - low.x, at.y - low.y, at.tilt_x, at.tilt_y, at.vx,
                          at.vy,        at.spin_x,    at.spin_y, at.spin_z, at.spin_z - low.spin_z};
        }
    }

    Lanes<W> sine, cosine, radius, inverse_reach, softness, hertz, damping, per_cosine, lever, outward;  ///< copies of RigidCoefficients
    Lanes<W> inward;                                                                                     ///< R_p cos β [m]
    Lanes<W> stiffness;                                                      ///< dN/dδ_0 of a tip over η [N/m]
    Lanes<W> outward_per_half;                                               ///< R_p sin β/(ℓ_p/2)
    Lanes<W> per_half;                                                       ///< 1/(ℓ_p/2) [1/m]
    Lanes<W> bend_lever;                                                     ///< copy of the member of RigidCoefficients
    Lanes<W> bent_outward_per_half, bent_per_half;                           ///< outward_per_half and per_half for bending
    Lanes<W> per_mass, per_half_mass, per_tilt, per_bend, per_mass_or_bend;  ///< velocity per force until friction acts [m/s/N]
    Lanes<W> lead;      ///< time by which velocities are ahead of coordinates at the beginning of a step [s]
    Lanes<W> friction;  ///< coefficient of friction of tips
    Lanes<W> response;  ///< response of the sliding velocity to friction, with a margin for neighbours [m/s/N]
    int further_steps;  ///< further iterations of Newton's method
    std::array<Sheave, 4> sheaves;
};

/// Half and end of tip 0 … 3: 0 and 1 are the front half's at -z and +z, 2 and 3 the rear half's. Loops over tips are not unrolled: the
/// code would exceed the processor's cache of decoded instructions.
[[nodiscard]] constexpr std::size_t half_of_tip(std::size_t tip) noexcept { return tip / 2; }
[[nodiscard]] constexpr std::size_t end_of_tip(std::size_t tip) noexcept { return tip % 2; }
/// Number of a half's pitch line against the pin's, and its share of the halves' offset from each other.
[[nodiscard]] constexpr int line_of(std::size_t half) noexcept { return half == 0 ? -1 : 0; }
[[nodiscard]] constexpr double share_of(std::size_t half) noexcept { return half == 0 ? 0.5 : -0.5; }
/// 1 for the front half, -1 for the rear half.
[[nodiscard]] constexpr double sign_of(std::size_t half) noexcept { return half == 0 ? 1.0 : -1.0; }

/// Contributions of a pin half to place and motion of its tips.
template <int W>
struct HalfMotion {
    PlaneOf<W> line, outward;            ///< t and o of its pitch line
    PlaneOf<W> sphere;                   ///< R_p sin β o
    DoublePlaneOf<W> place;              ///< sphere's centre at the middle of the pin, from the origin of the sheave at -z [m]
    PlaneOf<W> centre;                   ///< place, rounded to the width W
    Lanes<W> distance, excess;           ///< |centre|, and |centre| - touching_radius [m]
    DoublesOf<W> clearance;              ///< sin β excess: part of the distance from the flank [m]
    Lanes<W> rise;                       ///< height of the pin's middle above the half's sphere: R_p sin β σ·o ∓ ζ/2 [m]
    Lanes<W> bend_rise;                  ///< part of this height by bending and by the pin's length, at +z [m]
    Lanes<W> turn, lag;                  ///< θ', and spin of the sheave at -z less θ' [rad/s]
    Lanes<W> slope_along, bend_along;    ///< σ·t by tilting, by bending at +z [rad]
    PlaneOf<W> velocity, drift;          ///< velocity of `place`; the same against the sheave at -z, without its tilting [m/s]
    Lanes<W> ahead;                      ///< velocity along z against the pin's middle, ±ζ'/2 [m/s]
    Lanes<W> rise_rate, bend_rise_rate;  ///< rates of rise and bend_rise [m/s]
};

/// Contributions of one side's sheaves and pin ends to place and motion of the tips there.
template <int W>
struct SideMotion {
    Lanes<W> side;            ///< ±1: -z or +z
    PlaneOf<W> arm;           ///< sphere's centre from `place`, less the displacement of this sheave against that at -z [m]
    PlaneOf<W> sphere;        ///< sphere's centre from the pin's end, without the half's part [m]
    Lanes<W> z, height;       ///< z of the sphere's centre from the flank plane's centre, without the half's part; of the end, inwards [m]
    DoublesOf<W> clearance;   ///< cos β height: part of the distance from the flank [m]
    Lanes<W> tilt_x, tilt_y;  ///< [rad]
    PlaneOf<W> velocity;      ///< velocity of the pin's end against the sheave, without the half's part [m/s]
    PlaneOf<W> sphere_velocity;  ///< velocity of a sphere's centre against the sheave's origin, without the half's part [m/s]
    Lanes<W> velocity_z;         ///< [m/s]
    PlaneOf<W> moved_on;         ///< change of the pin's velocity against the sheave by the sheave's turning until friction acts [m/s]
    Lanes<W> turned_by;          ///< half of the angle by which the sheave turns [rad]
    Lanes<W> spin_x, spin_y;     ///< [rad/s]
    Lanes<W> faster;             ///< φ' against the sheave at -z [rad/s]
};

/// Coordinates or velocities of pins.
template <int W>
struct PinMotion {
    DoublePlaneOf<W> middle;
    DoublesOf<W> z;
    PlaneOf<W> end, bend;
    Lanes<W> slide;
};

/// 1/√v. Floats take a root and a division in floats and one step of Newton's method, which leaves 1e-13.
template <int W>
[[nodiscard, gnu::always_inline]] inline DoublesOf<W> inverse_root(const DoublesOf<W>& v) noexcept {
    const Lanes<W> start = 1.0 / sqrt(convert<W>(v));
    if constexpr (is_single<W>) {
        const DoublesOf<W> wide = widened<W>(start);
        return wide * (1.5 - 0.5 * v * (wide * wide));
    } else {
        return start;
    }
}

/// Initial values of the tips of pins side by side, read from the columns.
template <int W>
class RigidTipMotion {
    using V = Lanes<W>;
    using D = DoublesOf<W>;
    using PlaneV = PlaneOf<W>;
    using PlaneD = DoublePlaneOf<W>;
    using Sheave = typename TipNumbers<W>::Sheave;
    static constexpr int lanes = lane_count<W>;

public:
    /// All must outlive this.
    [[gnu::always_inline]] RigidTipMotion(const RigidCoefficients& c, const TipNumbers<W>& numbers, const SheaveMotion* sheaves,
                                          const RigidKick& kick, const PinBlocks<W>& pins) noexcept
        : c_(c),
          n_(numbers),
          kick_(kick),
          pins_(pins),
          columns_(pins.columns()),
          turn_(is_single<W> ? columns_.line.turn_ahead : columns_.line.turn),
          offset_rate_(is_single<W> ? columns_.rolling.offset_ahead : columns_.rolling.offset_rate) {
        at_ = read_motion(columns_.state_position, columns_.position);
        second_ = select_greater<lanes>(at_.middle.x, D(c.middle), D(1.0), D(0.0));
        driven_ = convert<W>(second_);
        const PlaneD middle = at_.middle - PlaneD{in_doubles(&SheaveMotion::x, sheaves), in_doubles(&SheaveMotion::y, sheaves)};
        for (std::size_t k = 0; k < 2; ++k) {
            read_half(middle, half_[k], k);
            read_side(sheaves, k, side_[k]);
        }
    }

    [[gnu::always_inline]] void read_rates(const SheaveMotion* sheaves) noexcept {
        rate_ = read_motion(columns_.state_velocity, columns_.velocity);
        const D spin = in_doubles(&SheaveMotion::spin_z, sheaves);
        for (std::size_t k = 0; k < 2; ++k) {
            read_half_rates(spin, half_[k], k);
            read_side_rates(sheaves, k, side_[k]);
        }
    }
    [[nodiscard]] const HalfMotion<W>& half(std::size_t tip) const noexcept { return half_[half_of_tip(tip)]; }
    [[nodiscard]] const SideMotion<W>& side(std::size_t tip) const noexcept { return side_[end_of_tip(tip)]; }
    /// 1 for pins of the driven shaft, else 0.
    [[nodiscard]] const V& driven() const noexcept { return driven_; }

private:
    [[nodiscard, gnu::always_inline]] PinMotion<W> read_motion(const CoordinateRowsOf<double>& state, const auto& of) const noexcept {
        return {pins_.read(state.middle), pins_.read(state.z), pins_.read(of.end), pins_.read(of.bend), pins_.read(of.slide)};
    }
    /// A number of the sheave at -z of each pin's shaft. @param sheaves [4]
    [[nodiscard, gnu::always_inline]] D in_doubles(double SheaveMotion::*number, const SheaveMotion* sheaves) const noexcept {
        return select_greater<lanes>(second_, D(0.5), D(sheaves[2].*number), D(sheaves[0].*number));
    }
    [[nodiscard, gnu::always_inline]] V of_sheave(V TipNumbers<W>::Sheave::*number, std::size_t end) const noexcept {
        return select_greater<W>(driven_, V(0.5), n_.sheaves[2 + end].*number, n_.sheaves[end].*number);
    }

    [[gnu::always_inline]] void read_half(const PlaneD& middle, HalfMotion<W>& half, std::size_t which) noexcept {
        half.line = pins_.read(columns_.line.direction, line_of(which));
        half.outward = {half.line.y, -half.line.x};
        half.sphere = n_.outward * half.outward;
        half.place = middle + widened<W>(V(share_of(which)) * pins_.read(columns_.rolling.offset) + half.sphere);
        half.centre = convert<W>(half.place);
        const D square = dot(half.place, half.place), distance = square * inverse_root<W>(square), excess = distance - c_.touching_radius;
        half.distance = convert<W>(distance);
        half.excess = convert<W>(excess);
        half.clearance = c_.sine * excess;
        half.rise = n_.outward_per_half * dot(at_.end, half.outward) - V(share_of(which)) * at_.slide;
        half.bend_rise = n_.bent_outward_per_half * dot(at_.bend, half.outward);
        if (c_.unequal) half.bend_rise -= pins_.read(columns_.constants.longer);
    }
    [[gnu::always_inline]] void read_half_rates(const D& spin, HalfMotion<W>& half, std::size_t which) noexcept {
        half.turn = pins_.read(turn_, line_of(which));
        half.lag = convert<W>(spin) - half.turn;
        half.slope_along = n_.per_half * dot(at_.end, half.line);
        const PlaneV against = V(share_of(which)) * pins_.read(offset_rate_) + (n_.outward * half.turn) * half.line;
        half.velocity = convert<W>(rate_.middle) + against;
        half.drift = convert<W>(rate_.middle - spin * turned(half.place)) + against;
        half.bend_along = n_.bent_per_half * dot(at_.bend, half.line);
        half.bend_rise_rate = n_.bent_outward_per_half * dot(rate_.bend, half.outward) + n_.outward * (half.turn * half.bend_along);
        half.ahead = V(share_of(which)) * rate_.slide;
        half.rise_rate = n_.outward_per_half * dot(rate_.end, half.outward) + n_.outward * (half.turn * half.slope_along) - half.ahead;
    }

    [[gnu::always_inline]] void read_side(const SheaveMotion* sheaves, std::size_t end, SideMotion<W>& s) noexcept {
        const double side = end == 0 ? -1.0 : 1.0;
        s.side = side;
        const SheaveMotion &driving = sheaves[end], &driven = sheaves[2 + end];
        const PlaneV moved{of_sheave(&Sheave::x, end), of_sheave(&Sheave::y, end)};
        s.sphere = V(side * (c_.lever - 1.0)) * at_.end + V(c_.bend_lever - 1.0) * at_.bend;
        s.arm = (V(side) * n_.lever) * at_.end + n_.bend_lever * at_.bend - moved;
        const D plane(select_greater<lanes>(second_, D(0.5), D(driven.z - side * c_.half_length), D(driving.z - side * c_.half_length)));
        const D z = at_.z - plane, height = D(-side) * z;
        const V from_flank = convert<W>(z);
        s.z = from_flank - s.side * n_.inward;
        s.height = -s.side * from_flank;
        s.clearance = c_.cosine * height;
        s.tilt_x = of_sheave(&Sheave::tilt_x, end);
        s.tilt_y = of_sheave(&Sheave::tilt_y, end);
    }
    /// Velocities lead by half a step, in which the pins move on above the spinning sheave; those of the beginning trail by as much.
    [[gnu::always_inline]] void read_side_rates(const SheaveMotion* sheaves, std::size_t end, SideMotion<W>& s) noexcept {
        const V spin = of_sheave(&Sheave::spin_z, end);
        s.spin_x = of_sheave(&Sheave::spin_x, end);
        s.spin_y = of_sheave(&Sheave::spin_y, end);
        s.faster = of_sheave(&Sheave::faster, end);
        s.turned_by = V(0.5 * kick_.step) * spin;
        const PlaneV onward = s.turned_by * turned(convert<W>(rate_.middle)),
                     velocity{of_sheave(&Sheave::vx, end), of_sheave(&Sheave::vy, end)};
        s.moved_on = V(2.0 * friction_time) * onward;
        s.velocity = s.side * rate_.end + rate_.bend - velocity + onward - spin * turned(s.arm);
        s.sphere_velocity = (s.side * n_.lever) * rate_.end + n_.bend_lever * rate_.bend - velocity;
        const D along = select_greater<lanes>(second_, D(0.5), D(sheaves[2 + end].vz), D(sheaves[end].vz));
        s.velocity_z = convert<W>(rate_.z - along);
    }

    const RigidCoefficients& c_;
    const TipNumbers<W>& n_;
    const RigidKick& kick_;
    const PinBlocks<W>& pins_;
    const RigidRowsOf<NumberOf<W>>& columns_;
    const NumberOf<W>* const turn_;              ///< θ' of pitch lines: in a step at the time of the coordinates
    const PlaneRowOf<NumberOf<W>> offset_rate_;  ///< u' of halves, likewise
    PinMotion<W> at_, rate_;
    HalfMotion<W> half_[2];
    SideMotion<W> side_[2];
    D second_;  ///< 1 for pins of the driven shaft, else 0
    V driven_;  ///< second_ in the width W
};

}  // namespace
}  // namespace cvtflow::model
