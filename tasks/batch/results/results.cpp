#include "tasks/batch/results/results.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <sstream>
#include <tuple>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "model/start/start_state.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::tasks {

void CaseTally::add(const engine::RowLayout& layout, std::span<const std::byte> row) {
    const std::string status = layout.text(row, layout.column("status"));
    ++rows_;
    ++statuses_[status];
    if (layout.has("notes")) {
        for (const std::string& name : engine::words_of(layout.text(row, layout.column("notes")))) ++notes_[name];
    }
    if (status == status_name(CaseStatus::ok) || !layout.has("error")) return;
    const std::string error = layout.text(row, layout.column("error"));
    const long number = layout.integer(row, layout.column("case"));
    const auto known = std::ranges::find_if(failures_, [&](const Failure& each) { return each.status == status && each.error == error; });
    if (known == failures_.end()) {
        if (failures_.size() < max_failures) failures_.push_back({status, error, number, 1});
        return;
    }
    ++known->cases;
    known->first = std::min(known->first, number);
}

long CaseTally::failed() const noexcept {
    const auto ok = statuses_.find(std::string(status_name(CaseStatus::ok)));
    return rows_ - (ok == statuses_.end() ? 0 : ok->second);
}

namespace {

using engine::TableColumn;
using Type = engine::ColumnType;

constexpr int error_width = 240, program_width = 48;

/// Choices, texts, lists and tables are texts in the table.
[[nodiscard]] Type type_of(const Parameter& key) {
    if (key.kind() == Kind::integer) return Type::integer;
    return continuous(key) ? Type::real : Type::text;
}

[[nodiscard]] bool only_numbers(const Axis& axis, std::size_t key) {
    for (std::size_t row = 0; row < axis.rows(); ++row) {
        if (!std::holds_alternative<double>(axis.at(row, key))) return false;
    }
    return true;
}

TableColumn key_column(const Axis& axis, std::size_t key) {
    const Parameter& parameter = *axis.keys[key];
    const Type type = only_numbers(axis, key) ? type_of(parameter) : Type::text;
    std::size_t width = 8;
    for (std::size_t row = 0; type == Type::text && row < axis.rows(); ++row)
        width = std::max(width, axis_text(parameter, axis.at(row, key)).size());
    return {column_name(parameter.key), std::string(parameter.unit), std::string(parameter.meaning), type,
            static_cast<int>(std::min<std::size_t>(width, 256))};
}

/// Column of a scalar's error: of verified cases, or stated by cases that end when they are steady.
TableColumn error_column(const Sweep& sweep, const Scalar& scalar) {
    const char* meaning =
        sweep.steady() ? "relative error of its mean, by trend and scatter; of an efficiency relative to the losses' share, at least 2 %"
                       : "relative error against the reference run; NaN: not verified";
    return {std::string(error_prefix) + scalar.column, "1", fmt::format("{}: {}", scalar.text, meaning)};
}

/// Columns without part in the hash: they differ from run to run, or name what the row comes from.
constexpr std::string_view unhashed[] = {"wall", "threads", "program", "start_state"};

}  // namespace

