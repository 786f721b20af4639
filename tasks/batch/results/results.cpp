#include "tasks/batch/results/results.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "model/start/start_state.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::string_view format_name = "cvtflow sweep 1";

/// Columns without part in the hash: they differ from run to run, or name what the row comes from.
constexpr std::string_view unhashed[] = {"wall", "program", "start_state"};

[[nodiscard]] bool is_hashed(std::string_view column) noexcept { return std::ranges::find(unhashed, column) == std::end(unhashed); }

[[nodiscard]] std::string in(const std::string& folder, const char* name) { return (fs::path(folder) / name).string(); }

/// Column of the error that cases state which end when they are steady.
ResultColumn error_column(const Scalar& scalar) {
    return {
        std::string(error_prefix) + scalar.column, "1",
        scalar.text + ": relative error of its mean, by trend and scatter; of an efficiency relative to the losses' share, at least 2 %"};
}

}  // namespace

std::vector<ResultColumn> result_columns(const Sweep& sweep) {
    std::vector<ResultColumn> columns{{"case", "1", "number of the case"},
                                      {"status", "", fmt::format("{}", fmt::join(status_names(), ", "))}};
    for (const Axis& axis : sweep.axes) {
        for (const Parameter* key : axis.keys)
            columns.push_back({column_name(key->key), std::string(key->unit), std::string(key->meaning), std::string(key->key)});
    }
    for (const Scalar& scalar : sweep.scalars) columns.push_back({scalar.column, scalar.unit(), scalar.description()});
    for (const Scalar& scalar : sweep.scalars) {
        if (sweep.steady()) columns.push_back(error_column(scalar));
    }
    if (sweep.steady()) columns.push_back({"settled_for", "s", "time until the begin of the means, which are over as long again"});
    columns.insert(columns.end(),
                   {{"efficiency", "1", "1 - losses/input over whole pin periods, from outputs.from on; none without load"},
                    {"energy_residual", "1", "|change of stored energy - work + losses| over the losses of the run"},
                    {"energy_error_ratio", "1",
                     "residual of the energy balance over its tolerance, settling included; above 1 the status is unreliable"},
                    {"notes", "", "what is odd about results that are right: names in `cvtflow list notes`"},
                    {"start", "", "start of the case: scene, geometric, settled, shared or continued"},
                    {"start_state", "", "hash of the state that the case began with; none: it settled by itself"},
                    {"steps", "1", "accepted steps"},
                    {"evaluations", "1", "evaluations of the right-hand side"},
                    {"transitions", "1", "changes of phase of tips"},
                    {"truncated", "1", "steps cut at a transition"},
                    {"settling_evaluations", "1", "evaluations while settling"},
                    {"wall", "s", "wall time of this case"},
                    {"program", "", "version and commit of the program that ran the case"},
                    {"hash", "", "of the final state and phases"},
                    {"error", "", "message of the fault"}});
    return columns;
}

std::string heading_of(const std::vector<ResultColumn>& columns) {
    std::string text;
    for (const auto& [name, unit, description, key] : columns)
        text += (text.empty() ? "" : ",") + csv_cell(unit.empty() || unit == "1" ? name : fmt::format("{} [{}]", name, unit), true);
    return text;
}

namespace {

/// Cells that grow by numbers and texts.
class RowText {
public:
    void add(double value) { add_cell(fmt::format("{}", value)); }
    void add(long value) { add_cell(fmt::format("{}", value)); }
    void add(std::string_view text) {
        std::string line(text);
        std::ranges::replace(line, '\n', ' ');
        add_cell(csv_cell(line, true));
    }
    [[nodiscard]] std::string text() && { return std::move(text_); }

private:
    void add_cell(const std::string& cell) { text_ += (text_.empty() ? "" : ",") + cell; }
    std::string text_;
};

void add_value(const Parameter& key, const AxisValue& value, RowText& row) {
    const auto* number = std::get_if<double>(&value);
    if (number != nullptr && continuous(key)) return row.add(*number);
    if (number != nullptr && key.kind() == Kind::integer) return row.add(std::lround(*number));
    row.add(std::string_view(axis_text(key, value)));
}

}  // namespace

