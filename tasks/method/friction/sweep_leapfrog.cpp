#include "tasks/method/friction/sweep_leapfrog.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

/// A step of n sweeps has n + 1 passes, so the usual three sweeps are one cycle of four passes.
enum SweepCycle : int { record_sweep_cycle = method_cycles, one_pass_cycle, four_passes_cycle };

/// The next step opens with each force plus this share of its last change. More diverges, with less tips lag.
constexpr double ahead = 0.5;

/// Steps whose lengths differ by less have the same length; the time is rounded.
constexpr double same_length = 1e-6;

/// Number of sweeps of a step. The error of a sweep does not decrease with the saturation speed: two sweeps at a tenth of the usual
/// speeds have twice the error of tips, five the same (decision 96). Steps of 5 us take three (decision 115).
constexpr double sweeps_at_usual_speeds = 3.0, min_sweeps = 3.0, max_sweeps = 18.0, power_of_slowness = 0.4;

[[nodiscard]] double needed_sweeps(const model::Parameters& parameters) {
    const model::Parameters usual;
    const double slowness = std::max({usual.tip.friction.saturation_speed / parameters.tip.friction.saturation_speed,
                                      usual.joint.friction.saturation_speed / parameters.joint.friction.saturation_speed,
                                      usual.plate.friction.saturation_speed / parameters.plate.friction.saturation_speed});
    return sweeps_at_usual_speeds * std::pow(slowness, power_of_slowness) - 0.1;
}

[[nodiscard]] int passes_for(const model::Parameters& parameters) {
    return 1 + static_cast<int>(std::ceil(std::clamp(needed_sweeps(parameters), min_sweeps, max_sweeps)));
}

/// Velocities of a sheave.
template <class Motion>
[[nodiscard]] auto velocities_of(Motion& s) noexcept {
    return std::array{&s.vx, &s.vy, &s.vz, &s.spin_x, &s.spin_y, &s.spin_z};
}

/// Ends a step inside which tips may have changed their phase.
[[nodiscard]] Fault close_step(Workspace& w) {
    close_tail(w);
    TipState& tips = w.tips;
    const bool changed = std::ranges::any_of(w.segment_results, [](const SegmentResult& result) { return result.detected != 0; });
    if (tips.have_changed != changed) tips.have_changed = changed;  // all tasks read its cache line
    for (std::size_t tip = 0; tip < tips.phases.size() && tips.have_changed; ++tip) {
        if (tips.phases[tip] != tips.phases_before[tip]) tips.changed[tip] = w.step.time + w.step.h;
    }
    if (const Fault fault = check_tail(w)) return fault;
    for (const SegmentResult& result : w.segment_results) {
        if (result.pending) return find_fault(w, w.end_state);
    }
    return {};
}

}  // namespace

std::string_view missing_for_sweeps(const model::Parameters& parameters) noexcept {
    if (parameters.detail.pins == model::PinDetail::rigid) return "detail.pins = \"halves\"";
    if (has_few_pins(parameters)) return "chain.pins >= 12";
    // The record evaluates tips within 0.5 mm of sheaves that turn about their shaft's axis.
    if (parameters.imperfection.runout * std::sin(parameters.tip.angle) > 3e-4) return "imperfection.runout * sin(tip.angle) <= 0.3 mm";
    return parameters.detail.stick_slip ? "detail.stick_slip = false" : "";
}

bool sweeps_suit(const model::Parameters& parameters) {
    return missing_for_sweeps(parameters).empty() && needed_sweeps(parameters) <= max_sweeps;
}

std::vector<int> SweepSystem::rows_of_fields(const Workspace& w) {
    const int size = w.layout().link_size();
    const int forces = model::SweepRows{w.variator.chain().coefficients().joint_points.count}.count();
    return {size, size, forces, forces};
}