engine::RowLayout result_layout(const Sweep& sweep) {
    std::vector<TableColumn> columns{{"case", "1", "number of the case", Type::integer},
                                     {"status", "", fmt::format("{}", fmt::join(status_names(), ", ")), Type::text, 16}};
    for (const Axis& axis : sweep.axes) {
        for (std::size_t key = 0; key < axis.keys.size(); ++key) columns.push_back(key_column(axis, key));
    }
    for (const Scalar& scalar : sweep.scalars) columns.push_back({scalar.column, scalar.unit(), scalar.description()});
    for (const Scalar& scalar : sweep.scalars) {
        if (sweep.accuracy.target > 0.0 || sweep.steady()) columns.push_back(error_column(sweep, scalar));
    }
    if (sweep.steady()) columns.push_back({"settled_for", "s", "time until the begin of the means, which are over as long again"});
    columns.insert(columns.end(),
                   {{"efficiency", "1", "1 - losses/input over whole pin periods, from outputs.from on; none without load"},
                    {"energy_residual", "1", "|change of stored energy - work + losses| over the losses of the run"},
                    {"energy_error_ratio", "1",
                     "residual of the energy balance over its tolerance, settling included; above 1 the status is unreliable"},
                    {"notes", "", "what is odd about results that are right: names in `cvtflow list notes`", Type::text, 96},
                    {"start", "", "start of the case: scene, geometric, settled, shared or continued", Type::text, 16},
                    {"start_state", "", "hash of the state that the case began with; none: it settled by itself", Type::text, 16},
                    {"steps", "1", "accepted steps", Type::integer},
                    {"evaluations", "1", "evaluations of the right-hand side", Type::integer},
                    {"transitions", "1", "changes of phase of tips", Type::integer},
                    {"truncated", "1", "steps cut at a transition", Type::integer},
                    {"settling_evaluations", "1", "evaluations while settling", Type::integer},
                    {"wall", "s", "wall time of this case, all sessions"},
                    {"threads", "1", "largest number of threads at once", Type::integer},
                    {"program", "", "version and commit of the program that ran the case", Type::text, program_width},
                    {"hash", "", "of the final state and phases", Type::text, 16},
                    {"error", "", "message of the fault", Type::text, error_width}});
    return engine::RowLayout(std::move(columns));
}

namespace {

/// Hash of the right-hand side at the sweep's geometric or given start: another model, or one rounded differently, gives another.
std::string model_hash(const Sweep& sweep) {
    try {
        const model::Variator variator(sweep.scene.parameters);
        const model::StartState start = model::start_state(sweep.scene.parameters);
        model::EvaluationScratch scratch(variator.layout());
        std::vector<double> slope(start.state.size());
        const std::vector<model::Phase> phases(start.phases.size(), model::Phase::touching);
        model::right_hand_side(variator, 0.0, start.state.data(), phases.data(), slope.data(), scratch);
        return engine::hex(engine::state_hash(slope));
    } catch (const std::invalid_argument&) {
        return "none";  // the base scene's chain does not close; that of a case may
    }
}

}  // namespace

engine::CaseTable empty_table(const Sweep& sweep) {
    engine::CaseTable table;
    table.layout = result_layout(sweep);
    table.attributes = engine::attributes_of(engine::current_provenance());
    table.set({"sweep", sweep.name});
    table.set({"description", sweep.description});
    table.set({"sweep_path", std::filesystem::absolute(sweep.path).lexically_normal().string()});
    table.set({"sweep_text", sweep.text});
    table.set({"parameters", write_scene(sweep.scene)});
    table.set({"definition", sweep.definition() + fmt::format("model = hash {}\n", model_hash(sweep))});
    set_origin(table, sweep);
    table.set({"cases", static_cast<std::int64_t>(sweep.cases())});
    table.set({"status", "running"});
    return table;
}

engine::CaseTable read_results(const std::string& path) {
    engine::CaseTable table = engine::read_cases(path);
    for (const auto& [name, type, kind] :
         {std::tuple{"case", Type::integer, "integers"}, {"status", Type::text, "texts"}, {"hash", Type::text, "texts"}}) {
        if (table.layout.has(name) && table.layout.columns()[table.layout.column(name)].type == type) continue;
        throw engine::RecordError(fmt::format("{}: not the table of a sweep: it has no column '{}' of {}", path, name, kind));
    }
    return table;
}

long cases_of(const engine::CaseTable& table, const std::string& path) {
    constexpr long most = 1'000'000'000;
    const std::string text = table.attribute("cases");
    long cases = -1;
    const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), cases);
    if (wrong != std::errc() || end != text.data() + text.size() || cases < 0 || cases > most) {
        throw engine::RecordError(fmt::format("{}: invalid number of cases: '{}'", path, text));
    }
    return cases;
}