std::string row_of(const Sweep& sweep, const CaseResult& r) {
    RowText row;
    row.add(r.number);
    row.add(status_name(r.status));
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        for (std::size_t key = 0; key < sweep.axes[a].keys.size(); ++key)
            add_value(*sweep.axes[a].keys[key], sweep.axes[a].at(sweep.row(r.number, a), key), row);
    }
    for (const double scalar : r.scalars) row.add(scalar);
    if (sweep.steady()) {
        for (const double error : r.errors) row.add(error);
    }
    if (sweep.steady()) row.add(r.settled_for);
    for (const double number : {r.efficiency, r.residual, r.balance_error_ratio}) row.add(number);
    row.add(std::string_view(r.notes));
    row.add(r.start);
    row.add(std::string_view(r.start_state != 0 ? engine::hex(r.start_state) : "none"));
    for (const long count : {r.counters.steps, r.counters.evaluations, r.counters.detected, r.counters.truncated, r.settling.evaluations})
        row.add(count);
    row.add(r.wall);
    row.add(std::string_view(engine::version_text()));
    row.add(std::string_view(engine::hex(r.hash)));
    row.add(std::string_view(r.error));
    return std::move(row).text();
}

std::string SweepFacts::text(std::string_view name) const {
    for (const engine::Attribute& each : attributes)
        if (each.name == name) return std::visit([](const auto& value) { return fmt::format("{}", value); }, each.value);
    return {};
}

void SweepFacts::set(engine::Attribute attribute) {
    const auto known = std::ranges::find(attributes, attribute.name, &engine::Attribute::name);
    if (known != attributes.end())
        known->value = std::move(attribute.value);
    else
        attributes.push_back(std::move(attribute));
}

long SweepFacts::cases() const {
    const auto* cases = engine::attribute_value<std::int64_t>(attributes, "cases");
    return cases != nullptr ? static_cast<long>(*cases) : 0;
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

/// Hash of the start states that cases name: the one of the scene, or those of an axis.
std::string start_states_of(const Sweep& sweep) {
    if (sweep.start != StartMode::scene) return "none";
    std::vector<Scene> scenes;
    for (const Axis& axis : sweep.axes) {
        for (std::size_t key = 0; key < axis.keys.size(); ++key) {
            for (std::size_t row = 0; axis.keys[key]->key == "start.state" && row < axis.rows(); ++row) {
                scenes.push_back(sweep.scene);
                apply(*axis.keys[key], axis.at(row, key), scenes.back());
            }
        }
    }
    if (scenes.empty()) scenes.push_back(sweep.scene);
    engine::Hash hash;
    bool any = false;
    for (const Scene& scene : scenes) {
        if (scene.state_file.empty()) continue;
        hash.add(content_hash(*saved_start(scene)));
        any = true;
    }
    return any ? hash.hex() : "none";
}

}  // namespace

SweepFacts facts_of(const Sweep& sweep) {
    SweepFacts facts;
    facts.columns = result_columns(sweep);
    facts.set({"sweep", sweep.name});
    facts.set({"description", sweep.description});
    facts.set({"sweep_path", fs::absolute(sweep.path).lexically_normal().string()});
    facts.set({"cases", static_cast<std::int64_t>(sweep.cases())});
    facts.set({"status", "running"});
    facts.set({"definition", sweep.definition() + fmt::format("model = hash {}\n", model_hash(sweep))});
    facts.set({"parameters", write_scene(sweep.scene)});
    facts.set({"program", engine::version_text()});
    facts.set({"start_states", start_states_of(sweep)});
    facts.set({"records", sweep.records ? "true" : "false"});
    for (const engine::Attribute& each : engine::attributes_of(engine::current_provenance())) facts.set(each);
    return facts;
}

