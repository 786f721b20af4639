#pragma once
/// Elimination of the inner joints of a chain by Cholesky, block by block.

#include <algorithm>
#include <cmath>

#include "model/friction/slip_space.hpp"

namespace cvtflow::model {
namespace {

/// Size: unknowns of a joint, a constant for the compiler; 0: read from the chain.
template <int Size>
class SlipElimination {
public:
    explicit SlipElimination(SlipChain& chain) noexcept : c_(chain) {}

    void condense() noexcept {
        const int count = elements();
        std::copy_n(element(0).row(0), size() * width(), c_.condensed.row(0));
        if (count == 1) {
            std::copy_n(element(0).row(size()), size() * width(), c_.condensed.row(size()));
            return;
        }
        double next[most * most_width];   // rows of the joint that is next: [on left | on itself | right-hand side]
        begin(next);
        for (int joint = 1; joint < count; ++joint) {
            pivot(joint, next);
            reduce(joint, next);
        }
        end(next);
    }

    /// Inner joints from those at the ends.
    void substitute() noexcept {
        const double* left = solution(0);
        for (int joint = elements() - 1; joint >= 1; --joint) {
            double* x = solution(joint);
            const double* next = solution(joint + 1);
            for (int row = 0; row < size(); ++row) {
                const double* p = panel(joint) + row * width();
                x[row] = p[2 * size()];
                for (int k = 0; k < size(); ++k) x[row] = x[row] - p[k] * left[k] - p[size() + k] * next[k];
            }
            backward(factor(joint), x);
        }
    }

    /// Both ends are one joint: solves for it, and all others.
    void close() noexcept {
        condense();
        double matrix[most * most];
        double* x = solution(0);
        for (int row = 0; row < size(); ++row) {
            const double *left = c_.condensed.row(row), *right = c_.condensed.row(size() + row);
            for (int k = 0; k < size(); ++k) matrix[row * size() + k] = (row == k ? 1.0 : 0.0) + (left[k] + left[size() + k]) + (right[k] + right[size() + k]);
            x[row] = left[2 * size()] + right[2 * size()];
        }
        factorise(matrix);
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < row; ++k) x[row] -= matrix[row * size() + k] * x[k];
            x[row] *= matrix[row * size() + row];
        }
        backward(matrix, x);
        std::copy_n(x, size(), solution(elements()));
        substitute();
    }

private:
    static constexpr int most = Size > 0 ? Size : 2 * most_joint_lanes;
    static constexpr int most_width = (2 * most + 8) / 8 * 8;

    [[nodiscard]] int size() const noexcept { return Size > 0 ? Size : c_.size; }
    [[nodiscard]] int width() const noexcept { return Size > 0 ? most_width : c_.condensed.width; }
    [[nodiscard]] int elements() const noexcept { return static_cast<int>(c_.elements.size()); }
    [[nodiscard]] const SlipElement& element(int number) const noexcept { return c_.elements[static_cast<std::size_t>(number)]; }
    [[nodiscard]] double* factor(int joint) noexcept { return c_.factors.data() + joint * size() * size(); }
    [[nodiscard]] double* panel(int joint) noexcept { return c_.panels.data() + joint * size() * width(); }
    [[nodiscard]] double* solution(int joint) noexcept { return c_.solution.data() + joint * size(); }

    /// Rows of joint 1, as element 0 leaves them.
    void begin(double* next) const noexcept {
        for (int row = 0; row < size(); ++row) std::copy_n(element(0).row(size() + row), width(), next + row * width());
    }

    /// Factor of a joint's diagonal block, and its rows on left, next and right-hand side through it.
    void pivot(int joint, const double* rows) noexcept {
        double* diagonal = factor(joint);
        double* p = panel(joint);
        for (int row = 0; row < size(); ++row) {
            const double *before = rows + row * width(), *after = element(joint).row(row);
            double *own = p + row * width(), *d = diagonal + row * size();
            for (int k = 0; k < size(); ++k) {
                d[k] = (row == k ? 1.0 : 0.0) + (before[size() + k] + after[k]);
                own[k] = before[k];
                own[size() + k] = after[size() + k];
            }
            own[2 * size()] = before[2 * size()] + after[2 * size()];
            for (int k = 2 * size() + 1; k < width(); ++k) own[k] = 0.0;
        }
        factorise(diagonal);
        for (int row = 0; row < size(); ++row) {
            double* own = p + row * width();
            for (int k = 0; k < row; ++k) subtract(diagonal[row * size() + k], p + k * width(), own);
            const double scale = diagonal[row * size() + row];
            for (int k = 0; k < width(); ++k) own[k] *= scale;
        }
    }

    /// What the joint leaves on the left end and on the next joint.
    void reduce(int joint, double* next) noexcept {
        const double* p = panel(joint);
        for (int row = 0; row < size(); ++row) {
            double left[most_width] = {};
            double* own = next + row * width();
            std::copy_n(element(joint).row(size() + row), width(), own);
            std::fill_n(own, size(), 0.0);   // the element's rows on the joint itself have gone into the panel
            for (int k = 0; k < size(); ++k) {
                subtract(p[k * width() + row], p + k * width(), left);
                subtract(p[k * width() + size() + row], p + k * width(), own);
            }
            double* at_left = c_.condensed.row(row);
            for (int k = 0; k < size(); ++k) at_left[k] += left[k];
            at_left[2 * size()] += left[2 * size()];
        }
    }

    /// Rows of the right end, and the left one's columns on it.
    void end(const double* next) noexcept {
        for (int row = 0; row < size(); ++row) {
            std::copy_n(next + row * width(), width(), c_.condensed.row(size() + row));
            for (int k = 0; k < size(); ++k) c_.condensed.row(k)[size() + row] = next[row * width() + k];
        }
    }

    void subtract(double factor_of, const double* from, double* own) const noexcept {
        for (int k = 0; k < width(); ++k) own[k] -= factor_of * from[k];
    }

    /// Cholesky in place, lower triangle; the diagonal holds inverses.
    void factorise(double* a) const noexcept {
        for (int row = 0; row < size(); ++row) {
            for (int column = 0; column < row; ++column) {
                double value = a[row * size() + column];
                for (int k = 0; k < column; ++k) value -= a[row * size() + k] * a[column * size() + k];
                a[row * size() + column] = value * a[column * size() + column];
            }
            double value = a[row * size() + row];
            for (int k = 0; k < row; ++k) value -= a[row * size() + k] * a[row * size() + k];
            a[row * size() + row] = 1.0 / std::sqrt(value);
        }
    }

    void backward(const double* l, double* x) const noexcept {
        for (int row = size() - 1; row >= 0; --row) {
            for (int k = row + 1; k < size(); ++k) x[row] -= l[k * size() + row] * x[k];
            x[row] *= l[row * size() + row];
        }
    }

    SlipChain& c_;
};

}  // namespace
}  // namespace cvtflow::model