void fill_row(const engine::RowLayout& layout, const Sweep& sweep, const CaseResult& r, std::span<std::byte> row) {
    std::size_t column = 0;
    layout.put(row, column++, static_cast<std::int64_t>(r.number));
    layout.put(row, column++, status_name(r.status));
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        const Axis& axis = sweep.axes[a];
        for (std::size_t key = 0; key < axis.keys.size(); ++key, ++column) {
            const AxisValue& value = axis.at(sweep.row(r.number, a), key);
            const Type type = layout.columns()[column].type;
            if (type == Type::real)
                layout.put(row, column, std::get<double>(value));
            else if (type == Type::integer)
                layout.put(row, column, static_cast<std::int64_t>(std::llround(std::get<double>(value))));
            else
                layout.put(row, column, std::string_view(axis_text(*axis.keys[key], value)));
        }
    }
    for (const double scalar : r.scalars) layout.put(row, column++, scalar);
    if (sweep.accuracy.target > 0.0 || sweep.steady()) {
        for (const double error : r.errors) layout.put(row, column++, error);
    }
    if (sweep.steady()) layout.put(row, column++, r.settled_for);
    for (const double number : {r.efficiency, r.residual, r.balance_error_ratio}) layout.put(row, column++, number);
    layout.put(row, column++, std::string_view(r.notes));
    layout.put(row, column++, r.start);
    layout.put(row, column++, std::string_view(r.start_state != 0 ? engine::hex(r.start_state) : "none"));
    for (const long count : {r.counters.steps, r.counters.evaluations, r.counters.detected, r.counters.truncated, r.settling.evaluations})
        layout.put(row, column++, static_cast<std::int64_t>(count));
    layout.put(row, column++, r.wall);
    layout.put(row, column++, static_cast<std::int64_t>(r.threads));
    layout.put(row, column++, std::string_view(engine::version_text()));
    layout.put(row, column++, std::string_view(engine::hex(r.hash)));
    layout.put(row, column++, std::string_view(r.error));
    layout.seal(row);
}

namespace {

std::map<std::string, std::string> lines_of(const std::string& text) {
    std::map<std::string, std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        const auto equals = line.find(" = ");
        if (equals != std::string::npos) lines[line.substr(0, equals)] = line.substr(equals + 3);
    }
    return lines;
}

}  // namespace

void require_same_sweep(const std::string& path, const engine::CaseTable& there, const engine::CaseTable& here) {
    const auto was = lines_of(there.attribute("definition"));
    const auto is = lines_of(here.attribute("definition"));
    std::vector<std::string> lines;
    const auto value = [](const auto& all, const std::string& key) { return all.contains(key) ? all.at(key) : std::string("nothing"); };
    for (const auto& [key, text] : was) {
        if (value(is, key) != text) lines.push_back(fmt::format("  {} = {} in the table, {} in the sweep", key, text, value(is, key)));
    }
    for (const auto& [key, text] : is) {
        if (!was.contains(key)) lines.push_back(fmt::format("  {} = nothing in the table, {} in the sweep", key, text));
    }
    if (lines.empty() && there.layout.columns() != here.layout.columns()) lines.emplace_back("  the columns differ");
    if (lines.empty()) return;
    const std::string theirs = there.attribute("program"), ours = engine::version_text();
    if (theirs == ours) throw SimulationError(fmt::format("{}: results of another sweep:\n{}", path, fmt::join(lines, "\n")));
    constexpr std::size_t most = 6;  // another version knows other keys
    if (lines.size() > most) {
        const std::size_t further = lines.size() - most;
        lines.resize(most);
        lines.push_back(fmt::format("  and {} more", further));
    }
    throw SimulationError(fmt::format("{}: results of another sweep, by cvtflow {}, where this is {}; use another folder (-o):\n{}", path,
                                      theirs, ours, fmt::join(lines, "\n")));
}

bool is_hashed(std::string_view column) noexcept { return std::ranges::find(unhashed, column) == std::end(unhashed); }

namespace {

/// Everything of a row but wall time, threads, and what it comes from (program, start state).
void add_result(engine::Hash& hash, const engine::RowLayout& layout, std::span<const std::byte> row) {
    for (std::size_t c = 0; c < layout.columns().size(); ++c) {
        const TableColumn& column = layout.columns()[c];
        if (!is_hashed(column.name)) continue;
        hash.add(row.subspan(layout.offset(c), static_cast<std::size_t>(column.width)));
    }
}

/// Numbers of the rows in the order of their cases.
std::vector<std::size_t> case_order(const engine::CaseTable& table) {
    const std::size_t number = table.layout.column("case");
    std::vector<std::size_t> order(table.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return table.layout.integer(table.row(a), number) < table.layout.integer(table.row(b), number);
    });
    return order;
}

}  // namespace

