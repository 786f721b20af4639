#pragma once
/// The matrix of every implicit stage, in velocities alone: with q = q* + θ v the coordinates are eliminated, which reduces
/// I - θ ∂f/∂y is   G = I - θ D - θ² K   (D, K: derivatives of accelerations with respect to velocities and coordinates; the inertia's
/// inverse is in them). Cyclic block-tridiagonal in links, pulleys and control as border.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bench/method/jacobian/jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

class CyclicBorder;

/// Sheaves that each link touches, by the shaft that its tips were computed with.
struct ContactMap {
    const model::Phase* phases;    ///< [4 links]
    const model::LinkLoad* loads;  ///< [links]
    /// Shaft whose sheaves a link touches, if it touches any.
    [[nodiscard]] std::optional<int> shaft(int link) const noexcept;
};

class ImplicitMatrix {
public:
    explicit ImplicitMatrix(const model::Variator& variator);
    ~ImplicitMatrix();

    [[nodiscard]] int chunks() const noexcept;
    [[nodiscard]] int first(int chunk) const noexcept;  ///< link of a chunk, or behind the last one
    /// Numbers in a right-hand side: velocities link by link, then the border's.
    [[nodiscard]] int unknowns() const noexcept;
    /// Pulley coordinates of a shaft on which the chain depends.
    [[nodiscard]] const std::vector<int>& seen(int shaft) const noexcept { return seen_[static_cast<std::size_t>(shaft)]; }

    /// Enters G for the links of a chunk and eliminates its inner ones. @param theta θ [s]   @param shafts [links] ContactMap::shaft()
    void eliminate(int chunk, double theta, const bench::AccelerationJacobian& jacobian, const std::optional<int>* shafts) noexcept;
    /// Eliminates pulleys and separators, after all chunks. theta [s]
    void join(double theta, const bench::AccelerationJacobian& jacobian) noexcept;
    /// Whether the last factorisation met no vanishing pivot.
    [[nodiscard]] bool sound() const noexcept;

    // The solve, chunk by chunk. @param f, x [velocities]
    void forward(int chunk, const double* f) noexcept;
    void join_solution(const double* f) noexcept;
    void backward(int chunk, double* x) noexcept;

private:
    void find_seen(const model::Variator& variator);
    [[nodiscard]] int list_border(int chunk, const std::optional<int>* shafts, int* list) const noexcept;
    /// theta [s]; border: unknowns that the link's chunk is coupled to, none for a link that touches nothing
    void enter(int link, double theta, const bench::AccelerationJacobian& jacobian, std::span<const int> border) noexcept;

    int links_, size_, border_;
    std::unique_ptr<CyclicBorder> system_;
    std::array<std::vector<int>, 2> seen_;
    std::vector<char> sound_;  ///< [chunks + 1]
    std::vector<int> lists_;   ///< [chunks][border]
};

}  // namespace cvtflow::bench
