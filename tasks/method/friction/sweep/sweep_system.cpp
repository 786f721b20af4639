#include "tasks/method/friction/sweep/sweep_system.hpp"

#include "tasks/method/friction/kick_record.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

template <class Number>
SweepSystem<Number>::Fields::Fields(const model::FrictionOperator& friction, int columns) : width(columns), contacts(friction.chain()) {
    const int size = friction.chain().layout().link_size();
    contacts.make_columns(width);
    for (Columns* field : {&base, &start, &velocity, &result, &mean}) *field = Columns(size, width);
    impulses = Columns(3 * model::tips_per_link, width);
    for (Columns& each : kept) each = Columns(model::SweepRows{contacts.components.joint_points}.count(), width);
    scratch.resize(at(friction.template scratch_size<Number>(width)), Number(0));
}

template <class Number>
SweepSystem<Number>::SweepSystem(const Workspace& w)
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip), responses_(friction_, 0.0, 0.0) {
    const int size = w.layout().link_size();
    const model::ContactComponents components = model::ContactFieldOf<Number>(w.variator.chain()).components;
    contact_edges_ = SegmentEdges<Number>(components.count());
    kept_edges_ = SegmentEdges<Number>(rows().count());
    for (SegmentEdges<Number>* edges : {&velocity_edges_[0], &velocity_edges_[1], &mean_edges_}) *edges = SegmentEdges<Number>(size);
    moving_.resize(2 * at(rows().count() * w.layout().links));
    normal_loads_.resize(at(w.layout().links));
    powers_.resize(at(w.layout().links));
    columns_.lay_out(w.partition);
    make_room();
}

template <class Number>
model::SweepRows SweepSystem<Number>::rows() const noexcept {
    return {friction_.chain().coefficients().joint_points.count};
}

/// Fields and edges for all segments. Those of whole lines serve when borders move a little.
template <class Number>
void SweepSystem<Number>::make_room() {
    constexpr int line = Columns::line;
    const int segments = columns_.segments();
    for (int s = 0; s < segments; ++s) {
        const int width = (columns_.count(s) + line - 1) / line * line;
        if (at(s) == fields_.size()) {
            fields_.emplace_back(friction_, width);
        } else if (fields(s).width < width) {
            fields(s) = Fields(friction_, width);
        }
    }
    for (SegmentEdges<Number>* edges : {&contact_edges_, &kept_edges_, &velocity_edges_[0], &velocity_edges_[1], &mean_edges_})
        edges->make_room(segments);
}

template <class Number>
template <class System, class Visit>
void SweepSystem<Number>::for_kept(System& system, std::size_t which, const Visit& visit) {
    for (int row = 0; row < system.rows().count(); ++row) {
        for (int s = 0; s < system.columns_.segments(); ++s) {
            const Segment& own = system.columns_.segment(s);
            auto& kept = system.fields(s).kept[which];
            for (int link = own.first; link < own.last; ++link) visit(*kept.at(row, link + system.columns_.shift(s)));
        }
    }
}

/// Both columns: a step that has been cut is yet to be taken again.
template <class Number>
void SweepSystem<Number>::repartition(const Partition& partition) {
    find_losses();
    Number* room = moving_.data();
    for (const std::size_t which : {0u, 1u}) for_kept(*this, which, [&](Number& number) { *room++ = number; });
    columns_.lay_out(partition);
    make_room();
    room = moving_.data();
    for (const std::size_t which : {0u, 1u}) for_kept(*this, which, [&](Number& number) { number = *room++; });
}

template <class Number>
std::size_t SweepSystem<Number>::bytes() const noexcept {
    std::size_t bytes = sizeof(*this) + normal_loads_.size() * sizeof(model::LinkLoad);
    for (const Fields& f : fields_) {
        bytes += f.contacts.bytes() + f.scratch.size() * sizeof(Number);
        for (const Columns* each : {&f.base, &f.start, &f.velocity, &f.result, &f.impulses, &f.kept[0], &f.kept[1]}) bytes += each->bytes();
    }
    for (const SegmentEdges<Number>* each : {&contact_edges_, &kept_edges_, &velocity_edges_[0], &velocity_edges_[1]})
        bytes += each->bytes();
    return bytes;
}

template <class Number>
void SweepSystem<Number>::restart() noexcept {
    for_kept(*this, now_, [](Number& number) { number = Number(0); });
    losses_ = Losses::none;
}

template <class Number>
void SweepSystem<Number>::begin(double step, double nominal) noexcept {
    responses_ = {friction_, step, nominal};
    losses_ = Losses::none;
}

template <class Number>
void SweepSystem<Number>::record(Workspace& w, const model::ContactDrift& drift, int segment) noexcept {
    Fields& f = fields(segment);
    record_kick<Number>(w, friction_, drift, columns_, segment, {f.contacts, f.base, f.start, f.impulses}, normal_loads_);
    contact_edges_.give(columns_, f.contacts.columns, segment);
    kept_edges_.give(columns_, f.kept[1 - now_], segment);
}

