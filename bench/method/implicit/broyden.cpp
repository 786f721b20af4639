#include "bench/method/implicit/broyden.hpp"

#include <algorithm>
#include <cmath>

#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

namespace {

[[nodiscard]] double dot(int size, const double* a, const double* b) noexcept {
    double sum = 0.0;
    for (int k = 0; k < size; ++k) sum += a[k] * b[k];
    return sum;
}

}  // namespace

Broyden::Broyden(int unknowns, int most)
    : unknowns_(unknowns), most_(most), steps_(static_cast<std::size_t>(unknowns * most)), updates_(steps_) {}

void Broyden::apply(double* x, int from) const noexcept {
    for (int k = from; k < count_; ++k) {
        const double share = dot(unknowns_, steps_.data() + k * unknowns_, x);
        const double* u = updates_.data() + k * unknowns_;
        for (int i = 0; i < unknowns_; ++i) x[i] += share * u[i];
    }
}

void Broyden::add(const double* s, const double* w) noexcept {
    const double along = dot(unknowns_, s, w);
    if (full() || !std::isfinite(along) || std::abs(along) < 1e-8 * dot(unknowns_, s, s)) return;
    std::copy_n(s, unknowns_, steps_.data() + count_ * unknowns_);
    double* u = updates_.data() + count_ * unknowns_;
    for (int i = 0; i < unknowns_; ++i) u[i] = (s[i] - w[i]) / along;
    ++count_;
}

void Broyden::save(std::vector<double>& memory) const {
    memory.push_back(count_);
    for (const std::vector<double>* part : {&steps_, &updates_})
        memory.insert(memory.end(), part->begin(), part->begin() + count_ * unknowns_);
}

std::span<const double> Broyden::load(std::span<const double> memory) {
    count_ = pop_integer(memory, 0, static_cast<int>(steps_.size()) / std::max(1, unknowns_));
    for (std::vector<double>* part : {&steps_, &updates_})
        std::ranges::copy(pop_front(memory, static_cast<std::size_t>(count_ * unknowns_)), part->begin());
    return memory;
}

}  // namespace cvtflow::bench
