#include "bench/method/implicit/implicit_matrix.hpp"

#include <algorithm>

#include "bench/method/implicit/cyclic_border.hpp"

namespace cvtflow::bench {

namespace {

using bench::AccelerationJacobian;
using bench::Near;
using bench::With;

/// Links between two separators, about: short enough to keep many workers busy, long enough that separators stay few.
constexpr int links_per_chunk = 8;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// -θ D - θ² K of rows of D and K.
template <typename Place>
void enter_block(Place&& out, double theta, const double* d, const double* k) {
    const Eigen::Map<const RowMajor> of_velocity(d, out.rows(), out.cols()), of_position(k, out.rows(), out.cols());
    out = -theta * of_velocity - theta * theta * of_position;
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
      system_(std::make_unique<CyclicBorder>(links_, size_, border_, std::max(1, links_ / links_per_chunk))),
      sound_(static_cast<std::size_t>(chunks() + 1), 0),
      lists_(static_cast<std::size_t>(chunks() * border_)) {
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

/// Border unknowns that the links of a chunk are coupled to.
int ImplicitMatrix::list_border(int chunk, const std::optional<int>* shafts, int* list) const noexcept {
    std::array<bool, 2> touched{};
    for (int link = first(chunk); link < first(chunk + 1); ++link) {
        if (const auto shaft = shafts[link]) touched[static_cast<std::size_t>(*shaft)] = true;
    }
    int count = 0;
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        if (touched[shaft]) count = static_cast<int>(std::copy(seen_[shaft].begin(), seen_[shaft].end(), list + count) - list);
    }
    return count;
}

void ImplicitMatrix::enter(int link, double theta, const AccelerationJacobian& j, std::span<const int> border) noexcept {
    const auto entries = [&](Near near, auto&& place) {
        enter_block(place, theta, j.link(link, near, With::velocity), j.link(link, near, With::position));
    };
    entries(Near::before, system_->lower(link));
    entries(Near::same, system_->diagonal(link));
    system_->diagonal(link).diagonal().array() += 1.0;
    CyclicBorder::Part columns = system_->columns(link), rows = system_->rows(link);
    for (std::size_t k = 0; k < border.size(); ++k) {
        const auto place = static_cast<Eigen::Index>(k);
        const auto column = [&](With with) { return Eigen::Map<const RowMajor>(j.columns(link, with), size_, border_).col(border[k]); };
        columns.col(place) = -theta * column(With::velocity) - theta * theta * column(With::position);
        const int at = border[k] * size_;
        enter_block(rows.row(place), theta, j.rows(link, With::velocity) + at, j.rows(link, With::position) + at);
    }
}

void ImplicitMatrix::eliminate(int chunk, double theta, const AccelerationJacobian& j, const std::optional<int>* shafts) noexcept {
    int* list = lists_.data() + chunk * border_;
    const std::span<const int> border(list, static_cast<std::size_t>(list_border(chunk, shafts, list)));
    system_->clear(chunk, border);
    const int begin = first(chunk), end = first(chunk + 1);
    const auto enter_upper = [&](int link) {
        enter_block(system_->upper(link), theta, j.link(link, Near::after, With::velocity), j.link(link, Near::after, With::position));
    };
    enter_upper(begin == 0 ? links_ - 1 : begin - 1);  // of the separator before
    for (int link = begin; link < end; ++link) {
        enter(link, theta, j, shafts[link].has_value() ? border : std::span<const int>{});
        if (link + 1 < end) enter_upper(link);
    }
    sound_[static_cast<std::size_t>(chunk)] = system_->eliminate(chunk);
}

void ImplicitMatrix::join(double theta, const AccelerationJacobian& j) noexcept {
    enter_block(system_->corner(), theta, j.corner(With::velocity), j.corner(With::position));
    system_->corner().diagonal().array() += 1.0;
    sound_.back() = false;
    if (std::all_of(sound_.begin(), sound_.end() - 1, [](char good) { return good != 0; })) sound_.back() = system_->join();
}

int ImplicitMatrix::chunks() const noexcept { return system_->chunks(); }

int ImplicitMatrix::first(int chunk) const noexcept { return system_->first(chunk); }

int ImplicitMatrix::unknowns() const noexcept { return system_->unknowns(); }

void ImplicitMatrix::forward(int chunk, const double* f) noexcept { system_->forward(chunk, f); }

void ImplicitMatrix::join_solution(const double* f) noexcept { system_->join_solution(f); }

void ImplicitMatrix::backward(int chunk, double* x) noexcept { system_->backward(chunk, x); }

ImplicitMatrix::~ImplicitMatrix() = default;

bool ImplicitMatrix::sound() const noexcept { return sound_.back() != 0; }

}  // namespace cvtflow::bench
