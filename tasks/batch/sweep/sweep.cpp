#include "tasks/batch/sweep/sweep.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

long Sweep::cases() const noexcept {
    long count = 1;
    for (const Axis& axis : axes) count *= static_cast<long>(axis.rows());
    return axes.empty() ? 0 : count;
}

std::size_t Sweep::row(long number, std::size_t axis) const noexcept {
    for (std::size_t later = axes.size(); later-- > axis + 1;) number /= static_cast<long>(axes[later].rows());
    return static_cast<std::size_t>(number % static_cast<long>(axes[axis].rows()));
}

void Sweep::apply_case(long number, Scene& of) const {
    forget_derived(of);
    if (scene.gains == ControlGains::given) of.parameters.control = scene.parameters.control;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::size_t at = row(number, a);
        for (std::size_t k = 0; k < axes[a].keys.size(); ++k) apply(*axes[a].keys[k], axes[a].at(at, k), of);
    }
    derive(of);
}

namespace {

/// All values of an axis if they are few, else their number and hash.
std::string axis_line(const Axis& axis) {
    std::vector<std::string> names, values;
    for (const Parameter* key : axis.keys) names.emplace_back(key->key);
    engine::Hash hash;
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
        const std::string value = axis_text(*axis.keys[i % axis.keys.size()], axis.values[i]);
        hash.add(std::string_view(value)).add(std::string_view("\n"));
        if (axis.values.size() <= 24) values.push_back(value);
    }
    const std::string list =
        values.empty() ? fmt::format("{} rows, hash {}", axis.rows(), hash.hex()) : fmt::format("{}", fmt::join(values, ", "));
    return fmt::format("axes.{} = {}\n", fmt::join(names, "+"), list);
}

}  // namespace

std::string Sweep::definition() const {
    std::string lines;
    for (const Parameter& parameter : parameter_table()) {
        const bool matters = !may_change(parameter.key) || parameter.key.starts_with("run.until") ||
                             parameter.key.starts_with("run.steady") || parameter.key == "run.max_steps";
        if (matters) lines += fmt::format("{} = {}\n", parameter.key, value_text(parameter, scene));
    }
    for (const Axis& axis : axes) lines += axis_line(axis);
    for (const Scalar& scalar : scalars) lines += fmt::format("outputs.scalars.{0} = {0}\n", scalar.text);
    lines += fmt::format("outputs.from = {}\n", number_text(from));
    lines += fmt::format("start.mode = {}\n", sweep_choices("start", "mode")[static_cast<std::size_t>(start)]);
    lines += fmt::format("start.continuation = {}\n", continuation);
    if (!across.empty()) lines += fmt::format("start.across = {}\n", across);
    return lines;
}

std::vector<long> draw_cases(long cases, long count, std::uint64_t seed) {
    const auto requested = static_cast<std::size_t>(std::min(cases, count));
    std::set<long> drawn;
    for (std::uint64_t more = 0; drawn.size() < requested; ++more) {
        for (const double share : random_samples(requested, 1, seed + more)) {
            if (drawn.size() < requested) drawn.insert(static_cast<long>(share * static_cast<double>(cases)));
        }
    }
    return {drawn.begin(), drawn.end()};
}

std::string violations(const Scene& scene) {
    std::string text;
    for (const CrossCheck& check : cross_checks()) {
        if (const auto violation = check.violation(scene)) text += (text.empty() ? "" : "; ") + *violation;
    }
    return text;
}

Scene scene_of_case(const Sweep& sweep, long number) {
    Scene scene = sweep.scene;
    sweep.apply_case(number, scene);
    const bool settles = sweep.start != StartMode::scene || !violations(scene).empty() || fitting_start(scene) == nullptr;
    if (settles) scene.state_file.clear();
    return scene;
}

