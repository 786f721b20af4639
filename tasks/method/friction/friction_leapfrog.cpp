#include "tasks/method/friction/friction_leapfrog.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "model/basis/portable_math.hpp"
#include "model/contact/friction_stage.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

/// Cycles in the order of a step and of the report.
enum FrictionCycle : int { record_kick_cycle = method_cycles, first_kick_cycle, finish_kick_cycle = first_kick_cycle + PassCycles::count };

/// Cycles of stages; a kick of eleven stages is cycles of eight, two and one.
constexpr PassCycles kick_cycles(first_kick_cycle, {1, 2, 4, 8});

/// The spectrum changes with the tension: steps between two estimates.
constexpr long steps_between_estimates = 64;
constexpr int first_iterations = 50, next_iterations = 4;

[[nodiscard]] double square(double x) noexcept { return x * x; }

/// Rows of all fields: velocities, mean forces of tips, velocities by slot, two bases, slope, mode, image.
[[nodiscard]] std::vector<int> rows_of_fields(int size) {
    std::vector<int> rows(2 + kick_state_slots + 5, size);
    rows[1] = 3 * model::tips_per_link;
    return rows;
}

/// The first link with an unknown that is not finite, if there is one.
[[nodiscard]] std::optional<int> first_not_finite(const Workspace& w) noexcept {
    const model::ChainLayout& at = w.layout();
    for (int link = 0; link < at.links; ++link) {
        const double* begin = w.states[0] + at.link_begin(link);
        if (!std::all_of(begin, begin + 2 * at.link_size(), [](double x) { return std::isfinite(x); })) return link;
    }
    return {};
}

}  // namespace

FrictionLeapfrog::FrictionLeapfrog(Workspace& workspace, const Kick& kick)
    : KickSystem(workspace, rows_of_fields(workspace.layout().link_size()), {base, mode, base + 1},
                 std::vector(kick_state_slots + 1, workspace.layout().link_size())),
      w_(workspace),
      frame_(workspace),
      sticking_(friction_.all_sticking()),
      tables_(kick) {
    make_resting();
    FrictionLeapfrog::restart();
}

void FrictionLeapfrog::repartitioned() {
    KickSystem::repartition(w_.partition);
    make_resting();
}

void FrictionLeapfrog::make_resting() {
    resting_.clear();
    for (int s = 0; s < columns_.segments(); ++s) resting_.push_back(fields(s).contacts);
}

void FrictionLeapfrog::add_tasks(engine::TaskGraph& graph) {
    const auto name = [](const char* stage, int segment) { return stage + ("[" + std::to_string(segment) + "]"); };
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("record", s), record_kick_cycle, engine::code_of<&FrictionLeapfrog::record>(*this), s,
                   record_accesses(w_, s).own(Field::velocity_read, true).list()});
    kick_cycles.add_tasks(graph, w_, "stage", engine::code_of<&FrictionLeapfrog::stage>(*this), [](LinkAccesses& accesses) {
        accesses.own(Field::force, false).own(Field::velocity_slope, true).own(Field::mean_tip_force, true);
    });
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("finish", s), finish_kick_cycle, engine::code_of<&FrictionLeapfrog::finish>(*this), s,
                   LinkAccesses(w_, s)
                       .own(Field::velocity_read, false)
                       .own(Field::mean_tip_force, false)
                       .own(Field::contact, false)
                       .own(Field::phase, false)
                       .own(Field::states_read, false)
                       .segment(Field::window, false)
                       .own(Field::state_kept, true)
                       .own(Field::end_state, true)
                       .own(Field::load, true)
                       .list()});
}

void FrictionLeapfrog::restart() noexcept {
    frame_.restart();
    steps_ = 0;
    for (int row = 0; row < w_.layout().link_size(); ++row) {  // a mode without symmetry, to begin power iterations with
        for_links(static_cast<KickSystem&>(*this), [&](Fields& f, int link, int column) {
            *f.of[mode].at(row, column) = static_cast<float>(model::portable_sin(1.0 + 0.7 * row + 2.399 * link));
        });
    }
}

CycleSequence FrictionLeapfrog::step() {
    begin();                                          // q ← q + h/2 v: the middle of the step
    if (w_.layout().ledger) co_yield evaluate_cycle;  // its losses need the forces with friction
    co_yield record_kick_cycle;                       // there: contacts, and all forces but friction
    if (const Fault fault = choose_table()) co_return fault;
    while (stage_ < table_->plan.stages()) co_yield next_stages();  // v under friction and these forces
    co_yield finish_kick_cycle;                                     // q ← q + h/2 v
    frame_.end(sheave_forces(w_));                                  // the pulleys by the forces of the tips
    co_return {};
}

void FrictionLeapfrog::begin() {
    if (frame_.is_new()) {
        frame_.begin_new_step();
        KickSystem::begin_new_step();
    }
    frame_.begin();
    w_.step.end_state_ready = true;
    stage_ = 0;
}

