#include "model/contact/slip/slip_space.hpp"

#include <Eigen/Core>

#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

SlipGroup::SlipGroup(const ChainModel& model, const SlipStretches& stretches, int number) {
    const SlipContacts contacts{model.coefficients().joint_points.count};
    const int slips = contacts.slips(), joints_slips = 2 * contacts.joint_slips(), local = SlipContacts::local_slips;
    present = LaneRows(1);
    for (int lane = 0; lane < slip_lanes; ++lane) {
        const int link = stretches.link({number, lane});
        column[static_cast<std::size_t>(lane)] = link + 1;
        if (stretches.idle({number, lane})) continue;
        links.push_back({link, lane});
        present.at(0)[lane] = 1.0;
    }
    frame = LaneRows(2);
    tips = LaneRows(tips_per_link * Tip::count);
    joints = LaneRows(2 * contacts.points * Point::count);
    plates = LaneRows(model.coefficients().plates.count);
    coupling = FloatRows(triangle(slips, 0));
    for (LaneRows* rows : {&velocity, &acceleration}) *rows = LaneRows(model.layout().link_size());
    for (LaneRows* rows : {&predicted, &own, &link_slip_at_start, &slip, &force, &law_force, &part, &next_slip, &next_force, &solved_slip})
        *rows = LaneRows(slips);
    root = FloatRows(4 * contacts.count());
    factor = FloatRows(triangle(local, 0));
    panel = FloatRows(local * (joints_slips + 1));
    element = FloatRows(SlipElement{contacts.joint_slips()}.count());
}

namespace {

/// dᵀ A⁻¹ d' of all pairs of directions (columns). In long double, which has no vectors: the same bits whatever processor this is compiled
/// for.
std::vector<double> gram(const Eigen::MatrixXd& directions, const MirroredInverse& inverse) {
    const int modes = static_cast<int>(directions.rows()) / 2;
    Eigen::MatrixXd a(2 * modes, 2 * modes);
    for (int m = 0; m < modes; ++m) {
        for (int k = 0; k < modes; ++k) {
            const auto at = static_cast<std::size_t>(m * max_lateral + k);
            a(m, k) = a(modes + m, modes + k) = inverse.sum[at] + inverse.difference[at];
            a(m, modes + k) = a(modes + m, k) = inverse.sum[at] - inverse.difference[at];
        }
    }
    using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Wide d = directions.cast<long double>(), half = a.cast<long double>() * d;
    const Eigen::MatrixXd product = (d.transpose() * half).cast<double>();
    return {product.data(), product.data() + product.size()};
}

Eigen::MatrixXd lateral_directions(const Coefficients& c, const SlipContacts& contacts) {
    const int n = c.layout.lateral(), points = contacts.points;
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(2 * n, 5 + 2 * points);
    for (int m = 0; m < n; ++m) {
        for (int corner = 0; corner < tips_per_link; ++corner) d(corner / 2 * n + m, corner) = corner % 2 == 0 && m % 2 == 1 ? -1.0 : 1.0;
        for (int g = 0; g < points; ++g)
            d(m, 4 + g) = d(n + m, 4 + points + g) = c.joint_points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(g)];
    }
    d(0, 4 + 2 * points) = -1.0;
    d(n, 4 + 2 * points) = 1.0;
    return d;
}

Eigen::MatrixXd axial_directions(const Coefficients& c, const SlipContacts& contacts) {
    const int points = contacts.points;
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(4, 6 + 2 * points);
    for (int corner = 0; corner < tips_per_link; ++corner) d.col(corner).segment<2>(corner / 2 * 2) << 1.0, (corner % 2 == 0 ? -1.0 : 1.0);
    for (int g = 0; g < points; ++g) {
        const double xi = c.joint_points.position[static_cast<std::size_t>(g)];
        d.col(4 + g) << -1.0, -xi, 0.0, 0.0;
        d.col(4 + points + g) << 0.0, 0.0, 1.0, xi;
    }
    d.col(4 + 2 * points) << -1.0, 0.0, 1.0, 0.0;
    d.col(5 + 2 * points) << 0.0, -1.0, 0.0, 1.0;
    return d;
}

}  // namespace

SlipSpace::SlipSpace(const ChainModel& chain, bool by_phase)
    : friction_(chain, by_phase),
      contacts_{chain.coefficients().joint_points.count},
      tip_curve_(by_phase ? chain.coefficients().tip.friction.piecewise() : chain.coefficients().tip.friction),
      lateral_gram_(gram(lateral_directions(chain.coefficients(), contacts_), friction_.lateral_inverse())),
      axial_gram_(gram(axial_directions(chain.coefficients(), contacts_), friction_.axial_inverse())),
      kernels_(kernels_of(chain.isa()).slip(chain.layout().order, contacts_.points)) {}

}  // namespace cvtflow::model