namespace {

/// Rows of an axis in which one of its keys is lowest or highest; texts have their first and last row.
std::set<std::size_t> extreme_rows(const Axis& axis) {
    std::set<std::size_t> rows{0, axis.rows() - 1};
    for (std::size_t key = 0; key < axis.keys.size(); ++key) {
        std::size_t lowest = 0, highest = 0;
        for (std::size_t row = 0; row < axis.rows(); ++row) {
            const auto* value = std::get_if<double>(&axis.at(row, key));
            const auto *low = std::get_if<double>(&axis.at(lowest, key)), *high = std::get_if<double>(&axis.at(highest, key));
            if (value == nullptr || low == nullptr || high == nullptr) continue;
            if (*value < *low) lowest = row;
            if (*value > *high) highest = row;
        }
        rows.insert({lowest, highest});
    }
    return rows;
}

/// Cases at the corners of a sweep's axes: all combinations of the rows in which a key is lowest, highest, first or last. If there are more
/// than 8, that number is picked evenly, first and last included. Cases whose values contradict each other are left out.
std::vector<long> corner_cases(const Sweep& sweep) {
    constexpr std::size_t most = 8;
    std::vector<long> corners{0};
    for (const Axis& axis : sweep.axes) {
        std::vector<long> more;
        for (const long before : corners) {
            for (const std::size_t row : extreme_rows(axis))
                more.push_back(before * static_cast<long>(axis.rows()) + static_cast<long>(row));
        }
        corners = std::move(more);
    }
    std::erase_if(corners, [&](long number) {
        Scene scene = sweep.scene;
        sweep.apply_case(number, scene);
        return !violations(scene).empty();
    });
    if (corners.size() <= most) return corners;
    std::vector<long> picked;
    for (std::size_t i = 0; i < most; ++i) picked.push_back(corners[i * (corners.size() - 1) / (most - 1)]);
    return picked;
}

using FindScene = std::function<std::filesystem::path(const std::string&)>;

/// The first section that only scenes have, in a file without [sweep]; nullptr if there is none.
[[nodiscard]] const Entry* section_of_scene(const Node::Table& sections, const std::vector<std::string>& known) {
    if (std::ranges::find(sections, "sweep", &Entry::key) != sections.end()) return nullptr;
    const auto found = std::ranges::find_if(sections, [&](const Entry& section) {
        return std::ranges::find(known, section.key) == known.end() &&
               std::ranges::find(parameter_table(), section.key, &Parameter::section) != parameter_table().end();
    });
    return found == sections.end() ? nullptr : &*found;
}

class SweepReader {
public:
    SweepReader(const std::filesystem::path& path, std::string text, const FindScene& find_scene) : find_scene_(find_scene) {
        sweep_.path = path;
        sweep_.name = engine::name_of_file(path.stem().string());
        sweep_.text = std::move(text);
    }

    Sweep read() {
        const auto parsed = parse_toml(sweep_.text);
        if (const auto* wrong = std::get_if<Problem>(&parsed))
            problems_.push_back(*wrong);
        else
            document(std::get<Node::Table>(std::get<Node>(parsed).value));
        if (problems_.empty()) return std::move(sweep_);
        throw SceneError(problems_text(std::move(problems_), [this](Position position) {
            return fmt::format("{}:{}:{}", sweep_.path.string(), position.line, position.column);
        }));
    }

private:
    void document(const Node::Table& sections) {
        const std::vector<std::string> known = sweep_sections();
        if (const Entry* section = section_of_scene(sections, known); section != nullptr)
            return problems_.push_back({section->position, fmt::format("{}: this is a scene, not a sweep; to run it: cvtflow run {}",
                                                                       section->key, sweep_.path.string())});
        for (const Entry& section : sections) {
            if (std::find(known.begin(), known.end(), section.key) != known.end()) continue;
            problems_.push_back(
                {section.position,
                 fmt::format("{}: unknown section{}", section.key,
                             problems_.size() < max_problems ? engine::did_you_mean(engine::closest(section.key, known)) : "")});
        }
        if (const auto section = std::ranges::find(sections, "sweep", &Entry::key); section != sections.end())
            read(*section, &SweepReader::head);
        else
            problems_.push_back({{}, "sweep: this section is missing; [sweep] names the scene"});
        for (const Entry& section : sections) {
            if (section.key == "set") settings("", section);
            if (section.key == "axes") axes(section);
            if (section.key == "outputs") read(section, &SweepReader::outputs);
            if (section.key == "budget") read(section, &SweepReader::budget);
            if (section.key == "accuracy") read(section, &SweepReader::accuracy);
            if (section.key == "steady") read(section, &SweepReader::confirmation);
        }
        if (const auto section = std::ranges::find(sections, "start", &Entry::key); section != sections.end())
            read(*section, &SweepReader::start);
        consistent();
    }

    [[nodiscard]] const Node::Table* table(const Entry& section) {
        const auto* found = std::get_if<Node::Table>(&section.node.value);
        if (found == nullptr) problems_.push_back({section.position, fmt::format("{0}: not a section; write [{0}]", section.key)});
        return found;
    }

