#include "tasks/scene/scene.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "engine/thread/guards.hpp"
#include "model/machine/belt.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

struct KeptState::Kept {
    engine::Mutex mutex;
    std::string path;
    engine::FileIdentity identity;
    std::shared_ptr<const engine::SavedState> state;
};

KeptState::KeptState() : kept_(std::make_shared<Kept>()) {}

std::shared_ptr<const engine::SavedState> KeptState::read(const std::string& path) const {
    Kept& kept = *kept_;
    return kept.mutex.guard([&] {
        const engine::FileIdentity now = engine::identity_of(path);
        const bool known = kept.state != nullptr && kept.path == path && (now == kept.identity || now == engine::FileIdentity{});
        if (!known) {
            kept.state = nullptr;
            kept.state = std::make_shared<const engine::SavedState>(engine::read_state(path));
            kept.path = path;
            kept.identity = now;
        }
        return kept.state;
    });
}

namespace {

/// A key in a message: as written, unless it contains unprintable characters or is very long.
std::string shown(const std::string& key) { return key.size() <= 100 ? key : key.substr(0, 60) + "…"; }

/// A scene while it is read: keys given, keys that are wrong, problems so far.
class Reading {
public:
    /// Relative start.state paths count from `folder`.
    /// @param nowhere  position of a violation of which no key was given
    Reading(Scene scene, std::filesystem::path folder, StartState start = StartState::required, Position nowhere = {})
        : scene_(std::move(scene)), folder_(std::move(folder)), start_(start), nowhere_(nowhere) {
        forget_derived(scene_);
    }

    void section(const Entry& entry);
    void value(const Parameter& parameter, const Node& node);
    void unknown_key(const std::string& key, Position position) {
        problem(position, fmt::format("{}: unknown key{}", shown(key), problems_.size() < max_problems ? key_hint(key) : ""));
    }
    void problem(Position position, std::string message) { problems_.push_back({position, std::move(message)}); }

    /// Checks what values must satisfy together, then hands over the scene.
    /// @param place  text before a problem's message, for its position
    /// @throws SceneError  if there is any problem
    Scene finish(const std::function<std::string(Position)>& place);

private:
    void resolve_state(const Node& node);
    void check(const CrossCheck& cross_check);
    void check_order();
    void follow();

    Scene scene_;
    std::filesystem::path folder_;
    StartState start_;
    Position nowhere_;
    std::map<std::string_view, Position> given_;
    std::set<std::string_view> wrong_;
    const Entry* recorded_order_ = nullptr;  ///< entry of an earlier version's record
    std::vector<Problem> problems_;
};

void Reading::section(const Entry& entry) {
    const auto names = section_names();
    const bool hint = problems_.size() < max_problems;
    const auto* table = std::get_if<Node::Table>(&entry.node.value);
    if (std::find(names.begin(), names.end(), entry.key) == names.end()) {
        if (table)
            return problem(entry.position, fmt::format("{}: unknown section{}", shown(entry.key),
                                                       hint ? engine::did_you_mean(engine::closest(entry.key, names)) : ""));
        return problem(entry.position, fmt::format("{}: key outside any section{}", shown(entry.key),
                                                   hint ? engine::did_you_mean(nearest_keys(entry.key)) : ""));
    }
    if (!table) return problem(entry.position, fmt::format("{0}: not a section; write [{0}]", entry.key));
    for (const Entry* row : level_first(*table)) {
        const std::string key = fmt::format("{}.{}", entry.key, row->key);
        if (const Parameter* parameter = find_parameter(key))
            value(*parameter, row->node);
        else if (start_ == StartState::recorded && key == order_key)
            recorded_order_ = row;
        else
            unknown_key(key, row->position);
    }
}

void Reading::check_order() {
    if (recorded_order_ == nullptr) return;
    const bool rigid = scene_.parameters.detail.pins == model::PinDetail::rigid;
    const auto* order = std::get_if<std::int64_t>(&recorded_order_->node.value);
    if (order == nullptr || *order != (rigid ? model::rigid_pin_order : model::axis_order))
        unknown_key(std::string(order_key), recorded_order_->position);
}

void Reading::value(const Parameter& parameter, const Node& node) {
    const std::size_t before = problems_.size();
    given_[parameter.key] = node.position;
    note_floor(scene_, parameter.key);
    const bool takes_file = parameter.kind() == Kind::time_table || parameter.kind() == Kind::speed_table;
    const bool names_file = takes_file && names_csv(node);
    if (names_file && start_ == StartState::recorded)
        problem(node.position, fmt::format("{}: a recorded scene has the points of its tables; it names no file", parameter.key));
    else if (names_file)
        read_csv_points(parameter, node, folder_, scene_, problems_);
    else
        read_value(parameter, node, scene_, problems_);
    if (parameter.key == "start.state" && problems_.size() == before) resolve_state(node);
    if (problems_.size() == before)
        wrong_.erase(parameter.key);
    else
        wrong_.insert(parameter.key);
}

void Reading::resolve_state(const Node& node) {
    if (scene_.state_file.empty()) return;
    const auto file = std::filesystem::absolute(folder_ / scene_.state_file).lexically_normal();
    if (start_ != StartState::recorded) scene_.named_files.push_back(file);
    if (start_ != StartState::required) return scene_.state_file.clear();
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(file, unreadable))
        problem(node.position, fmt::format("start.state: no file {}", toml_text(scene_.state_file)));
    scene_.state_file = file.string();
}