bool holds_sweep(const std::string& folder) {
    std::error_code absent;
    return fs::exists(in(folder, "sweep.json"), absent) || fs::exists(in(folder, "cases.h5"), absent);
}

namespace {

constexpr std::uint64_t longest_facts = std::uint64_t{64} << 20U;

Json value_of(const engine::Attribute& attribute) {
    return std::visit([](const auto& value) { return Json(value); }, attribute.value);
}

/// @throws nlohmann::json::exception
SweepFacts parsed(const Json& json) {
    SweepFacts facts;
    for (const auto& [name, value] : json.items()) {
        if (name == "format" || name == "columns") continue;
        if (value.is_number_integer())
            facts.set({name, value.get<std::int64_t>()});
        else if (value.is_number())
            facts.set({name, value.get<double>()});
        else
            facts.set({name, value.get<std::string>()});
    }
    for (const Json& column : json.at("columns"))
        facts.columns.push_back({column.at("name"), column.at("unit"), column.at("description"), column.value("key", "")});
    return facts;
}

}  // namespace

SweepFacts read_facts(const std::string& folder) {
    const std::string path = in(folder, "sweep.json");
    std::error_code absent;
    if (!fs::exists(path, absent)) {
        if (fs::exists(in(folder, "cases.h5"), absent) || fs::exists(in(folder, "workers"), absent))
            throw engine::RecordError(folder +
                                      ": results of cvtflow 0.4 or before, which this version neither reads nor continues; `cvtflow "
                                      "table DIR --csv` of that version writes a CSV, which this one reads; name another folder");
        throw engine::RecordError(folder + ": contains no sweep");
    }
    try {
        const Json json = Json::parse(engine::read_text_input(path, longest_facts));
        if (!json.is_object() || json.value("format", "") != format_name)
            throw engine::RecordError(path + ": not the facts of a sweep, or of a later version");
        return parsed(json);
    } catch (const engine::InputError& error) {
        throw engine::RecordError(path + ": " + error.what());
    } catch (const Json::exception&) {
        const std::string other = engine::other_than_file(path);
        throw engine::RecordError(path + ": " + (other.empty() ? "damaged: move it away, and the sweep continues with its rows" : other));
    }
}

namespace {

/// A file of the sweep, which replaces one with that text in its first 4 KiB, and the zeros that a power cut has left of it.
[[nodiscard]] engine::OutputFile own_file(const std::string& folder, const char* name, std::string mark) {
    const auto own = [mark = mark.substr(0, 1024)](const std::string& there) {
        const std::string head = engine::head_of(there);
        return head.find(mark) != std::string::npos || head.find_first_not_of('\0') == std::string::npos;
    };
    return {in(folder, name), own, remove_by_hand};
}

}  // namespace