SweepSystem::SweepSystem(const Workspace& w)
    : friction_(model::make_friction(w.variator.chain())),
      fields_(w, friction_, rows_of_fields(w), {kept, kept + 1},
              {SegmentEdges(w.layout()), SegmentEdges(w.layout()), SegmentEdges(w.layout().link_size()), SegmentEdges(w.layout())}),
      normal_loads_(at(w.layout().links)),
      responses_(friction_, 0.0, 0.0),
      mean_edges_(w.layout()) {
    powers_.resize(at(w.layout().links));
    make_room();
}

void SweepSystem::make_room() {
    const int segments = fields_.columns().segments();
    for (int s = 0; s < segments; ++s) {
        if (at(s) == means_.size()) means_.emplace_back();
        if (means_[at(s)].bytes() < fields_[s].of[velocity].bytes()) means_[at(s)] = fields_[s].of[velocity];
    }
    mean_edges_.make_room(segments);
    ghosts_.resize(at(2 * segments));
    handed_over_ = follows_ = false;  // borders also move after begin()
}

void SweepSystem::repartition(const Partition& partition) {
    find_losses();
    fields_.repartition(partition);
    make_room();
}

void SweepSystem::restart() noexcept {
    fields_.clear(kept_now());
    losses_ = Losses::none;
    handed_over_ = false;
}

void SweepSystem::begin(double step, double nominal) noexcept {
    now_ = 1 - now_;
    friction_.hold(static_cast<float>(nominal));
    follows_ = std::exchange(handed_over_, false);
    step_before_ = responses_.of_step;
    if (step != responses_.of_step || nominal != responses_.of_nominal) responses_ = {friction_, step, nominal};
    losses_ = Losses::none;
}

void SweepSystem::record(Workspace& w, const model::ContactDrift& drift, int segment, model::TipSearch* search) noexcept {
    SegmentFields::Fields& f = fields_[segment];
    const Segment& bounds = w.partition[segment];
    const double* window = advance_window(w, segment, friction_.kernels().advance, find_ghosts(w, segment));
    const int shift = fields_.columns().shift(segment), begin = w.layout().link_begin(bounds.first);
    const model::ChainRange range{bounds.first, bounds.last, window, w.pulleys.sheaves, w.tips.phases.data(), shift, true};
    model::LinkLoad* loads = normal_loads_.data() + bounds.first;
    friction_.record(range, drift, {w.states[0] + begin, f.contacts, f.of[base], f.start}, loads, search);
    for (int row = 0; row < 3 * model::tips_per_link; ++row)
        std::fill_n(f.mean_tip_forces.at(row, SegmentColumns::first), bounds.size(), 0.0F);
    if (!friction_.numbers().filter_waves()) return;
    const model::SweepRows rows{f.contacts.components.joint_points};
    for (int row = 0; row < model::SweepRows::wave_rows; ++row) {
        float* const to = f.of[base].at(row, SegmentColumns::first);
        const float* const lasting = f.of[kept_before()].at(rows.lasting(row), SegmentColumns::first);
        for (int link = 0; link < bounds.size(); ++link) to[link] += lasting[link];
    }
    fields_.give(acceleration_edges, f.of[base], segment);
}

/// The links beside a segment at the step's start: they advance as in their segments, by the velocities handed over. @return nullptr: they
/// are in the segment
GhostLink* SweepSystem::find_ghosts(const Workspace& w, int segment) noexcept {
    const SegmentColumns& columns = fields_.columns();
    if (columns.segments() == 1) return nullptr;
    GhostLink* const ghosts = ghosts_.data() + 2 * segment;
    model::FloatColumns& velocity = fields_[segment].result;
    if (follows_) fields_.take(result_edges, velocity, segment);
    for (int side = 0; side < 2; ++side) {
        GhostLink& ghost = ghosts[side];
        if (follows_) {
            ghost.before = ghost.start;
            const float* of_ghost = velocity.at(0, columns.ghosts(segment)[at(side)].column);
            friction_.kernels().end({.velocity = of_ghost,
                                     .stride = velocity.stride(),
                                     .counted_from = ghost.middle.data(),
                                     .start = ghost.before.data(),
                                     .end = ghost.start.data(),
                                     .secants = ghost.slope.data(),
                                     .step = step_before_,
                                     .limit = 0.0},
                                    1);
        } else {
            const Segment& links = columns.segment(segment);
            const int begin = w.layout().link_begin(w.layout().wrapped(side == 0 ? links.first - 1 : links.last));
            std::copy_n(w.states[0] + begin, ghost.start.size(), ghost.start.data());
            std::copy_n(w.slopes[1] + begin, ghost.slope.size(), ghost.slope.data());
        }
    }
    return ghosts;
}

