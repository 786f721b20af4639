#pragma once
/// The only index arithmetic of the state vector.
///
///     link 0: [q (link_size) | v (link_size)]  link 1: …  link N-1  pulleys: [q (pulley_size) | v (pulley_size)]  control: [I, …,
///     hydraulics] ledger: [losses, works]   q of a link: [a.x_0…a.x_p  b.x_0…b.x_p | a.y…  b.y… | a.z a.e b.z b.e],  a = rear half
///     (R_link), b = front half (L_{link+1})
///
/// With rigid pins (detail.pins) a block is a pin instead of a link, the one behind which link begins:
///
///     q of a pin: [x_0 x_1 x_2 | y_0 y_1 y_2 | z ζ]
///
/// A slope (time derivative of a state) has the same layout: [v | acceleration] per block.

#include <cstdint>
#include <cstring>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// Kinds of dissipation; the order of the ledger.
enum class Loss {
    inner,
    plate_damping,
    plate_friction,
    joint_damping,
    joint_friction,
    tip_damping,
    tip_friction,
    supports,
    cylinder,
    guide
};
/// Kinds of external work; the ledger's second part.
enum class Work { drive, load, clamping };
inline constexpr int loss_kinds = 10;
inline constexpr int work_kinds = 3;

/// Unknowns of the hydraulics behind the integrals of controllers: set pressures x_1, x_2 of the valves and oil u_1, u_2 in the cylinders,
/// both as travel of the piston [m]; then energies [J]: work of the pump, lost over the relief valve, over the valves and by leakage, work
/// of the oil on the sheaves.
enum class HydraulicUnknown { set_1, set_2, oil_1, oil_2, pump, relief, valves, leakage, sheaves };
inline constexpr int hydraulic_unknowns = 9;

/// p, Legendre order of the axis of a pin half: 0 place, 1 slope, 2 and 3 bending.
inline constexpr int axis_order = 3;
/// Coefficients of such an axis along x, or along y.
inline constexpr int axis_terms = axis_order + 1;
/// Rigid pins bend in one shape, the second.
inline constexpr int rigid_pin_order = 2;

/// Half of a link.
enum class End { rear = 0, front = 1 };
/// Number of an end's body in its block: a rigid pin is one body.
[[nodiscard]] constexpr int body_of(End end, bool rigid) noexcept { return rigid ? 0 : static_cast<int>(end); }

struct ChainLayout {
    int links = 84;        ///< N = number of pins
    int pulley_size = 36;  ///< generalized coordinates of shafts and sheaves: 36, 4 or 0
    int controls = 0;      ///< integrals of controllers, 0…2: of S_1's (or of the only one), of S_2's beside it; and hydraulic_unknowns
    bool ledger = false;
    bool rigid = false;  ///< pins are one body each: x_0, y_0 the mean over the plates, ζ in the place of e

    /// Coefficients of an axis along x, or along y.
    [[nodiscard]] constexpr int lateral() const noexcept { return rigid ? rigid_pin_order + 1 : axis_terms; }
    /// Halves that a block holds the coordinates of.
    [[nodiscard]] constexpr int bodies() const noexcept { return rigid ? 1 : 2; }
    [[nodiscard]] constexpr int link_size() const noexcept { return bodies() * (2 * lateral() + 2); }
    [[nodiscard]] constexpr int link_block() const noexcept { return 2 * link_size(); }
    /// First index of a link's block: its q; its v follows at + link_size().
    [[nodiscard]] constexpr int link_begin(int link) const noexcept { return link * link_block(); }
    [[nodiscard]] constexpr int pulley_begin() const noexcept { return links * link_block(); }
    [[nodiscard]] constexpr int control_begin() const noexcept { return pulley_begin() + 2 * pulley_size; }
    [[nodiscard]] constexpr int ledger_begin() const noexcept { return control_begin() + controls; }
    /// Whether there are hydraulics; their unknowns are the last ones before the ledger.
    [[nodiscard]] constexpr bool hydraulic() const noexcept { return controls >= hydraulic_unknowns; }
    /// Number of unknowns.
    [[nodiscard]] constexpr int size() const noexcept { return ledger_begin() + (ledger ? loss_kinds + work_kinds : 0); }
    /// Number of generalized coordinates (half of the second-order unknowns).
    [[nodiscard]] constexpr int coordinates() const noexcept { return links * link_size() + pulley_size; }

    /// Offsets inside a link's q (or v); of a rigid pin, for either end the same.
    [[nodiscard]] constexpr int x(End end, int m) const noexcept { return body_of(end, rigid) * lateral() + m; }
    [[nodiscard]] constexpr int y(End end, int m) const noexcept { return (bodies() + body_of(end, rigid)) * lateral() + m; }
    [[nodiscard]] constexpr int z(End end) const noexcept { return 2 * (bodies() * lateral() + body_of(end, rigid)); }
    /// A rigid pin has ζ = z of the front half - z of the rear half here.
    [[nodiscard]] constexpr int e(End end) const noexcept { return z(end) + 1; }

    /// Neighbours on each side on which the forces on a block depend, and those on which contact of its tips depends.
    [[nodiscard]] constexpr int halo() const noexcept { return rigid ? 3 : 1; }
    [[nodiscard]] constexpr int probe_halo() const noexcept { return rigid ? 2 : 0; }

    [[nodiscard]] constexpr int next(int link) const noexcept { return link + 1 == links ? 0 : link + 1; }
    [[nodiscard]] constexpr int previous(int link) const noexcept { return link == 0 ? links - 1 : link - 1; }
    /// Number of a link that is counted on beyond the first or the last.
    [[nodiscard]] constexpr int wrapped(int link) const noexcept { return (link % links + links) % links; }

    bool operator==(const ChainLayout&) const = default;
};

/// Largest number of unknowns of a block.
inline constexpr int max_link_block = 2 * ChainLayout{}.link_size();

[[nodiscard]] ChainLayout layout_of(const Parameters& parameters) noexcept;

/// Offsets inside the pulleys' q of elastic pulleys: body 0…5 = shaft 1, shaft 2, sheave 1-, 1+, 2-, 2+; freedom 0…5 = u_x, u_y, τ_x, τ_y,
/// w, φ.
[[nodiscard]] constexpr int body_freedom(int body, int freedom) noexcept { return 6 * body + freedom; }
/// Body number of the sheave on shaft 0 or 1 and side 0 (-z) or 1 (+z).
[[nodiscard]] constexpr int sheave_body(int shaft, int side) noexcept { return 2 + 2 * shaft + side; }

/// Phase of a tip, one byte per tip; tip number = 4 link + 2 end + side (side 0 is -z).
enum class Phase : unsigned char { free = 0, touching = 1, stick = 2, slip = 3 };
inline constexpr int tips_per_link = 4;

/// The phases of a link's four tips, one byte each.
[[nodiscard]] inline std::uint32_t phase_word(const Phase* phases) noexcept {
    std::uint32_t word;
    std::memcpy(&word, phases, sizeof word);
    return word;
}
/// Whether a tip of the link touches. @param phases  of all tips
[[nodiscard]] inline bool touches(const Phase* phases, int link) noexcept { return phase_word(phases + tips_per_link * link) != 0; }

/// Time in which a pin takes the place of the next one: mean pitch over the mean speed of the rear pins; 0 of a chain at rest [s].
/// state [unknowns]
[[nodiscard]] double pin_period(const Chain& chain, const ChainLayout& at, const double* state) noexcept;

}  // namespace cvtflow::model