    void read(const Entry& section, void (SweepReader::*keys)(const TableView&)) {
        if (const Node::Table* rows = table(section)) (this->*keys)(TableView(section.key, *rows, section.position, problems_));
    }

    void head(const TableView& view) {
        sweep_.name = view.text("name").value_or(sweep_.name);
        sweep_.description = view.text("description").value_or("");
        if (const std::string wrong = engine::name_problem(sweep_.name); !wrong.empty())
            view.problem(view.find("name")->position, fmt::format("name: {} {}", toml_text(sweep_.name.substr(0, 60)), wrong));
        if (const std::string wrong = engine::text_problem(sweep_.description); !wrong.empty())
            view.problem(view.find("description")->position, fmt::format("description: {}", wrong));
        only_ = view.find("only");
        if (!view.require("scene")) return;
        const auto name = view.text("scene");
        if (name) scene(*name, view);
    }

    void scene(const std::string& name, const TableView& view) {
        try {
            const auto beside = sweep_.path.parent_path() / name;
            std::error_code unreadable;
            sweep_.scene = read_scene(std::filesystem::is_regular_file(beside, unreadable) ? beside : find_scene_(name));
            if (const auto preset = view.text("detail")) apply_detail(sweep_.scene, *preset);
            forget_derived(sweep_.scene);
        } catch (const SceneError& error) {
            view.problem(view.find("scene")->position, fmt::format("scene: {}", error.what()));
        }
    }

    /// Keys of the scene, also in tables of their section.
    void settings(const std::string& section, const Entry& entry) {
        const Node::Table* rows = table(entry);
        if (rows == nullptr) return;
        for (const Entry* row : level_first(*rows)) {
            const std::string key = section.empty() ? row->key : section + "." + row->key;
            if (section.empty() && std::holds_alternative<Node::Table>(row->node.value))
                settings(row->key, *row);
            else if (const Parameter* parameter = find_parameter(key))
                setting(*parameter, row->node);
            else
                problems_.push_back(
                    {row->position, fmt::format("set.{}: unknown key{}", key, problems_.size() < max_problems ? key_hint(key) : "")});
        }
    }

    void setting(const Parameter& parameter, const Node& node) {
        set_.emplace_back(parameter.key, node.position);
        note_floor(sweep_.scene, parameter.key);
        read_value(parameter, node, sweep_.scene, problems_);
        if (parameter.key != "start.state" || sweep_.scene.state_file.empty()) return;
        sweep_.scene.state_place = fmt::format("{}:{}:{}: ", sweep_.path.string(), node.position.line, node.position.column);
        sweep_.scene.state_file =
            std::filesystem::absolute(sweep_.path.parent_path() / sweep_.scene.state_file).lexically_normal().string();
    }

    void axes(const Entry& section) {
        const auto* list = std::get_if<Node::Array>(&section.node.value);
        if (list == nullptr) return problems_.push_back({section.position, "axes: not a list of tables; write [[axes]]"});
        for (const Node& node : *list) {
            Axis axis = read_axis(section, node, sweep_.path.parent_path(), problems_);
            if (!axis.keys.empty()) sweep_.axes.push_back(std::move(axis));
        }
    }

    void outputs(const TableView& view) {
        const Node::Array* list = view.list("scalars");
        for (const Node& node : list != nullptr ? *list : Node::Array{}) {
            const auto* text = std::get_if<std::string>(&node.value);
            if (text == nullptr) {
                view.problem(node.position, "scalars: not a text such as \"slip mean\"");
                continue;
            }
            sweep_.scalars.push_back(parse_scalar(*text, node.position, problems_));
        }
        sweep_.from = view.time("from").value_or(0.0);
        sweep_.records = view.boolean("records").value_or(false);
    }

    void budget(const TableView& view) {
        if (const auto steps = view.integer("steps", 1, std::int64_t{1} << 53)) sweep_.scene.run.max_steps = static_cast<long>(*steps);
        if (const auto wall = view.time("wall")) sweep_.scene.run.max_wall = *wall;
    }

    void accuracy(const TableView& view) {
        SweepAccuracy& accuracy = sweep_.accuracy;
        if (view.require("target")) accuracy.target = view.share("target").value_or(0.0);
        accuracy.verify = static_cast<int>(view.integer("verify", 0, 1'000'000).value_or(accuracy.verify));
        accuracy.seed = static_cast<std::uint64_t>(view.integer("seed", 0, std::int64_t{1} << 53).value_or(0));
    }