void SweepSystem::sweep(const Workspace& w, model::SweepPart part, double opening, int number, int segment) noexcept {
    SegmentFields::Fields& f = fields_[segment];
    const Segment& bounds = w.partition[segment];
    const auto edge = [](int pass) { return velocity_edges + at(pass % 2); };
    if (part != model::SweepPart::opening)
        fields_.take(edge(number - 1), f.of[velocity], segment);
    else
        fields_.take(acceleration_edges, f.of[base], segment);
    const model::FrictionSweep sweep{.part = part,
                                     .ahead = static_cast<float>(opening),
                                     .responses = &responses_,
                                     .base = &f.of[base],
                                     .start = &f.start,
                                     .before = &f.of[kept_before()],
                                     .kept = &f.of[kept_now()],
                                     .velocity = &f.of[velocity],
                                     .result = &f.result,
                                     .mean_tip_forces = &f.mean_tip_forces};
    constexpr double instant = model::sweep_time - 0.5;  // from the middle of the step
    const model::FloatColumns& now = f.of[velocity];
    const model::FrictionRange range{
        bounds.first,         bounds.last, now.at(0, SegmentColumns::first - 1), now.stride(), f.scratch.data(),
        w.tips.phases.data(), instant,     fields_.columns().shift(segment)};
    friction_.kernels().sweep(friction_, f.contacts, range, sweep);
    if (part != model::SweepPart::closing)
        fields_.give(edge(number), f.of[velocity], segment);
    else if (fields_.columns().segments() > 1)
        fields_.give(result_edges, f.result, segment);
}

bool SweepSystem::finish(Workspace& w, int segment) const noexcept {
    const model::ChainLayout& layout = w.layout();
    const SegmentFields::Fields& f = fields_[segment];
    const Segment& bounds = w.partition[segment];
    const int begin = layout.link_begin(bounds.first), column = bounds.first + fields_.columns().shift(segment);
    friction_.kernels().react({.forces = f.mean_tip_forces.at(0, column),
                               .stride = f.mean_tip_forces.stride(),
                               .arms = f.contacts.arms.at(0, column),
                               .arms_stride = f.contacts.arms.stride(),
                               .phases = w.tips.phases.data() + model::tips_per_link * bounds.first,
                               .normal = normal_loads_.data() + bounds.first,
                               .loads = w.links.loads.data() + bounds.first},
                              bounds.size());
    if (layout.pulley_size != 0) add_up(w, bounds);
    return friction_.kernels().end({.velocity = f.result.at(0, column),
                                    .stride = f.result.stride(),
                                    // still in the window that record() has filled
                                    .counted_from = w.windows[at(segment)].data() + layout.halo() * layout.link_block(),
                                    .start = w.states[0] + begin,
                                    .end = w.end_state + begin,
                                    .secants = w.end_slope + begin,
                                    .step = w.step.h,
                                    .limit = fastest_pin},
                                   bounds.size());
}