void write_facts(const std::string& folder, const SweepFacts& facts) {
    Json json{{"format", format_name}};
    for (const engine::Attribute& each : facts.attributes) json[each.name] = value_of(each);
    json["columns"] = Json::array();
    for (const auto& [name, unit, description, key] : facts.columns) {
        Json column{{"name", name}, {"unit", unit}, {"description", description}};
        if (!key.empty()) column["key"] = key;
        if (const DisplayUnit shown = display_unit(name, unit); shown.unit != unit) column["shown"] = {shown.unit, shown.factor};
        json["columns"].push_back(std::move(column));
    }
    const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    engine::write_whole(own_file(folder, "sweep.json", std::string(format_name)), text);
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

/// @throws SimulationError, a line per difference
void require_same_sweep(const std::string& folder, const SweepFacts& there, const SweepFacts& here) {
    const auto was = lines_of(there.text("definition")), is = lines_of(here.text("definition"));
    std::vector<std::string> lines;
    const auto value = [](const auto& all, const std::string& key) { return all.contains(key) ? all.at(key) : std::string("nothing"); };
    for (const auto& [key, text] : was) {
        if (value(is, key) != text) lines.push_back(fmt::format("  {} = {} there, {} in the sweep", key, text, value(is, key)));
    }
    for (const auto& [key, text] : is) {
        if (!was.contains(key)) lines.push_back(fmt::format("  {} = nothing there, {} in the sweep", key, text));
    }
    for (const auto& [attribute, name] :
         {std::pair{"program", "program"}, {"start_states", "content of start.state"}, {"records", "outputs.records"}}) {
        if (there.text(attribute) != here.text(attribute))
            lines.push_back(fmt::format("  {} {} there, {} here", name, there.text(attribute), here.text(attribute)));
    }
    if (lines.empty() && there.columns != here.columns) lines.emplace_back("  the columns differ");
    if (lines.empty()) return;
    constexpr std::size_t most = 6;  // another version knows other keys
    if (const std::size_t further = lines.size(); further > most) {
        lines.resize(most);
        lines.push_back(fmt::format("  and {} more", further - most));
    }
    throw SimulationError(fmt::format("{}: results of another sweep; use another folder (-o):\n{}", folder, fmt::join(lines, "\n")));
}

/// A copy of the sweep's file beside its results, unless the sweep lies there itself.
void keep_text(const std::string& folder, const Sweep& sweep) {
    const std::string path = in(folder, "sweep.toml");
    std::error_code absent;
    if (fs::is_regular_file(fs::symlink_status(path, absent)) && engine::read_text_input(path, longest_toml) == sweep.text) return;
    const auto own = [&](const std::string& there) {  // also what a power cut has left of it: bytes of the text, others are zero
        const std::string left = engine::read_text_input(there, longest_toml);
        return left == sweep.text ||
               (there.ends_with(".part") && left.size() <= sweep.text.size() &&
                std::equal(left.begin(), left.end(), sweep.text.begin(), [](char is, char was) { return is == was || is == '\0'; }));
    };
    engine::write_whole({path, own, remove_by_hand}, sweep.text);
}

}  // namespace

