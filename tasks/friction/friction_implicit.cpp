#include <string>

#include "tasks/assembly/link_accesses.hpp"
#include "tasks/friction/friction_solve.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] FrictionImplicit& method_of(void* workspace) noexcept { return static_cast<FrictionImplicit&>(*static_cast<Workspace*>(workspace)->method); }

void record_task(void* w, int segment) noexcept { method_of(w).record(segment); }
void gather_task(void* w, int group) noexcept { method_of(w).gather(group); }
void base_task(void* w, int group) noexcept { method_of(w).base(group); }
void eliminate_task(void* w, int group) noexcept { method_of(w).solve().eliminate(group); }
void ring_task(void* w, int) noexcept { method_of(w).solve().ring(); }
void substitute_task(void* w, int group) noexcept { method_of(w).solve().substitute(group); }
void look_task(void* w, int group) noexcept { method_of(w).solve().look(group); }
void stage_task(void* w, int group) noexcept { method_of(w).stage(group); }
void finish_task(void* w, int group) noexcept { method_of(w).finish(group); }

/// Fields of these cycles, numbered behind those of the step graph. Units: group, but link for slopes and states.
enum FrictionField { group_field = 2000, own_field, ring_field, element_field };

[[nodiscard]] std::string numbered(const char* name, int number) { return std::string(name) + "[" + std::to_string(number) + "]"; }

/// A group's own parts of slips, and those of its neighbours.
[[nodiscard]] std::vector<engine::Access> near(int group, int groups) {
    std::vector<engine::Access> all{{group_field, group, group + 1, true}};
    for (const int other : {group == 0 ? groups - 1 : group - 1, group, group + 1 == groups ? 0 : group + 1}) all.push_back({own_field, other, other + 1, false});
    return all;
}

}  // namespace

FrictionImplicit::FrictionImplicit(Workspace& workspace)
    : w_(workspace), solve_(workspace), field_(workspace.variator.chain()), normal_loads_(static_cast<std::size_t>(workspace.layout().links)) {}

void FrictionImplicit::add_tasks(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s) {
        graph.add({numbered("record", s), record_cycle, record_task, s,
                   LinkAccesses(w_, s).own(Field::states_read, false).with_halo(Field::stage_state).own(Field::phase, false).segment(Field::window, true).own(Field::contact, true).list()});
    }
    const int groups = solve_.groups();
    const int ring = graph.add({"ring", iterate_cycle, ring_task, 0, {{element_field, 0, groups, false}, {ring_field, 0, 1, true}}});
    std::vector<int> gathers, substitutes;
    for (int k = 0; k < groups; ++k) {
        const int first = solve_.group(k).first, last = solve_.group(k).last, links = w_.layout().links;
        const auto field = [](Field name) { return static_cast<int>(name); };
        gathers.push_back(graph.add({numbered("gather", k), gather_cycle, gather_task, k,
                                     {{field(Field::contact), 0, links, false}, {field(Field::slope_written), first, last, false}, {group_field, k, k + 1, true}, {own_field, k, k + 1, true}}}));
        const int eliminate = graph.add({numbered("eliminate", k), iterate_cycle, eliminate_task, k, {{group_field, k, k + 1, true}, {element_field, k, k + 1, true}}});
        substitutes.push_back(graph.add({numbered("substitute", k), iterate_cycle, substitute_task, k, {{ring_field, 0, 1, false}, {group_field, k, k + 1, true}, {own_field, k, k + 1, true}}}));
        graph.order(eliminate, ring);
        graph.order(ring, substitutes.back());
        graph.add({numbered("look", k), search_cycle, look_task, k, {{group_field, k, k + 1, true}}});
        graph.add({numbered("stage", k), stage_cycle, stage_task, k,
                   {{field(Field::states_read), first, last, false}, {field(Field::slopes_read), first, last, false}, {group_field, k, k + 1, true}, {own_field, k, k + 1, true}, {field(Field::state_kept), first, last, true}}});
        graph.add({numbered("finish", k), finish_cycle, finish_task, k,
                   {{field(Field::states_read), first, last, false}, {group_field, k, k + 1, true}, {field(Field::state_kept), first, last, true}, {field(Field::load), first, last, true}}});
    }
    for (int k = 0; k < groups; ++k) {
        const int base = graph.add({numbered("base", k), gather_cycle, base_task, k, near(k, groups)});
        const int look = graph.add({numbered("look", k), iterate_cycle, look_task, k, near(k, groups)});
        for (const int other : {k == 0 ? groups - 1 : k - 1, k, k + 1 == groups ? 0 : k + 1}) {
            graph.order(gathers[static_cast<std::size_t>(other)], base);
            graph.order(substitutes[static_cast<std::size_t>(other)], look);
        }
    }
}

void FrictionImplicit::record_window(int segment, const double* window, const model::ContactDrift& drift) noexcept {
    const Segment& own = w_.partition[segment];
    solve_.space().friction().record({own.first, own.last, window, w_.sheaves, w_.phases.data()}, drift, field_, normal_loads_.data() + own.first);
}

void FrictionImplicit::read(const double* vector, int offset, int number, model::LaneRows& rows) noexcept {
    const model::ChainLayout& at = w_.layout();
    const model::SlipGroup& g = solve_.group(number);
    for (int link = g.first; link < g.last; ++link) {
        const double* from = vector + at.link_begin(link) + offset;
        for (int row = 0; row < at.link_size(); ++row) rows.at(row)[link - g.first] = from[row];
    }
}

}  // namespace cvtflow::tasks
