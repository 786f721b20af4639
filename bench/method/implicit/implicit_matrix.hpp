#pragma once
/// The matrix of every implicit stage, in velocities alone: with q = q* + θ v the coordinates are eliminated, which reduces
/// I - θ ∂f/∂y is   G = I - θ D - θ² K   (D, K: derivatives of accelerations with respect to velocities and coordinates; the inertia's
/// inverse is in them). Cyclic block-tridiagonal in links, pulleys and control as border.

#include <array>
#include <optional>
#include <vector>

#include "bench/method/jacobian/jacobian.hpp"
#include "bench/method/linear/cyclic_border.hpp"
#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

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

    [[nodiscard]] int chunks() const noexcept { return system_.chunks(); }
    [[nodiscard]] const bench::CyclicBorder::Range& range(int chunk) const noexcept { return system_.range(chunk); }
    /// Numbers in a right-hand side: velocities link by link, then the border's.
    [[nodiscard]] int unknowns() const noexcept { return system_.unknowns(); }
    /// Pulley coordinates of a shaft on which the chain depends.
    [[nodiscard]] const std::vector<int>& seen(int shaft) const noexcept { return seen_[static_cast<std::size_t>(shaft)]; }

    /// Enters G for the links of a chunk and eliminates its inner ones. @param theta θ [s]   @param shafts [links] ContactMap::shaft()
    void eliminate(int chunk, double theta, const bench::AccelerationJacobian& jacobian, const std::optional<int>* shafts) noexcept;
    /// Eliminates pulleys and separators, after all chunks. theta [s]
    void join(double theta, const bench::AccelerationJacobian& jacobian) noexcept;
    /// Whether the last factorisation met no vanishing pivot.
    [[nodiscard]] bool sound() const noexcept;

    /// f [velocities]
    void forward(int chunk, const double* f) noexcept { system_.forward(chunk, f); }
    /// f [velocities]
    void join_solution(const double* f) noexcept { system_.join_solution(f); }
    /// x [velocities]
    void backward(int chunk, double* x) noexcept { system_.backward(chunk, x); }

private:
    void find_seen(const model::Variator& variator);
    [[nodiscard]] int list_border(int chunk, const std::optional<int>* shafts, int* list) const noexcept;
    void enter(int link, double theta, const bench::AccelerationJacobian& jacobian, bool touching) noexcept;  ///< theta [s]

    int links_, size_, border_;
    bench::CyclicBorder system_;
    std::array<std::vector<int>, 2> seen_;
    std::vector<char> sound_;  ///< [chunks + 1]
    std::vector<int> lists_;   ///< [chunks][border]
};

}  // namespace cvtflow::bench
