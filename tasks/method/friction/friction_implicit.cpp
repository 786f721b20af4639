#include <algorithm>
#include <string>

#include "tasks/method/friction/friction_solve.hpp"
#include "tasks/step/assembly/link_accesses.hpp"

namespace cvtflow::tasks {

namespace {

/// Fields of these cycles, numbered behind those of the step graph. Units: group, but link for slopes and states.
enum FrictionField { group_field = 2000, own_field, joints_field, element_field };

[[nodiscard]] std::string numbered(const char* name, int number) { return std::string(name) + "[" + std::to_string(number) + "]"; }

/// Groups with the neighbours of a group's links, itself among them.
[[nodiscard]] std::vector<int> near(int group, const model::SlipStretches& stretches) {
    std::vector<int> all{group};
    for (int lane = 0; lane < stretches.count(); ++lane) {
        for (const int other : {stretches.before({group, lane}).group, stretches.after({group, lane}).group}) {
            if (std::find(all.begin(), all.end(), other) == all.end()) all.push_back(other);
        }
    }
    return all;
}

/// A group, its own parts of slips, and those of its neighbours.
[[nodiscard]] std::vector<engine::Access> sharing(int group, const std::vector<int>& near) {
    std::vector<engine::Access> all{{group_field, group, group + 1, true}};
    for (const int other : near) all.push_back({own_field, other, other + 1, false});
    return all;
}

/// Accesses to groups, and to the links of one.
class GroupAccesses {
public:
    GroupAccesses(const model::SlipGroup& group, int number) : group_(group), number_(number) {}
    GroupAccesses& links(Field field, bool writes) {
        for (const model::SlipGroup::Link& link : group_.links)
            all_.push_back({static_cast<int>(field), link.number, link.number + 1, writes});
        return *this;
    }
    GroupAccesses& own(FrictionField field) {
        all_.push_back({field, number_, number_ + 1, true});
        return *this;
    }
    GroupAccesses& all(int field, int count) {
        all_.push_back({field, 0, count, false});
        return *this;
    }
    [[nodiscard]] std::vector<engine::Access> list() const { return all_; }

private:
    const model::SlipGroup& group_;
    int number_;
    std::vector<engine::Access> all_;
};

}  // namespace

FrictionImplicit::FrictionImplicit(Workspace& workspace)
    : w_(workspace),
      solve_(workspace),
      field_(workspace.variator.chain()),
      frictionless_(workspace.layout().link_size(), workspace.layout().links + 2),
      normal_loads_(static_cast<std::size_t>(workspace.layout().links)) {}

void FrictionImplicit::add_recording(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s) {
        graph.add({numbered("record", s), record_cycle, engine::code_of<&FrictionImplicit::record>(*this), s,
                   LinkAccesses(w_, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .with_halo(Field::stage_state)
                       .own(Field::phase, false)
                       .segment(Field::window, true)
                       .own(Field::contact, true)
                       .own(Field::force, true)
                       .list()});
    }
}

void FrictionImplicit::add_tasks(engine::TaskGraph& graph) {
    add_recording(graph);
    const int groups = solve_.groups();
    const int join = graph.add({"join",
                                iterate_cycle,
                                engine::code_of<&FrictionSolve::join>(solve_),
                                0,
                                {{element_field, 0, groups, false}, {joints_field, 0, 1, true}}});
    std::vector<int> gathers, substitutes;
    for (int k = 0; k < groups; ++k) {
        const auto accesses = [&] { return GroupAccesses(solve_.group(k), k).own(group_field); };
        gathers.push_back(graph.add({numbered("gather", k), gather_cycle, engine::code_of<&FrictionImplicit::gather>(*this), k,
                                     accesses()
                                         .all(static_cast<int>(Field::contact), w_.layout().links)
                                         .links(Field::states_read, false)
                                         .links(Field::slopes_read, false)
                                         .own(own_field)
                                         .list()}));
        const int eliminate = graph.add({numbered("eliminate", k), iterate_cycle, engine::code_of<&FrictionSolve::eliminate>(solve_), k,
                                         accesses().own(element_field).list()});
        substitutes.push_back(graph.add({numbered("substitute", k), iterate_cycle, engine::code_of<&FrictionSolve::substitute>(solve_), k,
                                         accesses().all(joints_field, 1).own(own_field).list()}));
        graph.order(eliminate, join);
        graph.order(join, substitutes.back());
        graph.add({numbered("search", k), search_cycle, engine::code_of<&FrictionSolve::search>(solve_), k, accesses().list()});
        graph.add({numbered("stage", k), stage_cycle, engine::code_of<&FrictionImplicit::stage>(*this), k,
                   accesses()
                       .links(Field::states_read, false)
                       .links(Field::slopes_read, false)
                       .own(own_field)
                       .links(Field::state_kept, true)
                       .list()});
        graph.add({numbered("finish", k), finish_cycle, engine::code_of<&FrictionImplicit::finish>(*this), k,
                   accesses().links(Field::states_read, false).links(Field::state_kept, true).links(Field::load, true).list()});
    }
    add_neighbours(graph, gathers, substitutes);
}

/// What a group does with the results of those beside it.
void FrictionImplicit::add_neighbours(engine::TaskGraph& graph, const std::vector<int>& gathers, const std::vector<int>& substitutes) {
    for (int k = 0; k < solve_.groups(); ++k) {
        const std::vector<int> others = near(k, solve_.stretches());
        std::vector<engine::Access> forces = GroupAccesses(solve_.group(k), k).links(Field::force, false).list(),
                                    shared = sharing(k, others);
        forces.insert(forces.end(), shared.begin(), shared.end());
        const int base = graph.add({numbered("base", k), gather_cycle, engine::code_of<&FrictionImplicit::base>(*this), k, forces});
        const int search =
            graph.add({numbered("search", k), iterate_cycle, engine::code_of<&FrictionSolve::search>(solve_), k, sharing(k, others)});
        for (const int other : others) {
            graph.order(gathers[static_cast<std::size_t>(other)], base);
            graph.order(substitutes[static_cast<std::size_t>(other)], search);
        }
    }
}

void FrictionImplicit::record_window(int segment, const double* window, const model::ContactDrift& drift) noexcept {
    const Segment& own = w_.partition[segment];
    solve_.space().friction().record({own.first, own.last, window, w_.pulleys.sheaves, w_.tips.phases.data()}, drift, field_, frictionless_,
                                     normal_loads_.data() + own.first);
}

void FrictionImplicit::read(const double* vector, int offset, int number, model::LaneRows& rows) noexcept {
    const model::ChainLayout& at = w_.layout();
    const model::SlipGroup& g = solve_.group(number);
    for (const auto& [link, lane] : g.links) {
        const double* from = vector + at.link_begin(link) + offset;
        for (int row = 0; row < at.link_size(); ++row) rows.at(row)[lane] = from[row];
    }
}

}  // namespace cvtflow::tasks
