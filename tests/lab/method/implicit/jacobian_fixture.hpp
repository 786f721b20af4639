#pragma once
/// Jacobians in tests: a small variator that runs under load, and everything an evaluation of its right-hand side leaves (base point of
/// Jacobians); the sparse Jacobian entry by entry, and its difference from a dense one.

#include <string>
#include <vector>

#include "bench/method/jacobian/jacobian.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// The tiny scene with `extra` settings, settled for half a millisecond.
class Settled {
public:
    explicit Settled(const std::vector<std::string>& extra = {});

    [[nodiscard]] const model::Parameters& parameters() const { return scene_.parameters; }
    [[nodiscard]] const model::Variator& variator() const { return variator_; }
    [[nodiscard]] const FrozenStart& start() const { return start_; }
    [[nodiscard]] BasePoint base() const;
    /// Moves every velocity by a pseudo-random amount, so that contacts slip.
    void stir(double amount);
    /// Differences of the whole right-hand side with the steps of ColouredJacobian, one unknown at a time, forward or backward: [size *
    /// size], column by column.
    [[nodiscard]] std::vector<double> dense(double sign = 1.0) const;

private:
    void evaluate();

    Scene scene_;
    model::Variator variator_;
    FrozenStart start_;
    std::vector<double> slope_;
    model::EvaluationScratch scratch_;
};

/// Entry of the sparse form in accelerations `row` and unknown `column` (links, then border) of one kind; 0 where there is none.
[[nodiscard]] double entry(const bench::AccelerationJacobian& jacobian, bench::With with, int row, int column);

/// Largest distance of the sparse form from the range between two dense Jacobians of the whole state [column by column], relative to the
/// largest entry of the same kind in the same part (links on links, links on pulleys, pulleys on links, pulleys on pulleys).
[[nodiscard]] double largest_difference(const model::ChainLayout& layout, const bench::AccelerationJacobian& jacobian,
                                        const std::vector<double>& dense, const std::vector<double>& other);

}  // namespace cvtflow::bench