template <class Number>
void SweepSystem<Number>::sweep(const Workspace& w, model::SweepPart part, double ahead, int number, int segment) noexcept {
    Fields& f = fields(segment);
    if (part == model::SweepPart::opening) {
        contact_edges_.take(columns_, f.contacts.columns, segment);
        kept_edges_.take(columns_, f.kept[1 - now_], segment);
    } else {
        velocity_edges_[at((number + 1) % 2)].take(columns_, f.velocity, segment);
    }
    const model::FrictionSweepOf<Number> sweep{
        part,       static_cast<Number>(ahead), &responses_, &f.base, &f.start, &f.kept[1 - now_], &f.kept[now_], &f.velocity, &f.result,
        &f.impulses};
    constexpr double end = 0.5;  // of the step, from its middle
    const Segment& own = w.partition[segment];
    const model::FrictionRangeOf<Number> range{own.first,
                                               own.last,
                                               f.velocity.at(0, SegmentColumns::first - 1),
                                               f.velocity.stride(),
                                               f.scratch.data(),
                                               w.tips.phases.data(),
                                               end,
                                               columns_.shift(segment)};
    friction_.template sweeps<Number>().sweep(friction_, f.contacts, range, sweep);
    if (part != model::SweepPart::closing) velocity_edges_[at(number % 2)].give(columns_, f.velocity, segment);
}

template <class Number>
void SweepSystem<Number>::finish(Workspace& w, int segment) const noexcept {
    const Fields& f = fields(segment);
    react_to_kick(w, columns_, segment, f.contacts, f.impulses, normal_loads_);
    end_kick(w, columns_, segment, f.result);
}

/// By the mean velocities of the step: what friction takes from the kinetic energy, exactly.
template <class Number>
void SweepSystem<Number>::find_losses() const noexcept {
    if (losses_ != Losses::to_be_found) return;
    for (int s = 0; s < columns_.segments(); ++s) {
        const Fields& f = fields(s);
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {
            const Number *start = f.start.at(row, SegmentColumns::first), *result = f.result.at(row, SegmentColumns::first);
            Number* mean = f.mean.at(row, SegmentColumns::first);
            for (int link = 0; link < columns_.segment(s).size(); ++link) mean[link] = Number(0.5) * (start[link] + result[link]);
        }
        mean_edges_.give(columns_, f.mean, s);
    }
    for (int s = 0; s < columns_.segments(); ++s) {
        const Fields& f = fields(s);
        const Segment& own = columns_.segment(s);
        mean_edges_.take(columns_, f.mean, s);
        constexpr double middle = 0.0;
        const model::FrictionRangeOf<Number> range{
            own.first, own.last, f.mean.at(0, SegmentColumns::first - 1), f.mean.stride(), nullptr, nullptr, middle, columns_.shift(s)};
        friction_.template sweeps<Number>().powers(friction_, f.contacts, range, f.kept[now_], powers_.data() + own.first);
    }
    losses_ = Losses::known;
}

template <class Number>
void SweepSystem<Number>::book(Workspace& w) noexcept {
    find_losses();
    if (losses_ != Losses::known) return;
    for (int link = 0; link < w.layout().links; ++link) {
        model::Account* parts = w.links.accounts.data() + model::account_parts * link;
        for (int part = 0; part < model::account_parts; ++part) {
            for (const model::Loss kind : {model::Loss::joint_friction, model::Loss::plate_friction, model::Loss::tip_friction})
                parts[part].loss[static_cast<std::size_t>(kind)] = 0.0;
        }
        const model::FrictionPowers& powers = powers_[at(link)];
        parts[static_cast<int>(model::AccountPart::joint)].lose(model::Loss::joint_friction, powers.joint);
        parts[static_cast<int>(model::AccountPart::link)].lose(model::Loss::plate_friction, powers.plates);
        parts[static_cast<int>(model::AccountPart::tips)].lose(model::Loss::tip_friction, powers.tips);
    }
}

template <class Number>
void SweepSystem<Number>::save(std::vector<double>& memory) const {
    find_losses();
    for_kept(*this, now_, [&](const Number& number) { memory.push_back(number); });
    memory.push_back(losses_ == Losses::known ? 1.0 : 0.0);
    for (const model::FrictionPowers& powers : powers_) memory.insert(memory.end(), {powers.joint, powers.plates, powers.tips});
}

template <class Number>
void SweepSystem<Number>::load(std::span<const double> memory) {
    const double* from = pop_front(memory, moving_.size() / 2).data();
    for_kept(*this, now_, [&](Number& number) { number = static_cast<Number>(*from++); });
    losses_ = pop_integer(memory, 0, 1) == 1 ? Losses::known : Losses::none;
    from = pop_front(memory, 3 * powers_.size()).data();
    for (model::FrictionPowers& powers : powers_) {
        powers = {from[0], from[1], from[2]};
        from += 3;
    }
}

template class SweepSystem<double>;
template class SweepSystem<float>;

}  // namespace cvtflow::tasks
