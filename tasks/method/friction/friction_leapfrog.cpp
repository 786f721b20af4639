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

FrictionSpectrum::FrictionSpectrum(KickSystem& kick, std::size_t mode, std::size_t edges)
    : kick_(kick), mode_(mode), edges_(edges), sticking_(kick.friction.all_sticking()) {
    repartitioned();
}

void FrictionSpectrum::repartitioned() {
    resting_.clear();
    for (int s = 0; s < kick_.fields.columns().segments(); ++s) resting_.push_back(kick_.fields[s].contacts);
}

void FrictionSpectrum::restart() noexcept {
    for (int row = 0; row < kick_.friction.chain().layout().link_size(); ++row) {
        SegmentFields::for_links(kick_.fields, [&](SegmentFields::Fields& f, int link, int column) {
            *f.of[mode_].at(row, column) = static_cast<float>(model::portable_sin(1.0 + 0.7 * row + 2.399 * link));
        });
    }
}

double FrictionSpectrum::radius(const Workspace& w, int iterations) noexcept {
    const int rows = w.layout().link_size(), segments = kick_.fields.columns().segments();
    SegmentFields& fields = kick_.fields;
    for (int s = 0; s < segments; ++s) {
        resting_[at(s)] = fields[s].contacts;
        resting_[at(s)].stop();
    }
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < segments; ++s) fields.give(edges_, fields[s].of[mode_], s);
        for (int s = 0; s < segments; ++s) {
            SegmentFields::Fields& f = fields[s];
            fields.take(edges_, f.of[mode_], s);
            sticking_.slopes(resting_[at(s)], kick_.range_of(w, 0.0, f.of[mode_], s), {.slope = &f.of[mode_ + 1]});
        }
        for (int row = 0; row < rows; ++row) {
            SegmentFields::for_links(kick_.fields, [&](const SegmentFields::Fields& f, int, int column) {
                before += square(*f.of[mode_].at(row, column));
                after += square(*f.of[mode_ + 1].at(row, column));
            });
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < rows; ++row) {
            SegmentFields::for_links(kick_.fields, [&](SegmentFields::Fields& f, int, int column) {
                *f.of[mode_].at(row, column) = static_cast<float>(scale * *f.of[mode_ + 1].at(row, column));
            });
        }
    }
    return radius;
}

FrictionLeapfrog::FrictionLeapfrog(Workspace& workspace, const Kick& kick)
    : w_(workspace),
      frame_(workspace),
      kick_(workspace, std::vector(count, workspace.layout().link_size()), {base, mode, base + 1},
            std::vector(kick_state_slots + 1, SegmentEdges(workspace.layout()))),
      spectrum_(kick_, mode, mode_edges),
      tables_(kick) {
    FrictionLeapfrog::restart();
}

void FrictionLeapfrog::repartitioned() {
    kick_.fields.repartition(w_.partition);
    spectrum_.repartitioned();
}

void FrictionLeapfrog::add_tasks(engine::TaskGraph& graph) {
    const auto name = [](const char* stage, int segment) { return stage + ("[" + std::to_string(segment) + "]"); };
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("record", s), record_kick_cycle, engine::code_of<&FrictionLeapfrog::record>(*this), s,
                   record_accesses(w_, s).inside(Field::velocity_read, true).list()});
    kick_cycles.add_tasks(graph, w_, "stage", engine::code_of<&FrictionLeapfrog::stage>(*this), [](LinkAccesses& accesses) {
        accesses.inside(Field::force, false).inside(Field::velocity_slope, true).inside(Field::mean_tip_force, true);
    });
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("finish", s), finish_kick_cycle, engine::code_of<&FrictionLeapfrog::finish>(*this), s,
                   LinkAccesses(w_, s)
                       .inside(Field::velocity_read, false)
                       .inside(Field::mean_tip_force, false)
                       .inside(Field::contact, false)
                       .inside(Field::phase, false)
                       .inside(Field::states_read, false)
                       .segment(Field::window, false)
                       .inside(Field::state_kept, true)
                       .inside(Field::end_state, true)
                       .inside(Field::load, true)
                       .list()});
}

void FrictionLeapfrog::restart() noexcept {
    frame_.restart();
    steps_ = 0;
    spectrum_.restart();
}