/// Finds the exact power that friction takes from the kinetic energy, by the mean velocities of the step.
void SweepSystem::find_losses() const noexcept {
    if (losses_ != Losses::to_be_found) return;
    const SegmentColumns& columns = fields_.columns();
    for (int s = 0; s < columns.segments(); ++s) {
        const SegmentFields::Fields& f = fields_[s];
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {
            const float *before = f.start.at(row, SegmentColumns::first), *after = f.result.at(row, SegmentColumns::first);
            float* mean = means_[at(s)].at(row, SegmentColumns::first);
            for (int link = 0; link < columns.segment(s).size(); ++link) mean[link] = 0.5F * (before[link] + after[link]);
        }
        mean_edges_.give(columns, means_[at(s)], s);
    }
    for (int s = 0; s < columns.segments(); ++s) {
        const SegmentFields::Fields& f = fields_[s];
        const Segment& bounds = columns.segment(s);
        mean_edges_.take(columns, means_[at(s)], s);
        constexpr double middle = 0.0;
        const model::FrictionRange range{
            bounds.first, bounds.last,     means_[at(s)].at(0, SegmentColumns::first - 1), means_[at(s)].stride(), nullptr, nullptr,
            middle,       columns.shift(s)};
        friction_.kernels().powers(friction_, f.contacts, range, f.of[kept_now()], powers_.data() + bounds.first);
    }
    losses_ = Losses::known;
}

void SweepSystem::enter_losses(Workspace& w) noexcept {
    find_losses();
    if (losses_ != Losses::known) return;
    for (int link = 0; link < w.layout().links; ++link) {
        model::Account* parts = w.links.accounts.data() + model::account_parts * link;
        for (int part = 0; part < model::account_parts; ++part) {
            for (const model::Loss kind : {model::Loss::joint_friction, model::Loss::plate_friction, model::Loss::tip_friction})
                parts[part].loss[at(static_cast<int>(kind))] = 0.0;
        }
        const model::FrictionPowers& powers = powers_[at(link)];
        parts[static_cast<int>(model::AccountPart::joint)].lose(model::Loss::joint_friction, powers.joint);
        parts[static_cast<int>(model::AccountPart::link)].lose(model::Loss::plate_friction, powers.plates);
        parts[static_cast<int>(model::AccountPart::tips)].lose(model::Loss::tip_friction, powers.tips);
    }
}

void SweepSystem::visit(engine::Archive& archive) {
    if (!archive.reads()) find_losses();
    fields_.visit(kept_now(), "friction", archive);
    bool known = losses_ == Losses::known;
    archive("losses_known", known), archive("friction_powers", std::span(powers_));
    if (archive.reads()) losses_ = known ? Losses::known : Losses::none;
}

/// Slope slot 1: [v | mean acceleration of the step before], zero acceleration in the first step.
void LeapfrogFrame::extrapolate() {
    if (continues_) {
        std::swap(w_.slopes[1], w_.end_slope);  // made at the end of the last step
        return;
    }
    const model::ChainLayout& at = w_.layout();
    std::fill_n(w_.slopes[1], at.size(), 0.0);
    for (int link = 0; link < at.links; ++link) {
        const int q = at.link_begin(link);
        std::copy_n(w_.states[0] + q + at.link_size(), at.link_size(), w_.slopes[1] + q);
    }
    std::copy_n(w_.states[0] + at.pulley_begin() + at.pulley_size, at.pulley_size, w_.slopes[1] + at.pulley_begin());
}

void LeapfrogFrame::begin() {
    extrapolate();
    std::copy(std::begin(w_.pulleys.sheaves), std::end(w_.pulleys.sheaves), sheaves_before_);
    const double length_before = continues_ ? length_ : 0.0;
    length_ = w_.step.h;
    continues_ = true;
    // Change of a velocity over the step, in units of the difference between its last two values; 0 without a step before.
    const double change_ratio = length_before > 0.0 ? 2.0 * length_ / (length_ + length_before) : 0.0;
    static constexpr engine::Term from{0, 1.0}, along{1, 0.5};
    w_.step.evaluate_end = false;
    w_.step.row = {{&from, 1}, {&along, 1}, -1, 2, 0.5};
    w_.step.slope_out = w_.slopes[2];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.step.row, w_.step.h, w_.slots(), at.pulley_begin(), at.size(), w_.pulleys.tail.data());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
    drift_.step = w_.step.h;
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        const auto now = velocities_of(w_.pulleys.sheaves[sheave]), before = velocities_of(sheaves_before_[sheave]);
        for (std::size_t k = 0; k < 6; ++k) drift_.change[sheave][k] = change_ratio * (*now[k] - *before[k]);
    }
}

