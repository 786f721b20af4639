#include "bench/method/implicit/implicit_method.hpp"

#include <algorithm>
#include <string>

#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

namespace {

/// Shares of a Jacobian: coarse tasks, some more than there are cores in a workstation.
constexpr int max_batches = 32;

/// Represents a link that touches no shaft in saved numbers.
constexpr int no_shaft = -1;

/// Fields of these cycles, numbered behind those of the step graph. Units: link, batch or chunk.
enum ImplicitField { jacobian_field = 1000, chunk_field, joint_field, right_side_field, increment_field };

[[nodiscard]] std::string numbered(const char* name, int number) { return std::string(name) + "[" + std::to_string(number) + "]"; }

/// Tasks that factor the matrix and solve with it, chunk by chunk.
void add_solution(ImplicitMethod& method, const ImplicitMatrix& matrix, int links, engine::TaskGraph& graph) {
    const int chunks = matrix.chunks();
    const std::vector<engine::Access> all{{chunk_field, 0, chunks, true}, {joint_field, 0, 1, true}};
    const int join = graph.add({"join", factor_cycle, engine::code_of<&ImplicitMethod::join>(method), 0, all});
    const int join_solution = graph.add({"join", solve_cycle, engine::code_of<&ImplicitMethod::join_solution>(method), 0, all});
    const engine::TaskCode eliminate = engine::code_of<&ImplicitMethod::eliminate>(method),
                           forward = engine::code_of<&ImplicitMethod::forward>(method),
                           backward = engine::code_of<&ImplicitMethod::backward>(method);
    for (int c = 0; c < chunks; ++c) {
        const int first = matrix.first(c), last = matrix.first(c + 1);
        const engine::Access chunk{chunk_field, c, c + 1, true}, right{right_side_field, first, last, false};
        const std::vector<engine::Access> back{
            {chunk_field, c, c + 1, false}, {joint_field, 0, 1, false}, {increment_field, first, last, true}};
        graph.order(graph.add({numbered("eliminate", c), factor_cycle, eliminate, c, {{jacobian_field, 0, links, false}, chunk}}), join);
        graph.order(graph.add({numbered("forward", c), solve_cycle, forward, c, {right, chunk}}), join_solution);
        graph.order(join_solution, graph.add({numbered("backward", c), solve_cycle, backward, c, back}));
    }
}

}  // namespace

ImplicitMethod::ImplicitMethod(Workspace& workspace)
    : w_(workspace),
      size_(w_.layout().link_size()),
      half_(w_.layout().pulley_size),
      border_size_(half_ + w_.layout().controls),
      q_tail_(w_.layout().pulley_begin()),
      jacobian_(w_.layout()),
      matrix_(w_.variator),
      shafts_(static_cast<std::size_t>(w_.layout().links)),
      right_side_(static_cast<std::size_t>(matrix_.unknowns())),
      solution_(right_side_),
      differences_(w_.variator, max_batches),
      derivatives_(w_.variator) {}

void ImplicitMethod::add_tasks(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s) {
        const Segment& bounds = w_.partition[s];
        const engine::TaskCode prepare = engine::code_of<&ImplicitMethod::prepare>(*this),
                               update = engine::code_of<&ImplicitMethod::update>(*this);
        graph.add({numbered("prepare", s), prepare_cycle, prepare, s, {{right_side_field, bounds.first, bounds.last, true}}});
        graph.add({numbered("update", s), update_cycle, update, s, {{jacobian_field, bounds.first, bounds.last, true}}});
    }
    const int links = w_.layout().links;
    const engine::TaskCode batch = engine::code_of<&ImplicitMethod::jacobian_batch>(*this),
                           corner_of = engine::code_of<&ImplicitMethod::jacobian_corner>(*this);
    const int corner = graph.add({"corner", jacobian_cycle, corner_of, 0, {{jacobian_field, 0, links, true}}});
    for (int b = 0; b < differences_.batches(); ++b)
        graph.order(graph.add({numbered("jacobian", b), jacobian_cycle, batch, b, {{jacobian_field, b, b + 1, true}}}), corner);
    add_solution(*this, matrix_, links, graph);
}

void ImplicitMethod::jacobian_batch(int batch) noexcept {
    if (!exact_) return differences_.evaluate(batch, base_, jacobian_);
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(w_.layout().links) * k / differences_.batches()); };
    derivatives_.links(base_.state, base_.phases, cut(batch), cut(batch + 1), jacobian_);
}

void ImplicitMethod::jacobian_corner() noexcept {
    if (exact_) derivatives_.corner(base_.time, base_.state, base_.phases, jacobian_);
}

void ImplicitMethod::eliminate(int chunk) noexcept { matrix_.eliminate(chunk, theta_, jacobian_, shafts_.data()); }

void ImplicitMethod::join() noexcept { matrix_.join(theta_, jacobian_); }

void ImplicitMethod::backward(int chunk) noexcept {
    matrix_.backward(chunk, solution_.data());
    if (finish_in_tasks_) finish(matrix_.first(chunk), matrix_.first(chunk + 1));
}

int ImplicitMethod::evaluate(std::span<const engine::Term> states, double c, int slope_slot, int keep) noexcept {
    w_.step.evaluate_end = false;
    w_.step.row = {states, {}, keep, slope_slot, c};
    w_.step.slope_out = w_.slopes[slope_slot];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.step.row, w_.step.h, w_.slots(), q_tail_, at.size(), w_.pulleys.tail.data());
    if (keep >= 0) std::copy(w_.pulleys.tail.begin(), w_.pulleys.tail.end(), state(keep) + q_tail_);
    if (half_ != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
    return evaluate_cycle;
}

int ImplicitMethod::take_jacobian(double c, int state_slot, int slope_slot) noexcept {
    base_ = {w_.step.time + c * w_.step.h, state(state_slot),     w_.slopes[slope_slot],
             w_.tips.phases.data(),        w_.links.loads.data(), w_.links.accounts.data()};
    ++jacobians_;
    if (!exact_) w_.step.evaluations += differences_.groups();
    return jacobian_cycle;
}

int ImplicitMethod::factorise(double theta) noexcept {
    theta_ = theta;
    const ContactMap contacts{w_.tips.phases.data(), w_.links.loads.data()};
    for (int link = 0; link < w_.layout().links; ++link) shafts_[static_cast<std::size_t>(link)] = contacts.shaft(link);
    ++factorisations_;
    return factor_cycle;
}

void ImplicitMethod::visit_factors(engine::Archive& archive) {
    archive("theta", theta_);
    for (std::optional<int>& shaft : shafts_) {
        int number = shaft.value_or(no_shaft);
        archive("shaft", number, no_shaft, 1);
        shaft = number == no_shaft ? std::nullopt : std::optional(number);
    }
    archive("jacobian", jacobian_.numbers());
    if (!archive.reads()) return;
    for (int chunk = 0; chunk < matrix_.chunks(); ++chunk) eliminate(chunk);
    join();
}

}  // namespace cvtflow::bench