CycleSequence FrictionLeapfrog::step() {
    begin();                                          // q ← q + h/2 v: the middle of the step
    if (w_.layout().ledger) co_yield evaluate_cycle;  // its losses need the forces with friction
    co_yield record_kick_cycle;                       // there: contacts, and all forces but friction
    if (const Fault fault = choose_table()) co_return fault;
    while (stages_.left()) co_yield stages_.next();  // v under friction and these forces
    co_yield finish_kick_cycle;                      // q ← q + h/2 v
    frame_.end(sheave_forces(w_));                   // the pulleys by the forces of the tips
    co_return {};
}

void FrictionLeapfrog::begin() {
    if (frame_.is_new()) {
        frame_.begin_new_step();
        now_ = 1 - now_;
    }
    frame_.begin();
    w_.step.end_state_ready = true;
}

/// Chooses by the spectral radius of friction, which is estimated now and then. @return why no table reaches so far
Fault FrictionLeapfrog::choose_table() {
    if (steps_ % steps_between_estimates == 0) radius_ = spectrum_.radius(w_, steps_ == 0 ? first_iterations : next_iterations);
    ++steps_;
    table_ = tables_.reaching(margin * radius_ * w_.step.h);
    if (table_ != nullptr) {
        stages_ = Rounds(kick_cycles, table_->plan.stages());
        return {};
    }
    if (!std::isfinite(radius_)) return {FaultKind::non_finite, w_.step.time, first_not_finite(w_), 0.0, 0.0};
    return {FaultKind::too_stiff, w_.step.time, {}, radius_ * w_.step.h, tables_.longest_reach() / margin};
}

void FrictionLeapfrog::save(std::vector<double>& memory) const {
    memory.assign({radius_, static_cast<double>(steps_)});
    frame_.save(memory);
    for (const std::size_t field : {base + now_, std::size_t(mode)}) kick_.fields.save(field, memory);
}

void FrictionLeapfrog::load(std::span<const double> memory) {
    if (memory.empty()) return;
    radius_ = pop_front(memory, 1)[0];
    steps_ = pop_integer(memory, 0, std::numeric_limits<int>::max());
    memory = frame_.load(memory);
    for (const std::size_t field : {base + now_, std::size_t(mode)}) kick_.fields.load(field, memory);
}

void FrictionLeapfrog::record(int segment) noexcept {
    kick_.record(w_, frame_.drift(), base + now_, segment);
    kick_.fields.give(state_edges, kick_.fields[segment].start, segment);
}

void FrictionLeapfrog::stage(int item) noexcept {
    const int segments = w_.partition.size(), segment = item % segments;
    const int reached = stages_.begun() + item / segments;
    const KickRow row = table_->row(std::min(reached, stages_.count() - 1));  // beyond: a cycle whose instructions are counted by itself
    const double h = w_.step.h;
    SegmentFields& fields = kick_.fields;
    SegmentFields::Fields& f = fields[segment];
    const model::FrictionBase accelerations{&f.of[base + now_], &f.of[base + 1 - now_],
                                            table_->extrapolation(row.here.time, frame_.force_change_ratio())};
    model::VelocityRow next;
    for (const engine::Term& term : row.next.states) next.add(slot(f, term.slot), term.factor);
    for (const engine::Term& term : row.next.slopes) {
        if (term.slot == row.here.slope) {
            next.slope_weight = h * term.factor;
        } else {
            next.add(f.of[first_slope], h * term.factor);
        }
    }
    next.to = row.next.keep >= 0 ? &slot(f, row.next.keep) : &f.result;
    const bool first = row.here.keep < 0;
    const int here = first ? 0 : row.here.keep;
    fields.take(state_edges + at(here), slot(f, here), segment);
    kick_.friction.slopes(f.contacts, kick_.range_of(w_, row.here.time - 0.5, slot(f, here), segment),
                          {&accelerations, row.keeps_slope ? &f.of[first_slope] : nullptr, &next, row.weight,
                           row.weight != 0.0 ? &f.mean_tip_forces : nullptr});
    if (row.next.keep >= 0) fields.give(state_edges + at(row.next.keep), *next.to, segment);
}

}  // namespace cvtflow::tasks
