
#include "model/contact/friction_operator.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::model {

namespace {

template <std::size_t N>
std::array<float, N> rounded(const std::array<double, N>& numbers) {
    std::array<float, N> to;
    std::ranges::transform(numbers, to.begin(), [](double x) { return static_cast<float>(x); });
    return to;
}

template <int Most>
PointLanes<Most, float> rounded(const PointLanes<Most>& points) {
    PointLanes<Most, float> to{points.count, points.width, rounded(points.position), rounded(points.weight), rounded(points.damping)};
    std::ranges::transform(points.basis, to.basis.begin(), [](const auto& row) { return rounded(row); });
    return to;
}

MirroredMatrix<float> rounded(const MirroredMatrix<double>& matrix) { return {rounded(matrix.sum), rounded(matrix.difference)}; }

}  // namespace

ContactField::ContactField(const ChainModel& chain)
    : components{chain.coefficients().joint_points.count, chain.coefficients().plates.count} {
    make_columns(chain.layout().links + 2);
}

void ContactField::make_columns(int count) {
    columns = FloatColumns(components.count(), count);
    arms = Columns(3 * tips_per_link, count);
}

FrictionNumbers::FrictionNumbers(const Coefficients& c, const HeldInverse& responses)
    : tip_law(c.tip.law), joint_points(rounded(c.joint_points)), plates(rounded(c.plates)), inverse{rounded(responses.along),
                                                                                                    rounded(responses.across),
                                                                                                    rounded(responses.axial),
                                                                                                    rounded(responses.turning),
                                                                                                    rounded(responses.wave_plates),
                                                                                                    rounded(responses.wave_joint)} {}

FrictionOperator::FrictionOperator(const ChainModel& chain, const FrictionKernels& kernels)
    : chain_(chain),
      inverse_(HeldLinks(chain.coefficients(), chain.inertia()).inverse(0.0)),
      numbers_(chain.coefficients(), inverse_),
      kernels_(kernels) {}

void FrictionOperator::hold(float step) noexcept {
    if (step == held_for_) return;
    held_for_ = step;
    inverse_ = HeldLinks(chain_.coefficients(), chain_.inertia()).inverse(step);
    numbers_ = {chain_.coefficients(), inverse_};
}

namespace {

/// Factor on the response of a joint point to its force: other points of the pass push the same way. Without it sweeps diverge.
constexpr double joint_margin = 1.1;
/// Tips respond as if all four of a link pushed the same way, plates as if the halves moved alone. That is more than they do, and a change
/// would fall short of what is left: less makes two sweeps as exact as three. At 0.5 sweeps diverge, at 0.7 they do not (decision 104).
constexpr double tip_margin = 0.7, plate_margin = 0.7;

/// A half's modes at a place, as rows of the inverse of the mass matrix act on them.
struct Response {
    const MirroredMatrix<double>& inverse;
    int size;

    /// Response of mode m to a force with these shares in the modes, on the same end or on the other one.
    template <class Shares>
    [[nodiscard]] double mode(int m, bool same_end, const Shares& shares) const {
        double sum = 0.0;
        for (int k = m % 2; k < size; k += 2) {
            const auto at = static_cast<std::size_t>(m * axis_terms + k);
            sum += (inverse.sum[at] + (same_end ? inverse.difference[at] : -inverse.difference[at])) * shares(k);
        }
        return sum;
    }
    /// Response of the place with the shares `at` to a force at the place with the shares `from`.
    template <class At, class From>
    [[nodiscard]] double place(bool same_end, const At& at, const From& from) const {
        double sum = 0.0;
        for (int m = 0; m < size; ++m) sum += at(m) * mode(m, same_end, from);
        return sum;
    }
};

[[nodiscard]] double low_end(int mode) { return mode % 2 == 0 ? 1.0 : -1.0; }
[[nodiscard]] double high_end(int /*mode*/) { return 1.0; }

/// Response of one tip to equal forces at all four tips of its link in one direction.
[[nodiscard]] double all_tips(const Response& response) {
    double sum = 0.0;
    for (const bool same_end : {true, false})
        sum += std::abs(response.place(same_end, high_end, high_end)) + std::abs(response.place(same_end, high_end, low_end));
    return sum;
}

}  // namespace

SweepResponses::SweepResponses(const FrictionOperator& friction, double whole, double whole_nominal) noexcept
    : step(static_cast<float>(sweep_time * whole)), of_step(whole), of_nominal(whole_nominal) {
    const double h = sweep_time * whole, nominal = sweep_time * whole_nominal;
    const auto& points = friction.chain().coefficients().joint_points;
    const HeldInverse& inverse = friction.inverse();
    const Response along{inverse.along, axis_terms}, across{inverse.across, axis_terms}, axial{inverse.axial, 2};
    const auto one = [](int k) { return [k](int m) { return m == k ? 1.0 : 0.0; }; };
    const auto rounded = [](double x) { return static_cast<float>(x); };
    const double z = 2.0 * nominal * axial.mode(0, true, one(0)), e = 2.0 * nominal * axial.mode(1, true, one(1));  // of both pins' halves
    for (std::size_t g = 0; g < static_cast<std::size_t>(points.count); ++g) {
        const auto shares = [&](int m) { return points.basis[static_cast<std::size_t>(m)][g]; };
        const double xi = points.position[g];
        joint_across[g] = rounded(joint_margin * 2.0 * nominal * across.place(true, shares, shares));
        joint_along[g] = rounded(joint_margin * (z + xi * xi * e));
        for (int m = 0; m < axis_terms; ++m)
            joint_lateral[g][static_cast<std::size_t>(m)] = rounded(2.0 * nominal * across.mode(m, true, shares));
        joint_tilt[g] = rounded(xi * e);
    }
    joint_shift = rounded(z);
    tip = rounded(tip_margin * nominal * std::max({all_tips(along), all_tips(across), all_tips(axial)}));
    const double apart_z = 2.0 * axial.inverse.difference[0], apart_e = 2.0 * axial.inverse.difference[axis_terms + 1];
    plate_shift = rounded(plate_margin * nominal * 2.0 * apart_z);
    plate_tilt = rounded(plate_margin * nominal * 2.0 * apart_e);
    link_shift = rounded(h * apart_z);
    link_tilt = rounded(h * apart_e);
}

}  // namespace cvtflow::model
