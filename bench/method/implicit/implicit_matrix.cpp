#include "bench/method/implicit/implicit_matrix.hpp"

#include <algorithm>

namespace cvtflow::bench {

namespace {

using bench::AccelerationJacobian;
using bench::Near;
using bench::With;

/// Links between two separators, about: short enough to keep many workers busy, long enough that separators stay few.
constexpr int links_per_chunk = 8;

/// out = -θ D - θ² K, element by element; rows of D and K are `columns` apart.
void enter_block(int rows, int columns, double theta, const double* d, const double* k, double* out, int stride) noexcept {
    const double square = theta * theta;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column)
            out[row * stride + column] = -theta * d[row * columns + column] - square * k[row * columns + column];
    }
}

[[nodiscard]] bool same(const model::SheaveMotion& a, const model::SheaveMotion& b) noexcept {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.tilt_x == b.tilt_x && a.tilt_y == b.tilt_y && a.vx == b.vx && a.vy == b.vy &&
           a.vz == b.vz && a.spin_x == b.spin_x && a.spin_y == b.spin_y && a.spin_z == b.spin_z;
}

}  // namespace

std::optional<int> ContactMap::shaft(int link) const noexcept {
    const model::Phase* tips = phases + model::tips_per_link * link;
    const bool touches = std::any_of(tips, tips + model::tips_per_link, [](model::Phase phase) { return phase != model::Phase::free; });
    return touches ? std::optional(loads[link].shaft) : std::nullopt;
}

ImplicitMatrix::ImplicitMatrix(const model::Variator& variator)
    : links_(variator.layout().links),
      size_(variator.layout().link_size()),
      border_(variator.layout().pulley_size + variator.layout().controls),
      system_(links_, size_, border_, std::max(1, links_ / links_per_chunk)),
      sound_(static_cast<std::size_t>(system_.chunks() + 1), 0),
      lists_(static_cast<std::size_t>(system_.chunks() * border_)) {
    if (variator.layout().pulley_size != 0) find_seen(variator);
}

/// A coordinate is seen by a shaft's links if moving it, or its velocity, moves one of the shaft's sheaves.
void ImplicitMatrix::find_seen(const model::Variator& variator) {
    const int half = variator.layout().pulley_size;
    std::vector<double> block(static_cast<std::size_t>(2 * half), 0.0);
    model::SheaveMotion rest[4], moved[4];
    variator.pulleys().motions(block.data(), rest);
    for (int coordinate = 0; coordinate < half; ++coordinate) {
        const auto k = static_cast<std::size_t>(coordinate);
        block[k] = block[k + static_cast<std::size_t>(half)] = 1.0;
        variator.pulleys().motions(block.data(), moved);
        block[k] = block[k + static_cast<std::size_t>(half)] = 0.0;
        for (std::size_t shaft = 0; shaft < 2; ++shaft) {
            if (!same(moved[2 * shaft], rest[2 * shaft]) || !same(moved[2 * shaft + 1], rest[2 * shaft + 1]))
                seen_[shaft].push_back(coordinate);
        }
    }
}

/// Border unknowns that the inner links of a chunk are coupled to.
int ImplicitMatrix::list_border(int chunk, const std::optional<int>* shafts, int* list) const noexcept {
    std::array<bool, 2> touched{};
    for (int link = range(chunk).first; link + 1 < range(chunk).last; ++link) {
        if (const auto shaft = shafts[link]) touched[static_cast<std::size_t>(*shaft)] = true;
    }
    int count = 0;
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        if (touched[shaft]) count = static_cast<int>(std::copy(seen_[shaft].begin(), seen_[shaft].end(), list + count) - list);
    }
    return count;
}

void ImplicitMatrix::enter(int link, double theta, const AccelerationJacobian& j, bool touching) noexcept {
    const bench::CyclicBorder::Block block = system_.block(link);
    const auto part = [&](Near near, double* out) {
        enter_block(size_, size_, theta, j.link(link, near, With::velocity), j.link(link, near, With::position), out, size_);
    };
    part(Near::before, block.lower);
    part(Near::same, block.diagonal);
    for (int k = 0; k < size_; ++k) block.diagonal[k * size_ + k] += 1.0;
    if (!touching) return;
    const double square = theta * theta;
    for (std::size_t c = 0; c < block.border.size(); ++c) {
        const int unknown = block.border[c], place = static_cast<int>(c);
        for (int row = 0; row < size_; ++row) {
            const int at = row * border_ + unknown;
            block.columns[row * block.columns_stride + place] =
                -theta * j.columns(link, With::velocity)[at] - square * j.columns(link, With::position)[at];
        }
        const int at = unknown * size_;
        enter_block(1, size_, theta, j.rows(link, With::velocity) + at, j.rows(link, With::position) + at, block.rows + place * size_,
                    size_);
    }
}

void ImplicitMatrix::eliminate(int chunk, double theta, const AccelerationJacobian& j, const std::optional<int>* shafts) noexcept {
    int* list = lists_.data() + chunk * border_;
    const int count = list_border(chunk, shafts, list);
    system_.clear(chunk, {list, static_cast<std::size_t>(count)});
    const auto& bounds = range(chunk);
    const auto enter_upper = [&](int link) {
        const bench::CyclicBorder::Block block = system_.block(link);
        enter_block(size_, size_, theta, j.link(link, Near::after, With::velocity), j.link(link, Near::after, With::position), block.upper,
                    block.upper_stride);
    };
    enter_upper(bounds.first == 0 ? links_ - 1 : bounds.first - 1);  // of the separator before
    for (int link = bounds.first; link < bounds.last; ++link) {
        enter(link, theta, j, shafts[link].has_value());
        if (link + 1 < bounds.last) enter_upper(link);
    }
    sound_[static_cast<std::size_t>(chunk)] = system_.eliminate(chunk);
}

void ImplicitMatrix::join(double theta, const AccelerationJacobian& j) noexcept {
    if (border_ != 0) {
        enter_block(border_, border_, theta, j.corner(With::velocity), j.corner(With::position), system_.corner(), border_);
        for (int k = 0; k < border_; ++k) system_.corner()[k * border_ + k] += 1.0;
    }
    sound_.back() = false;
    if (std::all_of(sound_.begin(), sound_.end() - 1, [](char good) { return good != 0; })) sound_.back() = system_.join();
}

bool ImplicitMatrix::sound() const noexcept { return sound_.back() != 0; }

}  // namespace cvtflow::bench
