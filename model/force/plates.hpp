#pragma once
/// Plates of a link: elastic bars between the two halves, with friction against axial sliding. Lanes run over the plates.
/// (model/EQUATIONS.md section 4)

#include "model/account.hpp"
#include "model/coefficients.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {

/// Differences front - rear of a link's coordinates: all that plates depend on.
template <int P>
struct Stretch {
    double x[P + 1], y[P + 1], z, e;

    explicit Stretch(const double* q) noexcept
        : z(q[at<P>.z(End::front)] - q[at<P>.z(End::rear)]), e(q[at<P>.e(End::front)] - q[at<P>.e(End::rear)]) {
        for (int m = 0; m <= P; ++m) {
            x[m] = q[at<P>.x(End::front, m)] - q[at<P>.x(End::rear, m)];
            y[m] = q[at<P>.y(End::front, m)] - q[at<P>.y(End::rear, m)];
        }
    }
    Stretch() noexcept : x{}, y{}, z(0.0), e(0.0) {}
};

/// Σ c_m P_m(ξ) over lanes.
template <int P, int W>
[[nodiscard]] inline Lanes<W> along_axis(const double* c, const Lanes<W>* basis) noexcept {
    Lanes<W> value(c[0]);
    for (int m = 1; m <= P; ++m) value += c[m] * basis[m];
    return value;
}

/// One chunk of W plates; adds the force on the front half to `pull`.
template <int P, int W, bool Observe>
inline void plate_chunk(const Coefficients& c, double free_length, const Stretch<P>& d, const Stretch<P>& rate, int first, Stretch<P>& pull,
                        Account* account) noexcept {
    const auto& plates = c.plates;
    Lanes<W> basis[P + 1];
    for (int m = 1; m <= P; ++m) basis[m] = load<W>(&plates.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(first)]);
    const Lanes<W> xi = load<W>(&plates.position[static_cast<std::size_t>(first)]);
    const Lanes<W> damping = load<W>(&plates.damping[static_cast<std::size_t>(first)]);
    const Lanes<W> stiffness = load<W>(&plates.weight[static_cast<std::size_t>(first)]);
    const Lanes<W> dx = along_axis<P, W>(d.x, basis), dy = along_axis<P, W>(d.y, basis), dz = d.z + xi * d.e;
    const Lanes<W> vx = along_axis<P, W>(rate.x, basis), vy = along_axis<P, W>(rate.y, basis), vz = rate.z + xi * rate.e;
    const Lanes<W> length = sqrt(dx * dx + dy * dy + dz * dz);
    const Lanes<W> inverse = Lanes<W>(1.0) / length;
    const Lanes<W> stretch = length - free_length;
    const Lanes<W> stretching = (dx * vx + dy * vy + dz * vz) * inverse;
    const Lanes<W> tension = stiffness * stretch + damping * stretching;
    const Lanes<W> slide = c.plate_friction.coefficient * positive_part<W>(tension) * slip_factor<W>(c.plate_friction, abs(vz)) * vz;
    const Lanes<W> along = tension * inverse;
    const Lanes<W> fx = -along * dx, fy = -along * dy, fz = -along * dz - slide;
    pull.x[0] += sum<W>(fx);
    pull.y[0] += sum<W>(fy);
    for (int m = 1; m <= P; ++m) {
        pull.x[m] += sum<W>(fx * basis[m]);
        pull.y[m] += sum<W>(fy * basis[m]);
    }
    pull.z += sum<W>(fz);
    pull.e += sum<W>(fz * xi);
    if constexpr (Observe) {
        account->store(Energy::plates, 0.5 * sum<W>(stiffness * stretch * stretch));
        account->lose(Loss::plate_damping, sum<W>(damping * stretching * stretching));
        account->lose(Loss::plate_friction, sum<W>(slide * vz));
    }
}

/// All plates of a link. Adds to the generalized forces f of the link.
template <int P, int W, bool Observe>
inline void plates(const Coefficients& c, const LinkKind& kind, const double* q, const double* v, double* f, Account* account) noexcept {
    const Stretch<P> d(q);
    const Stretch<P> rate(v);
    Stretch<P> pull;
    for (int first = 0; first < c.plates.count; first += W) plate_chunk<P, W, Observe>(c, kind.free_length, d, rate, first, pull, account);
    for (int m = 0; m <= P; ++m) {
        f[at<P>.x(End::front, m)] += pull.x[m];
        f[at<P>.x(End::rear, m)] -= pull.x[m];
        f[at<P>.y(End::front, m)] += pull.y[m];
        f[at<P>.y(End::rear, m)] -= pull.y[m];
    }
    f[at<P>.z(End::front)] += pull.z;
    f[at<P>.z(End::rear)] -= pull.z;
    f[at<P>.e(End::front)] += pull.e;
    f[at<P>.e(End::rear)] -= pull.e;
}

}  // namespace cvtflow::model