void LeapfrogFrame::end(const model::SheaveForces& chain) {
    const model::ChainLayout& at = w_.layout();
    const int begin = at.pulley_begin(), half = at.pulley_size;
    close_evaluation(w_, w_.step.time + 0.5 * w_.step.h, w_.pulleys.tail.data(), chain, w_.slopes[2]);
    for (int k = begin + half; k < at.size(); ++k) w_.states[1][k] = w_.states[0][k] + w_.step.h * w_.slopes[2][k];
    for (int k = begin; k < begin + half; ++k)
        w_.states[1][k] = w_.states[0][k] + 0.5 * w_.step.h * (w_.states[0][k + half] + w_.states[1][k + half]);
    static constexpr engine::Term end{1, 1.0};
    w_.step.row = {{&end, 1}, {}, -1, -1, 1.0};
}

void LeapfrogFrame::visit(engine::Archive& archive) {
    archive("follows_step", continues_), archive("length_before", length_);
    for (model::SheaveMotion& s : w_.pulleys.sheaves)
        for (double* velocity : velocities_of(s)) archive("sheave_velocity", *velocity);
    archive("end_slope", std::span(w_.end_slope, static_cast<std::size_t>(w_.layout().size())));
}

SweepLeapfrog::SweepLeapfrog(Workspace& workspace)
    : w_(workspace), frame_(workspace), system_(workspace), usual_passes_(passes_for(workspace.parameters)) {}

int SweepLeapfrog::next_passes() noexcept {
    const bool four = passes_ - next_ >= 4;
    begun_ = std::exchange(next_, next_ + (four ? 4 : 1));
    return four ? four_passes_cycle : one_pass_cycle;
}