void Reading::check(const CrossCheck& cross_check) {
    const auto& keys = cross_check.keys;
    if (std::ranges::any_of(keys, [&](std::string_view key) { return wrong_.contains(key); })) return;
    auto violation = cross_check.violation(scene_);
    if (!violation) return;
    const auto first = std::ranges::find_if(keys, [&](std::string_view key) { return given_.contains(key); });
    const auto level = given_.find(level_key);  // sets some of the keys
    const Position otherwise = level == given_.end() ? nowhere_ : level->second;
    problem(first == keys.end() ? otherwise : given_[*first], std::move(*violation));
}

/// Keys that follow from others may be given with the value that follows only, as in the scene of a record. Gains of a record are those
/// that acted, whatever this program finds.
void Reading::follow() {
    if (!problems_.empty() || !has_derived(scene_)) return;
    const Scene before = scene_;
    derive(scene_);
    if (start_ == StartState::recorded && given_.contains("control.proportional")) scene_.parameters.control = before.parameters.control;
    for (const auto& [key, position] : given_) {
        const Parameter& parameter = *find_parameter(key);
        if (is_derived(scene_, key) && value_text(parameter, before) != value_text(parameter, scene_))
            problem(position, derived_text(scene_, key));
    }
}

Scene Reading::finish(const std::function<std::string(Position)>& place) {
    follow();
    check_order();
    for (const CrossCheck& cross_check : cross_checks()) check(cross_check);
    for (const auto& [key, to] : {std::pair{"start.state", &scene_.state_place}, {"run.method", &scene_.method_place}}) {
        if (const auto given = given_.find(key); given != given_.end()) *to = place(given->second) + ": ";
    }
    if (problems_.empty()) return std::move(scene_);
    throw SceneError(problems_text(std::move(problems_), place));
}

/// The value of a setting on the command line. Texts and choices are taken as they are; quantities ("8.12 mm") need no quotes.
std::variant<Node, Problem> parse_setting(const Parameter& parameter, const std::string& text) {
    const Kind kind = parameter.kind();
    const bool in_toml = text.starts_with('"') || text.starts_with('\'') || text.starts_with('[') || text.starts_with('{');
    if (!in_toml && (kind == Kind::text || kind == Kind::choice || kind == Kind::text_list)) return Node{text, {}};
    auto parsed = parse_toml("value = " + text);
    if (auto* document = std::get_if<Node>(&parsed)) {
        const auto& entries = std::get<Node::Table>(document->value);
        const bool date = entries.size() == 1 && std::holds_alternative<Date>(entries.front().node.value);
        if (entries.size() == 1 && !date) return entries.front().node;
    }
    if (in_toml && std::holds_alternative<Problem>(parsed)) return parsed;
    return Node{text, {}};
}

/// Gives every part of a value the position of its setting.
void place_at(Node& node, Position position) {
    node.position = position;
    if (auto* list = std::get_if<Node::Array>(&node.value))
        for (Node& element : *list) place_at(element, position);
    if (auto* table = std::get_if<Node::Table>(&node.value))
        for (Entry& entry : *table) place_at(entry.node, position);
}

void read_setting(Reading& reading, const std::string& setting, Position position) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) return reading.problem(position, "not of the form key=value");
    const std::string key = setting.substr(0, equals);
    const Parameter* parameter = find_parameter(key);
    if (!parameter) return reading.unknown_key(key, position);
    auto parsed = parse_setting(*parameter, setting.substr(equals + 1));
    if (auto* wrong = std::get_if<Problem>(&parsed)) return reading.problem(position, fmt::format("{}: {}", key, wrong->message));
    auto& node = std::get<Node>(parsed);
    place_at(node, position);
    reading.value(*parameter, node);
}

}  // namespace

std::vector<std::filesystem::path> input_files(const Scene& scene) {
    std::vector<std::filesystem::path> files{scene.path, scene.state_file};
    files.insert(files.end(), scene.named_files.begin(), scene.named_files.end());
    return files;
}

std::string method_of(const Scene& scene) { return std::string(resolved_method(scene.run.method, scene.parameters)); }

std::string read_toml_text(const std::filesystem::path& path) {
    try {
        return engine::read_text_input(path.string(), longest_toml);
    } catch (const engine::InputError& reason) {
        throw SceneError(fmt::format("{}: cannot be read: {}", path.string(), reason.what()));
    }
}

Scene read_scene(const std::filesystem::path& path, StartState start) { return parse_scene(read_toml_text(path), path, start); }

