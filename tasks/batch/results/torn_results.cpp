#include "tasks/batch/results/torn_results.hpp"

#include <algorithm>

#include "engine/base/hash.hpp"
#include "engine/record/case_table.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/origin.hpp"
#include "tasks/batch/results/results.hpp"

namespace cvtflow::tasks {

void set_mark(engine::CaseTable& table) {
    engine::Hash hash;
    for (const char* name : {"definition", "shard", "start_states"}) hash.add(table.attribute(name)).add(name);
    for (const engine::CaseColumn& column : table.layout.columns())
        hash.add(column.name + "\n" + column.unit + "\n" + column.description + "\n" + std::to_string(static_cast<int>(column.type)) + " " +
                 std::to_string(column.width));
    table.set({"mark", std::string(mark_of_a_sweep) + hash.hex()});
}

std::optional<engine::CaseTable> recover_results(const std::string& path, const engine::CaseTable& begin) {
    if (!engine::torn_while_growing(path, begin.attribute("mark"))) return std::nullopt;
    const std::size_t number = begin.layout.column("case"), status = begin.layout.column("status");
    const long cases = cases_of(begin, path);
    const auto statuses = status_names();
    engine::CaseTable table = begin;
    table.rows = engine::whole_rows(path, table.layout, [&](std::span<const std::byte> row) {
        const std::int64_t of_case = table.layout.integer(row, number);
        return of_case >= 0 && of_case < cases && std::ranges::find(statuses, table.layout.text(row, status)) != statuses.end();
    });
    set_programs_of_rows(table);
    return table;
}

}  // namespace cvtflow::tasks