    void confirmation(const TableView& view) {
        sweep_.confirmation.cases = static_cast<int>(view.integer("confirm", 0, 1'000'000).value_or(sweep_.confirmation.cases));
        sweep_.confirmation.seed = static_cast<std::uint64_t>(view.integer("seed", 0, std::int64_t{1} << 53).value_or(0));
        if (!sweep_.steady()) problems_.push_back({view.position(), "steady: only with run.until = \"steady\" in [set]"});
    }

    void start(const TableView& view) {
        sweep_.start = static_cast<StartMode>(view.choice("mode").value_or(0));
        if (const auto checked = view.integer("check", 0, 1'000'000)) sweep_.checked = static_cast<int>(*checked);
        if (const auto key = view.text("continuation")) sweep_.line = steps("continuation", *key, view, 1, sweep_.continuation);
        if (const auto key = view.text("across")) sweep_.lines = steps("across", *key, view, sweep_.line, sweep_.across);
    }

    /// Rows along which a key rises: of an axis, or of a csv axis every `stride`-th one.
    long steps(const char* name, const std::string& key, const TableView& view, long stride, std::string& kept) {
        kept = key;
        const auto problem = [&](const char* what) {
            view.problem(view.find(name)->position, fmt::format("{}: {} {}", name, toml_text(key), what));
            return 1L;
        };
        if (stride == 1 && name == std::string_view("across")) return problem("is about lines of a continuation");
        const std::size_t last = sweep_.axes.size();
        const bool inner = stride == 1 || (last > 0 && sweep_.axes.back().kind == "csv");
        if (last < (inner ? 1u : 2u)) return problem("is not a key of the last axis");
        const Axis& axis = sweep_.axes[last - (inner ? 1 : 2)];
        const auto found = std::ranges::find(axis.keys, key, &Parameter::key);
        if (found == axis.keys.end()) return problem("is not a key of the last axis");
        if (axis.kind != "csv") return static_cast<long>(axis.rows());
        if (!inner) stride = 1;
        const auto every = static_cast<std::size_t>(stride), rows = axis.rows() / every;
        const auto rises = [&](std::size_t row) {
            const auto at = [&](std::size_t r) {
                return std::get_if<double>(&axis.at(r * every, static_cast<std::size_t>(found - axis.keys.begin())));
            };
            return at(row) != nullptr && at(row - 1) != nullptr && *at(row) > *at(row - 1);
        };
        std::size_t length = 1;
        while (length < rows && rises(length)) ++length;
        for (std::size_t row = 1; row < rows; ++row) {
            if (rises(row) != (row % length != 0)) return problem("does not rise along lines of rows of equal length in the csv");
        }
        if (rows % length != 0) return problem("does not rise along lines of rows of equal length in the csv");
        return static_cast<long>(length);
    }

    void consistent() {
        if (!problems_.empty()) return;
        for (const Axis& axis : sweep_.axes)
            for (const Parameter* key : axis.keys) note_floor(sweep_.scene, key->key);
        derive(sweep_.scene);
        for (const auto& [key, position] : set_) independent(key, position);
        if (sweep_.axes.empty()) problems_.push_back({{}, "axes: none given; nothing varies"});
        if (sweep_.scalars.empty()) problems_.push_back({{}, "outputs.scalars: none given"});
        std::vector<std::string_view> seen;
        for (const Axis& axis : sweep_.axes) {
            for (const Parameter* key : axis.keys) {
                if (std::find(seen.begin(), seen.end(), key->key) != seen.end())
                    problems_.push_back({{}, fmt::format("axes: {} varies on two axes", key->key)});
                seen.push_back(key->key);
                tunable(key->key);
                independent(key->key, {});
            }
        }
        if (sweep_.accuracy.target > 0.0 && sweep_.start == StartMode::shared)
            problems_.push_back({{}, "accuracy: start.mode \"shared\" starts from an unsettled state; use \"settle\""});
        if (sweep_.accuracy.target > 0.0 && sweep_.steady())
            problems_.push_back({{}, "accuracy: run.until = \"steady\" has no fixed time; give one"});
        outputs_within_run();
        keep_cases();
        if (!Method::find(method_of(sweep_.scene))) problems_.push_back({{}, "run.method: " + no_method(sweep_.scene.run.method)});
    }

