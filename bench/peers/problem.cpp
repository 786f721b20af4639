#include "bench/peers/problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace cvtflow::bench {

using bench::Near;
using bench::With;

Problem::Problem(const tasks::Scene& scene, tasks::FrozenStart start, double duration, double interval)
    : variator_(scene.parameters),
      start_(std::move(start)),
      interval_(interval),
      outputs_(static_cast<int>(std::lround(duration / interval))),
      scratch_(variator_.layout()),
      observer_(variator_),
      exact_(variator_),
      blocks_(variator_.layout()) {
    make_pattern();
}

void Problem::slope(double t, const double* state, double* slope) noexcept {
    model::right_hand_side(variator_, t, state, start_.phases.data(), slope, scratch_);
    ++evaluations_;
}

template <class Visit>
void Problem::visit_entries(Visit&& visit) const {
    const model::ChainLayout& at = variator_.layout();
    const int own = at.link_size(), pulleys = at.pulley_size, border = blocks_.border();
    // The place of an unknown of the border: with its rates, the control's integral behind them.
    const auto border_at = [&](int k, With with) {
        return k < pulleys ? at.pulley_begin() + (with == With::velocity ? pulleys : 0) + k : at.control_begin();
    };
    const auto block = [&](int rows, const auto& row_at, int columns, const auto& column_at, const double* values) {
        for (int i = 0; i < rows; ++i) {
            for (int k = 0; k < columns; ++k) visit(row_at(i), column_at(k), values[i * columns + k]);
        }
    };
    const auto accelerations_of_border = [&](int k) { return border_at(k, With::velocity); };
    for (int link = 0; link < at.links; ++link) {
        const auto rows = [&](int i) { return at.link_begin(link) + own + i; };
        for (int i = 0; i < own; ++i) visit(at.link_begin(link) + i, rows(i), 1.0);
        for (const With with : {With::position, With::velocity}) {
            const int shift = with == With::velocity ? own : 0;
            for (const auto& [near, other] : {std::pair{Near::before, at.previous(link)}, {Near::same, link}, {Near::after, at.next(link)}})
                block(
                    own, rows, own, [&, begin = at.link_begin(other) + shift](int k) { return begin + k; }, blocks_.link(link, near, with));
            block(
                own, rows, border, [&](int k) { return border_at(k, with); }, blocks_.columns(link, with));
            block(
                border, accelerations_of_border, own, [&](int k) { return at.link_begin(link) + shift + k; }, blocks_.rows(link, with));
        }
    }
    for (int k = 0; k < pulleys; ++k) visit(at.pulley_begin() + k, at.pulley_begin() + pulleys + k, 1.0);
    for (const With with : {With::position, With::velocity})
        block(
            border, accelerations_of_border, border, [&](int k) { return border_at(k, with); }, blocks_.corner(with));
    for (int k = 0; k < at.size(); ++k) visit(k, k, 0.0);  // I - γJ has a diagonal
}

void Problem::make_pattern() {
    std::vector<std::set<int>> columns(static_cast<std::size_t>(size()));
    visit_entries([&](int row, int column, double) { columns[static_cast<std::size_t>(column)].insert(row); });
    std::map<std::pair<int, int>, int> place;
    for (int column = 0; column < size(); ++column) {
        pattern_.begin.push_back(static_cast<int>(pattern_.row.size()));
        for (const int row : columns[static_cast<std::size_t>(column)]) {
            place[{row, column}] = static_cast<int>(pattern_.row.size());
            pattern_.row.push_back(row);
        }
    }
    pattern_.begin.push_back(static_cast<int>(pattern_.row.size()));
    visit_entries([&](int row, int column, double) { place_.push_back(place.at({row, column})); });
}

void Problem::jacobian(double t, const double* state, double* values) noexcept {
    exact_.links(state, start_.phases.data(), 0, variator_.layout().links, blocks_);
    exact_.corner(t, state, start_.phases.data(), blocks_);
    std::fill_n(values, pattern_.row.size(), 0.0);
    const int* place = place_.data();
    visit_entries([&](int, int, double value) { values[*place++] += value; });
}

bool Problem::is_rate(int unknown) const noexcept {
    const model::ChainLayout& at = variator_.layout();
    if (unknown < at.pulley_begin()) return unknown % at.link_block() >= at.link_size();
    return unknown >= at.pulley_begin() + at.pulley_size && unknown < at.control_begin();
}

std::vector<double> Problem::sizes() const {
    const int coordinates_end = variator_.layout().control_begin();
    std::vector<double> sizes(static_cast<std::size_t>(size()), 1.0);
    for (int k = 0; k < coordinates_end; ++k) sizes[static_cast<std::size_t>(k)] = is_rate(k) ? 1e-2 : 1e-6;
    return sizes;
}

void Problem::observe(double t, const double* state, Trajectory& trajectory) {
    const model::Observation& seen = observer_.observe(t, state, start_.phases.data());
    trajectory.times.push_back(t);
    trajectory.axial_force.push_back(seen.tip_axial);
    trajectory.tension.push_back(seen.tension);
}

}  // namespace cvtflow::bench
