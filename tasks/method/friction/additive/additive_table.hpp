#pragma once
/// Additive Runge-Kutta methods: one table for what is taken explicitly, one for what is solved for. Both have the same times and weights,
/// and the implicit one the same γ in every stage but the first, which is explicit.

#include <string>
#include <vector>

namespace cvtflow::tasks {

struct AdditiveTable {
    std::string name, source;
    int order;
    double gamma;                                                   ///< [1]
    std::vector<double> times;                                      ///< c [stages]
    std::vector<std::vector<double>> explicit_part, implicit_part;  ///< a_ij, j < i [stages]; the latter without its diagonal
    std::vector<double> weights;                                    ///< b [stages]
    std::vector<double> embedded;                                   ///< b̂, empty without an error estimate [1]

    [[nodiscard]] int stages() const noexcept { return static_cast<int>(times.size()); }
};

/// ARK4(3)6L[2]SA: order 4, embedded 3. (C. A. Kennedy, M. H. Carpenter, Appl. Numer. Math. 44, 2003)
[[nodiscard]] AdditiveTable ark436();
/// ARS(3,4,3): order 3. (U. M. Ascher, S. J. Ruuth, R. J. Spiteri, Appl. Numer. Math. 25, 1997)
[[nodiscard]] AdditiveTable ars343();

}  // namespace cvtflow::tasks