/// Chooses by the spectral radius of friction, which is estimated now and then. @return why no table reaches so far
Fault FrictionLeapfrog::choose_table() {
    if (steps_ % steps_between_estimates == 0) radius_ = spectral_radius(steps_ == 0 ? first_iterations : next_iterations);
    ++steps_;
    table_ = tables_.reaching(margin * radius_ * w_.step.h);
    if (table_ != nullptr) return {};
    if (!std::isfinite(radius_)) return {FaultKind::non_finite, w_.step.time, first_not_finite(w_), 0.0, 0.0};
    return {FaultKind::too_stiff, w_.step.time, {}, radius_ * w_.step.h, tables_.longest_reach() / margin};
}

/// Takes the stages of the longest cycle that the remaining ones fill. @return that cycle
int FrictionLeapfrog::next_stages() noexcept {
    const PassCycles::Cycle cycle = kick_cycles.longest(table_->plan.stages() - stage_);
    for (int k = 0; k < cycle.rounds; ++k, ++stage_) {
        const KickRow row = table_->row(stage_);
        together_[at(k)] = {row, table_->extrapolation(row.here.time, frame_.force_change_ratio())};
    }
    return cycle.number;
}

void FrictionLeapfrog::save(std::vector<double>& memory) const {
    memory.assign({radius_, static_cast<double>(steps_)});
    frame_.save(memory);
    for (const std::size_t field : {base + now_, std::size_t(mode)}) KickSystem::save(field, memory);
}

void FrictionLeapfrog::load(std::span<const double> memory) {
    if (memory.empty()) return;
    radius_ = pop_front(memory, 1)[0];
    steps_ = pop_integer(memory, 0, std::numeric_limits<int>::max());
    memory = frame_.load(memory);
    for (const std::size_t field : {base + now_, std::size_t(mode)}) KickSystem::load(field, memory);
}

void FrictionLeapfrog::record(int segment) noexcept {
    KickSystem::record(w_, frame_.drift(), base + now_, segment);
    edges_[0].give(columns_, fields(segment).of[state], segment);
}

void FrictionLeapfrog::stage(int item) noexcept {
    const int segment = item % w_.partition.size();
    const auto& [row, extrapolation] = together_[at(item / w_.partition.size())];
    const double h = w_.step.h;
    Fields& f = fields(segment);
    const auto slot = [&](int number) { return &f.of[state + at(number)]; };
    const model::FrictionBase accelerations{&f.of[base + now_], &f.of[base + 1 - now_], extrapolation};
    model::VelocityRow next;
    for (const engine::Term& term : row.next.states) next.add(*slot(term.slot), term.factor);
    for (const engine::Term& term : row.next.slopes) {
        if (term.slot == row.here.slope) {
            next.slope_weight = h * term.factor;
        } else {
            next.add(f.of[first_slope], h * term.factor);
        }
    }
    next.to = row.next.keep >= 0 ? slot(row.next.keep) : &f.of[result];
    const bool first = row.here.keep < 0;
    const int here = first ? 0 : row.here.keep;
    edges_[at(here)].take(columns_, *slot(here), segment);
    if (first) contact_edges_.take(columns_, f.contacts.columns, segment);
    friction_.slopes(f.contacts, range_of(w_, row.here.time - 0.5, *slot(here), segment),
                     {&accelerations, row.keeps_slope ? &f.of[first_slope] : nullptr, &next, row.weight,
                      row.weight != 0.0 ? &f.of[mean_tip_forces] : nullptr});
    if (row.next.keep >= 0) edges_[at(row.next.keep)].give(columns_, *next.to, segment);
}

double FrictionLeapfrog::spectral_radius(int iterations) noexcept {
    const int rows = w_.layout().link_size(), segments = columns_.segments();
    for (int s = 0; s < segments; ++s) {
        contact_edges_.take(columns_, fields(s).contacts.columns, s);
        resting_[at(s)] = fields(s).contacts;
        resting_[at(s)].stop();
    }
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < segments; ++s) edges_[mode_edges].give(columns_, fields(s).of[mode], s);
        for (int s = 0; s < segments; ++s) {
            Fields& f = fields(s);
            edges_[mode_edges].take(columns_, f.of[mode], s);
            sticking_.slopes(resting_[at(s)], range_of(w_, 0.0, f.of[mode], s), {.slope = &f.of[image]});
        }
        for (int row = 0; row < rows; ++row) {
            for_links(static_cast<KickSystem&>(*this), [&](const Fields& f, int, int column) {
                before += square(*f.of[mode].at(row, column));
                after += square(*f.of[image].at(row, column));
            });
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < rows; ++row) {
            for_links(static_cast<KickSystem&>(*this), [&](Fields& f, int, int column) {
                *f.of[mode].at(row, column) = static_cast<float>(scale * *f.of[image].at(row, column));
            });
        }
    }
    return radius;
}

}  // namespace cvtflow::tasks
