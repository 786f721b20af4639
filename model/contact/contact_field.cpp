#include "model/contact/contact_field.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

namespace {

constexpr int line = 8;  // doubles of a cache line

}  // namespace

Columns::Columns(int components, int columns) : stride_((columns + line - 1 + line - 1) / line * line + line) {
    memory_.assign(static_cast<std::size_t>(components * stride_ + 2 * line), 0.0);
}

ContactField::ContactField(const ChainModel& chain)
    : components{chain.layout().whole ? 0 : chain.coefficients().joint_points.count, chain.coefficients().plates.count},
      columns(components.count(), chain.layout().links + 2 * chain.layout().halo()),
      arms(static_cast<std::size_t>(chain.layout().links)) {
    for (int corner = 0; corner < tips_per_link; ++corner) {  // a tip that has never touched must not divide by zero
        for (int column = 0; column < columns.stride(); ++column)
            *columns.at(components.tip(corner) + ContactComponents::Tip::least, column) = 1.0;
    }
}

namespace {

/// Whole pins have no sliding in their joints that friction could be solved for; what is lost in rolling stays with the damping.
Coefficients without_friction(Coefficients c) {
    c.plate_friction.coefficient = c.tip.friction.coefficient = 0.0;
    if (!c.layout.whole) c.joint.friction.coefficient = 0.0;
    return c;
}

[[nodiscard]] FrictionKernels kernels_for(const ChainModel& chain) {
    const CompiledKernels kernels = kernels_of(chain.isa());
    const int order = chain.layout().order;
    return chain.layout().whole ? kernels.pins(order).friction : kernels.friction(order);
}

/// In long double, which has no vectors: the same bits whatever processor this is compiled for.
/// @param rows of the matrix, `size` modes of either end
MirroredInverse inverse_of(const double* rows, int size) {
    using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Wide inverse = Wide(Eigen::Map<const Eigen::MatrixXd>(rows, 2 * size, 2 * size).cast<long double>()).inverse();
    MirroredInverse mirrored;
    for (int m = 0; m < size; ++m) {
        for (int k = m % 2; k < size; k += 2) {
            const auto at = static_cast<std::size_t>(m * most_lateral + k);
            mirrored.sum[at] = static_cast<double>(0.5L * (inverse(m, k) + inverse(m, size + k)));
            mirrored.difference[at] = static_cast<double>(0.5L * (inverse(m, k) - inverse(m, size + k)));
        }
    }
    return mirrored;
}

}  // namespace

FrictionOperator::FrictionOperator(const ChainModel& chain, bool by_phase)
    : chain_(chain), frictionless_(without_friction(chain.coefficients())), by_phase_(by_phase), kernels_(kernels_for(chain)) {
    if (chain.layout().whole) return;
    lateral_inverse_ = inverse_of(chain.inertia().lateral_matrix.data(), chain.layout().lateral());
    axial_inverse_ = inverse_of(chain.inertia().axial_matrix.data(), 2);
}

int FrictionOperator::scratch_size(int links) const noexcept { return (2 * chain_.layout().lateral() + 5) * joint_stride(links); }

}  // namespace cvtflow::model