Scene parse_scene(std::string text, std::filesystem::path name, StartState start) {
    const auto place = [&](Position position) { return fmt::format("{}:{}:{}", name.string(), position.line, position.column); };
    const auto parsed = parse_toml(text);
    if (const auto* wrong = std::get_if<Problem>(&parsed)) throw SceneError(fmt::format("{}: {}", place(wrong->position), wrong->message));
    const auto& sections = std::get<Node::Table>(std::get<Node>(parsed).value);
    if (const auto sweep = std::ranges::find(sections, "sweep", &Entry::key); sweep != sections.end())
        throw SceneError(
            fmt::format("{}: sweep: this is a sweep, not a scene; to run it: cvtflow batch {}", place(sweep->position), name.string()));
    Reading reading(Scene{}, name.parent_path(), start);
    for (const Entry& entry : sections) reading.section(entry);
    Scene scene = reading.finish(place);
    if (scene.name.empty()) scene.name = engine::name_of_file(name.stem().string());
    scene.text = std::move(text);
    scene.path = std::move(name);
    return scene;
}

void set_values(Scene& scene, std::span<const std::string> settings, std::string_view origin) {
    constexpr Position nowhere{-1, 0};
    Reading reading(scene, {}, StartState::required, nowhere);
    int number = 0;
    for (const std::string& setting : settings) read_setting(reading, setting, {number++, 0});
    const auto setting_at = [&](Position position) { return settings[static_cast<std::size_t>(position.line)]; };
    scene = reading.finish([&](Position position) {
        return position == nowhere ? fmt::format("{}, its present value", scene.name)
               : origin.empty()    ? shown(setting_at(position))
                                   : fmt::format("{}{}", origin, setting_at(position));
    });
}

void set_value(Scene& scene, std::string_view setting) {
    const std::string text(setting);
    set_values(scene, {&text, 1});
}

double latest_end(const Scene& scene) {
    if (!scene.run.until.automatic()) return scene.run.until;
    const model::Parameters& p = scene.parameters;
    const double length = model::chain_length(p.chain);
    const double radius = 2.0 * p.pulley.arc_position / (1.0 + p.start.ratio);  // of the driving pulley, as if both had a constant sum
    const double speed = p.drive.mode == model::DriveMode::torque ? p.control.reference_speed : std::abs(p.drive.speed.at(0.0));
    constexpr double slowest = 1e-2;  // a chain that stands ends its run at once [m/s]
    return scene.run.steady_limit * length / std::max(slowest, speed * radius);
}

std::span<const DetailPreset> detail_presets() noexcept {
    using enum model::PinDetail;
    using model::PlateDetail;
    using model::PulleyDetail;
    static constexpr std::array presets{
        DetailPreset{"rigid", "pins of one body, whose halves slide along it and bend in one shape, lumped plates", rigid,
                     PlateDetail::lumped, 1, PulleyDetail::elastic, 0.06, 0.006, 0.033},
        DetailPreset{"fine", "bending halves, every plate, elastic pulleys", halves, PlateDetail::each, 3, PulleyDetail::elastic, 1.0,
                     0.0031, 0.0053},
        DetailPreset{"full", "fine, with eight points per joint", halves, PlateDetail::each, 8, PulleyDetail::elastic, 1.2, 2.1e-5, 1.6e-4},
    };
    return presets;
}

std::span<const std::string_view> dial_keys() noexcept {
    static constexpr std::array<std::string_view, 4> keys{"detail.pins", "detail.plates", "detail.joint_points", "detail.pulleys"};
    return keys;
}

std::span<const std::string_view> state_keys() noexcept {
    static constexpr std::array<std::string_view, 4> keys{"detail.pins", "detail.plates", "detail.pulleys", "chain.pins"};
    return keys;
}

std::string_view level_of(const Scene& scene) noexcept {
    const model::Detail& detail = scene.parameters.detail;
    for (const DetailPreset& preset : detail_presets()) {
        const bool pulleys = preset.pulleys == detail.pulleys || detail.pulleys == model::PulleyDetail::absent;
        if (preset.pins == detail.pins && preset.plates == detail.plates && preset.joint_points == detail.joint_points && pulleys)
            return preset.name;
    }
    return {};
}

void apply_detail(Scene& scene, std::string_view preset) {
    const auto presets = detail_presets();
    const auto chosen = std::ranges::find(presets, preset, &DetailPreset::name);
    if (chosen == presets.end()) {
        std::vector<std::string> names;
        for (const auto& row : presets) names.emplace_back(row.name);
        throw SceneError(fmt::format("detail {}: not one of {}{}", preset, fmt::join(names, ", "), choice_hint(preset, names)));
    }
    auto& detail = scene.parameters.detail;
    detail.pins = chosen->pins;
    detail.plates = chosen->plates;
    detail.joint_points = chosen->joint_points;
    if (detail.pulleys != model::PulleyDetail::absent) detail.pulleys = chosen->pulleys;
}

}  // namespace cvtflow::tasks