    /// Outputs beyond the end of a case are not finite, and the case would be undefined.
    void outputs_within_run() {
        double end = latest_end(sweep_.scene);
        for (const Axis& axis : sweep_.axes) {
            for (std::size_t key = 0; key < axis.keys.size(); ++key) {
                for (std::size_t row = 0; axis.keys[key]->key == "run.until" && row < axis.rows(); ++row) {
                    const auto* value = std::get_if<double>(&axis.at(row, key));
                    if (value == nullptr || sweep_.steady())
                        return problems_.push_back({{}, "run.until: \"steady\" is for all cases; it is no value of an axis"});
                    if (value != nullptr) end = row == 0 ? *value : std::min(end, *value);
                }
            }
        }
        const auto beyond = [end](double time) { return time > end * (1.0 + 1e-9); };
        const std::string text = fmt::format("is beyond run.until = {} s", number_text(end));
        if (beyond(sweep_.from))
            problems_.push_back({{}, fmt::format("outputs.from: {} s {}: no output would count", number_text(sweep_.from), text)});
        const bool instant = std::isfinite(end) && sweep_.from >= end * (1.0 - 1e-9);
        for (const Scalar& scalar : sweep_.scalars) {
            if (instant && !beyond(sweep_.from) && std::ranges::any_of(scalar.terms, &ScalarTerm::over_time))
                problems_.push_back(
                    {{},
                     fmt::format("outputs.from: {} s is run.until: no time is left for \"{}\"", number_text(sweep_.from), scalar.text)});
            const auto late = [&](const ScalarTerm& term) { return term.reduction == Reduction::at && beyond(term.time); };
            if (std::ranges::any_of(scalar.terms, late))
                problems_.push_back({{}, fmt::format("outputs.scalars: \"{}\" {}", scalar.text, text)});
        }
    }

    /// Keys that [accuracy] chooses cannot be axes as well.
    void tunable(std::string_view key) {
        const bool found = key.starts_with("detail.") || key == "run.method" || key.starts_with("run.step");
        if (sweep_.accuracy.target > 0.0 && found)
            problems_.push_back({{}, fmt::format("accuracy: {} varies, but detail, method and step are chosen by [accuracy]", key)});
    }

    /// Leaves the cases of sweep.only: rows of one axis.
    void keep_cases() {
        if (only_ == nullptr || !problems_.empty()) return;
        const auto* numbers = std::get_if<Node::Array>(&only_->value);
        const auto* rule = std::get_if<std::string>(&only_->value);
        std::vector<long> cases = rule != nullptr && *rule == "corners" ? corner_cases(sweep_) : std::vector<long>{};
        for (const Node& node : numbers != nullptr ? *numbers : Node::Array{}) {
            const auto* number = std::get_if<std::int64_t>(&node.value);
            cases.push_back(number != nullptr && *number >= 0 && *number < sweep_.cases() ? static_cast<long>(*number) : -1);
        }
        if (cases.empty() || std::ranges::find(cases, -1) != cases.end())
            return problems_.push_back(
                {{}, fmt::format("sweep.only: not \"corners\" of valid cases, nor a list of numbers below {}", sweep_.cases())});
        Axis kept{"zip", {}, {}};
        for (const Axis& axis : sweep_.axes) kept.keys.insert(kept.keys.end(), axis.keys.begin(), axis.keys.end());
        for (const long number : cases) {
            for (std::size_t a = 0; a < sweep_.axes.size(); ++a) {
                const Axis& axis = sweep_.axes[a];
                for (std::size_t k = 0; k < axis.keys.size(); ++k) kept.values.push_back(axis.at(sweep_.row(number, a), k));
            }
        }
        sweep_.axes = {kept};
        sweep_.continuation.clear();
        sweep_.across.clear();
        sweep_.line = sweep_.lines = 1;
    }

    void independent(std::string_view key, Position position) {
        if (is_derived(sweep_.scene, key)) problems_.push_back({position, derived_text(sweep_.scene, key)});
    }

    const FindScene& find_scene_;
    Sweep sweep_;
    const Node* only_ = nullptr;                              ///< sweep.only
    std::vector<std::pair<std::string_view, Position>> set_;  ///< keys of [set]
    std::vector<Problem> problems_;
};

}  // namespace

Sweep read_sweep(const std::filesystem::path& path, const FindScene& find_scene) {
    return SweepReader(path, read_toml_text(path), find_scene).read();
}

}  // namespace cvtflow::tasks