void SweepLeapfrog::add_tasks(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({"record[" + std::to_string(s) + "]", record_sweep_cycle, engine::code_of<&SweepLeapfrog::record>(*this), s,
                   LinkAccesses(w_, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .inside(Field::phase, true)
                       .segment(Field::window, true)
                       .inside(Field::contact, true)
                       .inside(Field::force, true)
                       .segment(Field::result, true)
                       .list()});
    add_passes(graph, one_pass_cycle, 1);
    add_passes(graph, four_passes_cycle, 4);
    // The losses that the laws have at the state observed are replaced by what the last step's forces have done.
    const int others = graph.size();
    engine::Access accounts{static_cast<int>(Field::account), 0, w_.layout().links, true};
    const int losses = graph.add({"book", observe_cycle, engine::code_of<&SweepLeapfrog::enter_losses>(*this), 0, {accounts}});
    for (int task = 0; task < others; ++task) {
        if (graph.task(task).cycle == observe_cycle) graph.order(task, losses);
    }
}

/// A segment's pass waits for its previous one and for those of the segments whose velocities it reads. Its output has two places in turn,
/// so that a pass does not overwrite what its neighbours read.
void SweepLeapfrog::add_passes(engine::TaskGraph& graph, int cycle, int passes) {
    const int segments = w_.partition.size(), first = graph.size();
    for (int item = 0; item < passes * segments; ++item) {
        const int pass = item / segments, s = item % segments;
        const bool even = pass % 2 == 0;
        const std::string number = passes == 1 ? "" : ", pass " + std::to_string(pass);
        graph.add({"friction[" + std::to_string(s) + "]" + number, cycle, engine::code_of<&SweepLeapfrog::sweep>(*this), item,
                   LinkAccesses(w_, s)
                       .inside(Field::contact, false)
                       .with_halo(even ? Field::velocity_read : Field::velocity_kept)
                       .inside(Field::phase, false)
                       .inside(even ? Field::velocity_kept : Field::velocity_read, true)
                       .inside(Field::force, true)
                       .inside(Field::mean_tip_force, true)
                       .inside(Field::states_read, false)
                       .segment(Field::window, false)
                       .inside(Field::state_kept, true)
                       .inside(Field::end_state, true)
                       .inside(Field::secant, true)
                       .segment(Field::result, true)
                       .inside(Field::load, true)
                       .list()});
    }
    for (int s = 0; s < segments; ++s) {
        const auto beside = system_.columns().ghosts(s);
        for (const int near : {s, beside[0].owner, beside[1].owner}) {
            for (int pass = 1; pass < passes; ++pass) graph.order(first + (pass - 1) * segments + near, first + pass * segments + s);
        }
    }
}

void SweepLeapfrog::restart() noexcept {
    frame_.restart();
    system_.restart();
    cold_ = true;
    nominal_ = length_ = 0.0;
}

CycleSequence SweepLeapfrog::step() {
    begin();                                          // pulleys to the middle of the step: q ← q + h/2 v
    if (w_.layout().ledger) co_yield evaluate_cycle;  // only where losses are integrated with the state
    co_yield record_sweep_cycle;                      // links there, contacts, all forces but friction
    while (next_ < passes_) co_yield next_passes();   // friction of joints, plates and tips; then v, q ← q + h/2 v
    co_return finish();                               // the pulleys by the forces of the tips; soundness of the state
}

void SweepLeapfrog::begin() {
    cold_ = !frame_.continues();
    if (w_.step.h > nominal_ || std::abs(w_.step.h - length_) < same_length * length_) nominal_ = w_.step.h;
    length_ = w_.step.h;
    frame_.begin();
    system_.begin(w_.step.h, nominal_);
    passes_ = cold_ ? 1 + first_sweeps : usual_passes_;
    next_ = 0;
}

Fault SweepLeapfrog::finish() {
    frame_.end(sheave_forces(w_));
    system_.end();
    return close_step(w_);
}

void SweepLeapfrog::visit(engine::Archive& archive) {
    archive("nominal_step", nominal_), archive("step_before", length_);
    frame_.visit(archive);
    system_.visit(archive);
}

void SweepLeapfrog::record(int segment) noexcept {
    const model::Pulley& pulley = w_.parameters.pulley;
    model::TipSearch search{w_.tips.phases.data(), w_.rule.release, w_.parameters.tip.deepest, pulley.innermost, pulley.outermost};
    const Segment& links = w_.partition[segment];
    const model::Phase* phases = w_.tips.phases.data() + model::tips_per_link * links.first;
    model::Phase* before = w_.tips.phases_before.data() + model::tips_per_link * links.first;
    const std::size_t bytes = at(model::tips_per_link * links.size());
    static_assert(sizeof(model::Phase) == 1);  // the library copies and compares enumerations one by one
    if (std::memcmp(before, phases, bytes) != 0) std::memcpy(before, phases, bytes);
    system_.record(w_, frame_.drift(), segment, w_.layout().pulley_size != 0 ? &search : nullptr);
    w_.segment_results[at(segment)].detected = std::memcmp(before, phases, bytes) != 0 ? 1 : 0;
    w_.segment_results[at(segment)].pending = search.suspect;
}

void SweepLeapfrog::sweep(int item) noexcept {
    const int segments = w_.partition.size(), segment = item % segments, pass = begun_ + item / segments;
    const bool closing = pass + 1 == passes_;
    const model::SweepPart part = pass == 0 ? model::SweepPart::opening : closing ? model::SweepPart::closing : model::SweepPart::middle;
    system_.sweep(w_, part, cold_ ? 0.0 : ahead, pass, segment);
    if (!closing) return;
    if (!system_.finish(w_, segment)) w_.segment_results[at(segment)].pending = true;
}

}  // namespace cvtflow::tasks