SweepFacts begin_results(const std::string& folder, const Sweep& sweep) {
    constexpr int attempts = 100;  // of processes that begin a sweep together one writes
    const SweepFacts here = facts_of(sweep);
    engine::OutputFile results = own_file(folder, "results.csv", heading_of(here.columns));
    if (!holds_sweep(folder)) results.may_replace = nullptr;
    engine::require_place(results);
    for (int attempt = 1, idle = 0; !holds_sweep(folder); ++attempt) {
        try {
            keep_text(folder, sweep);
            write_facts(folder, here);
        } catch (const engine::RecordError&) {
            // Another one may have begun neither file again, or just ended one, but only so often.
            idle += !engine::being_written(in(folder, "sweep.json.part")) && !engine::being_written(in(folder, "sweep.toml.part"));
            if (attempt == attempts || idle == 4) throw;
            usleep(20'000);
        }
    }
    SweepFacts there = read_facts(folder);
    require_same_sweep(folder, there, here);
    return there;
}

void CaseTally::add(long number, const std::string& status, const std::string& notes, const std::string& error) {
    ++rows_;
    ++statuses_[status];
    for (const std::string& name : engine::words_of(notes)) ++notes_[name];
    if (status == status_name(CaseStatus::ok)) return;
    const auto known = std::ranges::find_if(failures_, [&](const Failure& each) { return each.status == status && each.error == error; });
    if (known != failures_.end()) {
        ++known->cases;
        known->first = std::min(known->first, number);
    } else if (failures_.size() < max_failures) {
        failures_.push_back({status, error, number, 1});
    }
}

long CaseTally::failed() const noexcept {
    const auto ok = statuses_.find(std::string(status_name(CaseStatus::ok)));
    return rows_ - (ok == statuses_.end() ? 0 : ok->second);
}

SweepRows::SweepRows(const std::string& folder, SweepFacts facts) : facts_(std::move(facts)), files_(folder, facts_.finished()) {
    if (files_.heading().empty()) return;
    if (files_.heading() + "\n" != engine::checked_heading(heading_of(facts_.columns)))
        throw engine::RecordError(folder + ": the columns of its rows are not those of sweep.json");
    if (facts_.finished() && !files_.damage().empty()) throw engine::RecordError(files_.damage().front());
}

std::size_t SweepRows::column(std::string_view name) const {
    const auto found = std::ranges::find(facts_.columns, name, &ResultColumn::name);
    if (found == facts_.columns.end()) throw std::out_of_range(fmt::format("no column {}", name));
    return static_cast<std::size_t>(found - facts_.columns.begin());
}

std::vector<std::string> SweepRows::cells(long number) const {
    std::vector<std::string> cells = std::move(csv_lines(files_.row(number)).front());
    cells.resize(facts_.columns.size());
    return cells;
}

std::string SweepRows::text(long of_case, std::string_view name) const { return cells(of_case)[column(name)]; }
double SweepRows::number(long of_case, std::string_view name) const { return engine::number_of(text(of_case, name)).value_or(NAN); }

CaseTally SweepRows::tally() const {
    const std::size_t status = column("status"), notes = column("notes"), error = column("error");
    CaseTally tally;
    for (const long number : files_.numbers()) {
        const std::vector<std::string> row = cells(number);
        tally.add(number, row[status], row[notes], row[error]);
    }
    return tally;
}

std::string SweepRows::hash() const {
    engine::Hash hash;
    for (const long number : files_.numbers()) {
        const std::vector<std::string> row = cells(number);
        for (std::size_t c = 0; c < row.size(); ++c)
            if (is_hashed(facts_.columns[c].name)) hash.add(std::string_view(row[c])).add(std::string_view("\n"));
    }
    return hash.hex();
}

std::string SweepRows::file(const std::function<void(long, std::vector<std::string>&)>& change) const {
    std::string text = engine::checked_heading(heading_of(facts_.columns));
    for (const long number : files_.numbers()) {
        std::string line = files_.row(number);
        if (change) {
            std::vector<std::string> row = cells(number);
            change(number, row);
            RowText changed;
            for (const std::string& cell : row) changed.add(std::string_view(cell));
            line = std::move(changed).text();
        }
        text += engine::checked_line(line);
    }
    return text;
}

void write_results(const std::string& folder, const SweepFacts& facts, const std::string& rows) {
    engine::write_whole(own_file(folder, "results.csv", heading_of(facts.columns)), rows);
    write_facts(folder, facts);
}

void drop_rows(const std::string& folder, const SweepFacts& facts, const std::vector<std::string>& statuses) {
    const std::vector<std::string> before = engine::row_files_in(folder);
    for (const std::string& name : before) {
        if (engine::being_written(in(folder, name.c_str())))
            throw SimulationError(fmt::format("{}: a process is at work there ({}); --retry waits for nobody", folder, name));
    }
    const SweepRows rows(folder, facts);
    SweepFacts running = facts;
    running.set({"status", "running"});
    write_facts(folder, running);
    const std::size_t status = rows.column("status");
    engine::RowWriter kept(folder, engine::checked_heading(heading_of(facts.columns)));
    for (const long number : rows.files().numbers()) {
        if (std::ranges::find(statuses, rows.cells(number)[status]) == statuses.end())
            kept.append(engine::checked_line(rows.files().row(number)));
    }
    kept.finish();
    for (const std::string& name : before) fs::remove(fs::path(folder) / name);
}

FolderProgress folder_progress(const std::string& folder) {
    const SweepRows rows(folder);
    FolderProgress progress{rows.facts(), rows.tally(), {}};
    std::map<std::string, long> pieces;
    for (const auto& [piece, owner] : engine::read_claims(folder)) ++pieces[owner];
    const std::map<std::string, long> by_file = rows.files().by_file();
    for (const std::string& name : engine::row_files_in(folder)) {
        const auto found = by_file.find(name);
        progress.workers.push_back(
            {name, found == by_file.end() ? 0 : found->second, pieces[name], engine::being_written(in(folder, name.c_str()))});
    }
    return progress;
}

}  // namespace cvtflow::tasks