/// Sorts in place, because the table is the largest object in memory: row i is swapped with the row that has its content now.
void sort_rows(engine::CaseTable& table) {
    const std::vector<std::size_t> order = case_order(table);
    const std::size_t bytes = table.layout.bytes();
    for (std::size_t i = 0; i < order.size(); ++i) {
        std::size_t from = order[i];
        while (from < i) from = order[from];
        if (from == i) continue;
        std::byte *a = table.rows.data() + i * bytes, *b = table.rows.data() + from * bytes;
        std::swap_ranges(a, a + bytes, b);
    }
}

std::string results_hash(const engine::CaseTable& table) {
    engine::Hash hash;
    for (const std::size_t row : case_order(table)) add_result(hash, table.layout, table.row(row));
    return hash.hex();
}

std::string csv_text(const engine::CaseTable& table) {
    std::string text;
    for (const TableColumn& column : table.layout.columns()) text += (text.empty() ? "" : ",") + csv_cell(column.name, true);
    text += "\n";
    for (std::size_t row = 0; row < table.size(); ++row) {
        for (std::size_t c = 0; c < table.layout.columns().size(); ++c) {
            const bool is_text = table.layout.columns()[c].type == Type::text;
            text += (c == 0 ? "" : ",") + csv_cell(table.layout.cell(table.row(row), c), is_text);
        }
        text += "\n";
    }
    return text;
}

namespace {

constexpr std::size_t window_rows = 256;  ///< rows lie nearly in the order of their cases

}  // namespace

OrderedRows::OrderedRows(const std::string& path) : reader_(path) {
    const engine::RowLayout& layout = head().layout;
    const std::size_t number = layout.column("case");
    order_.reserve(reader_.size());
    for (std::size_t i = 0; i < reader_.size(); ++i) {
        order_.emplace_back(0, i);
        const auto at = row(i);
        order_.back().first = layout.integer(at, number);
        tally_.add(layout, at);
    }
    std::sort(order_.begin(), order_.end());
}

/// A row of the file.
std::span<const std::byte> OrderedRows::row(std::size_t place) {
    const std::size_t bytes = head().layout.bytes();
    if (place < first_ || place >= first_ + window_.size() / bytes) {
        first_ = place / window_rows * window_rows;
        window_.resize(std::min(window_rows, reader_.size() - first_) * bytes);
        reader_.read(first_, window_);
    }
    return std::span<const std::byte>(window_).subspan((place - first_) * bytes, bytes);
}

std::span<const std::byte> OrderedRows::of_case(long number) {
    const auto found = std::lower_bound(order_.begin(), order_.end(), std::pair<long, std::size_t>(number, 0));
    return found == order_.end() || found->first != number ? std::span<const std::byte>() : row(found->second);
}

std::string OrderedRows::hash(const std::function<void(std::span<std::byte>)>& change) {
    engine::Hash hash;
    std::vector<std::byte> changed(head().layout.bytes());
    for (const auto& [number, place] : order_) {
        std::ranges::copy(row(place), changed.begin());
        if (change) change(changed);
        add_result(hash, head().layout, changed);
    }
    return hash.hex();
}

void OrderedRows::fill(std::size_t first, std::span<std::byte> rows) {
    const std::size_t bytes = head().layout.bytes();
    for (std::size_t i = 0; i < rows.size() / bytes; ++i)
        std::ranges::copy(row(order_[first + i].second), rows.begin() + static_cast<std::ptrdiff_t>(i * bytes));
}

void set_mark(engine::CaseTable& table) {
    engine::Hash hash;
    for (const char* name : {"definition", "shard", "start_states"}) hash.add(table.attribute(name)).add(name);
    for (const engine::TableColumn& column : table.layout.columns())
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
