/// Inertia of links (dense) and pulleys (diagonal), and the solve (EQUATIONS.md, section 2).

#include "tests/oracle/legendre.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <algorithm>

namespace cvtflow::oracle {

using model::End;

namespace {

using Matrix = std::vector<std::vector<Real>>;

/// Basis functions of one direction of a half at ξ, with the offsets of their coordinates in a link's q.
struct Basis {
    std::vector<int> rear, front;  ///< offsets
    std::vector<Real> value;
};

std::vector<Basis> bases_at(const model::ChainLayout& layout, Real xi) {
    Basis x, y;
    for (int m = 0; m < layout.lateral(); ++m) {
        x.rear.push_back(layout.x(End::rear, m));
        x.front.push_back(layout.x(End::front, m));
        y.rear.push_back(layout.y(End::rear, m));
        y.front.push_back(layout.y(End::front, m));
        x.value.push_back(legendre(m, xi));
        y.value.push_back(legendre(m, xi));
    }
    const Basis z{{layout.z(End::rear), layout.e(End::rear)}, {layout.z(End::front), layout.e(End::front)}, {1.0L, xi}};
    return {x, y, z};
}

void add_plate_inertia(Matrix& matrix, const Basis& basis, Real mass) {
    const std::size_t n = basis.value.size();
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t c = 0; c < n; ++c) {
            const Real product = mass * basis.value[r] * basis.value[c];
            matrix[basis.rear[r]][basis.rear[c]] += product / 3.0L;
            matrix[basis.front[r]][basis.front[c]] += product / 3.0L;
            matrix[basis.rear[r]][basis.front[c]] += product / 6.0L;
            matrix[basis.front[r]][basis.rear[c]] += product / 6.0L;
        }
    }
}

Matrix half_inertia(const System& system) {
    const auto& layout = system.layout;
    const Real mass = system.parameters.half.mass;
    Matrix matrix(layout.link_size(), std::vector<Real>(layout.link_size(), 0.0L));
    for (const End end : {End::rear, End::front}) {
        for (int m = 0; m < layout.lateral(); ++m) {
            matrix[layout.x(end, m)][layout.x(end, m)] = mass / (2 * m + 1);
            matrix[layout.y(end, m)][layout.y(end, m)] = mass / (2 * m + 1);
        }
        matrix[layout.z(end)][layout.z(end)] = mass;
        matrix[layout.e(end)][layout.e(end)] = mass / 3.0L;
    }
    for (const PlateSpring& plate : plate_springs(system.parameters)) {
        for (const Basis& basis : bases_at(layout, plate.xi)) add_plate_inertia(matrix, basis, plate.mass);
    }
    return matrix;
}

Matrix rigid_inertia(const System& system) {
    const std::vector<Real> diagonal = pin_inertia(system);
    Matrix matrix(diagonal.size(), std::vector<Real>(diagonal.size(), 0.0L));
    for (std::size_t k = 0; k < diagonal.size(); ++k) matrix[k][k] = diagonal[k];
    return matrix;
}

Matrix link_inertia(const System& system) { return system.layout.rigid ? rigid_inertia(system) : half_inertia(system); }

/// Gaussian elimination without pivoting: the matrix is positive definite.
std::vector<Real> solve(Matrix matrix, std::vector<Real> right) {
    const int n = static_cast<int>(right.size());
    for (int column = 0; column < n; ++column) {
        for (int row = column + 1; row < n; ++row) {
            const Real factor = matrix[row][column] / matrix[column][column];
            for (int k = column; k < n; ++k) matrix[row][k] -= factor * matrix[column][k];
            right[row] -= factor * right[column];
        }
    }
    for (int row = n - 1; row >= 0; --row) {
        for (int k = row + 1; k < n; ++k) right[row] -= matrix[row][k] * right[k];
        right[row] /= matrix[row][row];
    }
    return right;
}

