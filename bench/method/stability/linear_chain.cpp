#include "bench/method/stability/linear_chain.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <array>
#include <cmath>
#include <optional>

#include "bench/method/jacobian/jacobian.hpp"
#include "model/machine/held_links.hpp"

namespace cvtflow::bench {

namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using ReadVector = Eigen::Map<const Eigen::VectorXd>;
using WriteVector = Eigen::Map<Eigen::VectorXd>;
using Entries = std::vector<Eigen::Triplet<double>>;

/// Factor on the usual saturation speeds with which no contact slides.
constexpr double all_stick = 1e4;

[[nodiscard]] std::array<model::Friction*, 3> frictions_of(model::Parameters& parameters) {
    return {&parameters.plate.friction, &parameters.joint.friction, &parameters.tip.friction};
}

void add_block(Entries& entries, const double* block, int rows, int columns, int row, int column) {
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            if (const double value = block[r * columns + c]; value != 0.0) entries.emplace_back(row + r, column + c, value);
        }
    }
}

/// Rows: velocities; columns: coordinates or velocities.
[[nodiscard]] Sparse assembled(const model::ChainLayout& layout, const bench::AccelerationJacobian& jacobian, bench::With with) {
    const int size = layout.link_size(), tail = layout.links * size, border = jacobian.border();
    Entries entries;
    for (int link = 0; link < layout.links; ++link) {
        const int near[3] = {layout.previous(link), link, layout.next(link)};
        for (int n = 0; n < 3; ++n)
            add_block(entries, jacobian.link(link, static_cast<bench::Near>(n), with), size, size, link * size, near[n] * size);
        add_block(entries, jacobian.columns(link, with), size, border, link * size, tail);
        add_block(entries, jacobian.rows(link, with), border, size, tail, link * size);
    }
    if (border != 0) add_block(entries, jacobian.corner(with), border, border, tail, tail);
    Sparse matrix(tail + border, tail + border);  // I has no coordinate: a column of zeros
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

struct Derivatives {
    Sparse by_position, by_velocity;
};

/// Rigid pins and eccentric sheaves have no exact derivatives: by differences of the whole right-hand side.
[[nodiscard]] Derivatives differences_of(const model::Variator& variator, const FrozenStart& start) {
    const model::ChainLayout& layout = variator.layout();
    const std::vector<double> matrix = bench::difference_jacobian(variator, start.time, start.state, start.phases);
    std::vector<int> places[2];  // of coordinates and of velocities, in the order of a linear chain
    const auto add = [&](int begin, int size) {
        for (int k = 0; k < size; ++k) {
            places[0].push_back(begin + k);
            places[1].push_back(begin + size + k);
        }
    };
    for (int link = 0; link < layout.links; ++link) add(layout.link_begin(link), layout.link_size());
    add(layout.pulley_begin(), layout.pulley_size);
    for (int k = 0; k < layout.controls; ++k) places[1].push_back(layout.control_begin() + k);
    const auto size = static_cast<Eigen::Index>(places[1].size());
    const auto part = [&](const std::vector<int>& columns) {
        Entries entries;
        for (std::size_t column = 0; column < columns.size(); ++column) {
            const double* of_column = matrix.data() + static_cast<std::size_t>(columns[column]) * start.state.size();
            for (std::size_t row = 0; row < places[1].size(); ++row) {
                if (const double value = of_column[places[1][row]]; value != 0.0)
                    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
            }
        }
        Sparse sparse(size, size);
        sparse.setFromTriplets(entries.begin(), entries.end());
        return sparse;
    };
    return {part(places[0]), part(places[1])};
}

[[nodiscard]] Derivatives derivatives_of(const model::Variator& variator, const FrozenStart& start) {
    const model::ChainLayout& layout = variator.layout();
    if (layout.rigid || variator.pulleys().eccentric()) return differences_of(variator, start);
    bench::ExactJacobian exact(variator);
    bench::AccelerationJacobian jacobian(layout);
    exact.links(start.state.data(), start.phases.data(), 0, layout.links, jacobian);
    exact.corner(start.time, start.state.data(), start.phases.data(), jacobian);
    return {assembled(layout, jacobian, bench::With::position), assembled(layout, jacobian, bench::With::velocity)};
}

/// Derivatives with friction coefficients and saturation speeds multiplied by these factors.
[[nodiscard]] Derivatives derivatives_with(const model::Variator& variator, model::Parameters parameters, const FrozenStart& start,
                                           double coefficient, double speed) {
    for (model::Friction* friction : frictions_of(parameters)) {
        friction->coefficient *= coefficient;
        friction->saturation_speed *= speed;
    }
    model::Variator other(parameters);
    other.hold(variator.pulleys().torques().held());
    return derivatives_of(other, start);
}

/// Largest |eigenvalue| by power iteration: friction has real ones.
[[nodiscard]] double radius_of(const Sparse& matrix) {
    Eigen::VectorXd x(matrix.cols());
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = std::sin(1.0 + 2.399 * static_cast<double>(k));
    double radius = 0.0;
    for (int iteration = 0; iteration < 100 && x.norm() > 0.0; ++iteration) {
        x.normalize();
        x = (matrix * x).eval();
        radius = x.norm();
    }
    return radius;
}

/// M⁻¹ K of held links, rows and columns of their velocities.
[[nodiscard]] Sparse held_part(const model::ChainModel& chain, const double* state) {
    const model::ChainLayout& layout = chain.layout();
    const int size = layout.link_size(), all = layout.links * size;
    Sparse part(all, all);
    if (layout.rigid) return part;
    const model::HeldLinks held(chain.coefficients(), chain.inertia());
    Entries entries;
    for (int link = 0; link < layout.links; ++link) {
        for (int column = 0; column < size; ++column) {
            std::vector<double> moved(static_cast<std::size_t>(size), 0.0), of_column = moved;
            moved[static_cast<std::size_t>(column)] = 1.0;
            held.add(1.0, state + layout.link_begin(link), moved.data(), of_column.data());
            add_block(entries, of_column.data(), size, 1, link * size, link * size + column);
        }
    }
    part.setFromTriplets(entries.begin(), entries.end());
    return part;
}

class SparseSolver final : public LinearSolver {
public:
    explicit SparseSolver(const Sparse& matrix) { lu_.compute(Eigen::SparseMatrix<double>(matrix)); }
    void solve(const double* right, double* x) const override { WriteVector(x, lu_.cols()) = lu_.solve(ReadVector(right, lu_.rows())); }

private:
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
};

}  // namespace

/// Matrices by position have a column for each coordinate.
struct LinearChain::Parts {
    Sparse elastic, frictionless, sliding, damping, friction;
    Sparse link_friction, surface_friction, reaction;  ///< parts of friction: links by links, all by others, others by links
    Sparse held;                                       ///< M⁻¹ K of held links
    std::optional<double> stiffest;
};

LinearChain::LinearChain(const model::Variator& variator, const model::Parameters& parameters, const FrozenStart& start)
    : variator_(variator),
      parameters_(parameters),
      start_(start),
      coordinates_(variator.layout().coordinates()),
      velocities_(coordinates_ + variator.layout().controls),
      link_velocities_(variator.layout().links * variator.layout().link_size()),
      parts_(std::make_unique<Parts>()) {
    const Derivatives all = derivatives_of(variator, start);
    const Derivatives smooth = derivatives_with(variator, parameters, start, 0.0, 1.0);
    Parts& parts = *parts_;
    parts.elastic = all.by_position.leftCols(coordinates_);
    parts.frictionless = smooth.by_position.leftCols(coordinates_);
    parts.sliding = parts.elastic - parts.frictionless;
    parts.damping = smooth.by_velocity;
    parts.friction = all.by_velocity - smooth.by_velocity;
    for (Sparse* part : {&parts.elastic, &parts.frictionless, &parts.sliding, &parts.damping, &parts.friction}) part->prune(0.0);
    const int others = velocities_ - link_velocities_;
    parts.link_friction = parts.friction.block(0, 0, link_velocities_, link_velocities_);
    parts.surface_friction = parts.friction.rightCols(others);
    parts.reaction = parts.friction.block(link_velocities_, 0, others, link_velocities_);
    parts.held = held_part(variator.chain(), start.state.data());
}

double LinearChain::stiffest_friction() const {
    if (!parts_->stiffest) {
        const Derivatives stuck = derivatives_with(variator_, parameters_, start_, 1.0, all_stick);
        const Sparse friction = stuck.by_velocity - parts_->damping;
        parts_->stiffest = all_stick * radius_of(Sparse(friction.block(0, 0, link_velocities_, link_velocities_)));
    }
    return *parts_->stiffest;
}

LinearChain::~LinearChain() = default;

void LinearChain::add_elastic(double factor, const double* q, double* out) const {
    WriteVector(out, velocities_) += factor * (parts_->elastic * ReadVector(q, coordinates_));
}
void LinearChain::add_damping(double factor, const double* v, double* out) const {
    WriteVector(out, velocities_) += factor * (parts_->damping * ReadVector(v, velocities_));
}
void LinearChain::add_friction(double factor, const double* v, double* out) const {
    WriteVector(out, velocities_) += factor * (parts_->friction * ReadVector(v, velocities_));
}
void LinearChain::add_link_friction(double factor, const double* v, double* out) const {
    WriteVector(out, link_velocities_) += factor * (parts_->link_friction * ReadVector(v, link_velocities_));
}
void LinearChain::add_sliding(double factor, const double* q, double* out) const {
    WriteVector(out, velocities_) += factor * (parts_->sliding * ReadVector(q, coordinates_));
}
void LinearChain::add_frictionless(double factor, const double* q, double* out) const {
    WriteVector(out, velocities_) += factor * (parts_->frictionless * ReadVector(q, coordinates_));
}
void LinearChain::add_surface_friction(double factor, const double* v, double* out) const {
    const int others = velocities_ - link_velocities_;
    WriteVector(out, velocities_) += factor * (parts_->surface_friction * ReadVector(v + link_velocities_, others));
}
void LinearChain::add_held(double factor, const double* v, double* out) const {
    WriteVector(out, link_velocities_) += factor * (parts_->held * ReadVector(v, link_velocities_));
}
void LinearChain::add_reaction(double factor, const double* v, double* out) const {
    const int others = velocities_ - link_velocities_;
    WriteVector(out + link_velocities_, others) += factor * (parts_->reaction * ReadVector(v, link_velocities_));
}

std::unique_ptr<LinearSolver> LinearChain::whole_solver(double shift) const {
    Sparse one(velocities_, velocities_);
    one.setIdentity();
    Sparse elastic = parts_->elastic;
    elastic.conservativeResize(velocities_, velocities_);  // I has no coordinate: a column of zeros
    return std::make_unique<SparseSolver>(one - shift * (parts_->damping + parts_->friction) - shift * shift * elastic);
}

std::unique_ptr<LinearSolver> LinearChain::friction_solver(double shift, bool held) const {
    Sparse one(link_velocities_, link_velocities_);
    one.setIdentity();
    if (held) one += shift * shift * parts_->held;
    return std::make_unique<SparseSolver>(one - shift * parts_->link_friction);
}

}  // namespace cvtflow::bench