/// Diagonal of the pulleys' inertia in the order of their coordinates.
std::vector<Real> pulley_diagonal(const model::Parameters& parameters) {
    const auto& p = parameters.pulley;
    const Real added[] = {parameters.drive.inertia, parameters.load.inertia};
    std::vector<Real> diagonal;
    if (parameters.detail.pulleys == model::PulleyDetail::elastic) {
        for (const int shaft : {0, 1}) {
            const Real values[] = {p.shaft_mass,         p.shaft_mass, p.shaft_tilt_inertia,
                                   p.shaft_tilt_inertia, p.shaft_mass, p.shaft_polar_inertia + added[shaft]};
            diagonal.insert(diagonal.end(), std::begin(values), std::end(values));
        }
        for (int sheave = 0; sheave < 4; ++sheave) {
            const Real values[] = {p.sheave_mass,         p.sheave_mass, p.sheave_tilt_inertia,
                                   p.sheave_tilt_inertia, p.sheave_mass, p.sheave_polar_inertia};
            diagonal.insert(diagonal.end(), std::begin(values), std::end(values));
        }
    }
    if (parameters.detail.pulleys == model::PulleyDetail::rigid) {
        for (const int shaft : {0, 1}) diagonal.push_back(p.shaft_polar_inertia + 2.0L * p.sheave_polar_inertia + added[shaft]);
        diagonal.insert(diagonal.end(), 2, Real{p.sheave_mass});
    }
    return diagonal;
}

/// Unbalance U of a sheave at the angle φ: its mass is at (u_x, u_y) + (U/m) (cos φ, sin φ).
struct Unbalance {
    int body = 0;  ///< first coordinate of the sheave among the pulleys'
    Vec2 at;       ///< U (cos φ, sin φ) [kg·m]
    Real spin = 0.0L;
};

Unbalance unbalance_of(const System& system) {
    const auto& i = system.parameters.imperfection;
    const int sheave = static_cast<int>(i.sheave), number = model::sheave_body(sheave / 2, sheave % 2);
    const Real angle = system.body[number].phi;
    return {6 * number, Real{i.unbalance} * Vec2{std::cos(angle), std::sin(angle)}, system.body[number].phi_rate};
}

Matrix pulley_inertia(const System& system) {
    const std::vector<Real> diagonal = pulley_diagonal(system.parameters);
    Matrix matrix(diagonal.size(), std::vector<Real>(diagonal.size(), 0.0L));
    for (std::size_t k = 0; k < diagonal.size(); ++k) matrix[k][k] = diagonal[k];
    if (system.parameters.imperfection.unbalance == 0.0) return matrix;
    const auto [body, at, spin] = unbalance_of(system);
    const int x = body, y = body + 1, phi = body + 5;
    matrix[x][phi] = matrix[phi][x] = -at.y;
    matrix[y][phi] = matrix[phi][y] = at.x;
    return matrix;
}

}  // namespace

std::vector<Real> accelerations(const System& system, std::span<const Real> forces) {
    const auto& layout = system.layout;
    const Matrix matrix = link_inertia(system);
    std::vector<Real> result;
    for (int i = 0; i < layout.links; ++i) {
        const auto of_link = forces.subspan(i * layout.link_size(), layout.link_size());
        for (const Real a : solve(matrix, {of_link.begin(), of_link.end()})) result.push_back(a);
    }
    const auto on_pulleys = forces.subspan(result.size(), layout.pulley_size);
    std::vector<Real> right(on_pulleys.begin(), on_pulleys.end());
    if (system.parameters.imperfection.unbalance != 0.0) {
        const auto [body, at, spin] = unbalance_of(system);
        right[body] += spin * spin * at.x;
        right[body + 1] += spin * spin * at.y;
    }
    for (const Real a : solve(pulley_inertia(system), right)) result.push_back(a);
    return result;
}

Real kinetic_energy(const System& system, std::span<const Real> state) {
    const auto& layout = system.layout;
    const Matrix matrix = link_inertia(system);
    Real sum = 0.0L;
    for (int i = 0; i < layout.links; ++i) {
        const auto v = state.subspan(layout.link_begin(i) + layout.link_size(), layout.link_size());
        for (int r = 0; r < layout.link_size(); ++r) {
            for (int c = 0; c < layout.link_size(); ++c) sum += 0.5L * v[r] * matrix[r][c] * v[c];
        }
    }
    const auto v = state.subspan(layout.pulley_begin() + layout.pulley_size, layout.pulley_size);
    const Matrix of_pulleys = pulley_inertia(system);
    for (int r = 0; r < layout.pulley_size; ++r) {
        for (int c = 0; c < layout.pulley_size; ++c) sum += 0.5L * v[r] * of_pulleys[r][c] * v[c];
    }
    return sum;
}

}  // namespace cvtflow::oracle
