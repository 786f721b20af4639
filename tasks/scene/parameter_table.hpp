#pragma once
/// The table of all keys of a scene. Parser, --set, explain, JSON schema, writer and tests loop over it; no other list of keys exists.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

struct Entry;
struct Node;
struct Problem;

/// The member of a scene that a key sets. Its type decides how the key is written (Kind); those from PinDetail on are choices.
using Slot = std::variant<double*, int*, long*, std::uint64_t*, bool*, std::string*, std::vector<double>*, model::TimeTable*,
                          model::SpeedTable*, AutoNumber*, std::vector<std::string>*, model::PinDetail*, model::PlateDetail*,
                          model::PulleyDetail*, model::FrictionLaw*, model::JointLaw*, model::TipFriction*, model::Sheave*,
                          model::DriveMode*, model::LoadMode*, model::ControlledQuantity*, ControlGains*, WhenSteady*, DetailLevel*,
                          model::DrivenControl*, model::HydraulicMode*, model::StartLayout*, Assembly*, PartitionKind*, StepControl*>;

enum class Kind { number, auto_number, integer, choice, boolean, text, number_list, time_table, speed_table, text_list };

/// Most points of a time table or of a list.
inline constexpr std::size_t max_points = 10000;
/// Latest time of a time table [s]; the earliest is 0 (while settling, tables are taken at 0).
inline constexpr double latest_time = 1e6;
/// Most points of a table over a speed, and the highest speed [m/s]; the lowest is 0.
inline constexpr std::size_t max_speed_points = 16;
inline constexpr double highest_speed = 1e3;

struct Parameter {
    std::string_view key;                   ///< "section.name"
    std::string_view unit;                  ///< SI unit of a number, "1" for a plain number; empty where there is no number
    double min = 0.0;                       ///< smallest value allowed, in `unit` [unit]
    double max = 0.0;                       ///< largest value allowed [unit]
    std::vector<std::string_view> choices;  ///< words of a choice, in the order of the enumerators; the word of an AutoNumber
    Slot (*member)(Scene&);                 ///< of<&Section::name>
    std::string_view meaning;
    std::string_view source = "model choice";  ///< origin of the default

    [[nodiscard]] std::string_view section() const noexcept { return key.substr(0, key.find('.')); }
    [[nodiscard]] std::string_view name() const noexcept { return key.substr(key.find('.') + 1); }
    [[nodiscard]] Kind kind() const;
};

/// The section of a scene that has members of that type.
template <class Section, class Value>
[[nodiscard]] Section& section_with(Scene& s, Value Section::* /*member*/) {
    model::Parameters& p = s.parameters;
    return std::get<Section&>(std::tie(s, s.run, s.vehicle, s.cycle, p, p.detail, p.chain, p.half, p.plate, p.joint, p.tip, p.oil, p.heat,
                                       p.wear, p.pulley, p.imperfection, p.drive, p.load, p.drag, p.guide, p.clamping, p.control,
                                       p.hydraulics, p.start));
}
/// Parameter::member: that member of its section, or one inside of it.
template <auto member, auto... inside>
[[nodiscard]] Slot of(Scene& scene) {
    return &((section_with(scene, member).*member).*....*inside);
}

/// All rows; the keys of a section are adjacent.
[[nodiscard]] std::span<const Parameter> parameter_table();

/// The row of `key`, or nullptr.
[[nodiscard]] const Parameter* find_parameter(std::string_view key);

/// Sets the member of `parameter` in `scene` to the value of `node`: type, unit, dimension and range are those of its row. Errors are
/// appended to `problems`, with the position of the number, text or list element concerned, and leave the member unchanged.
void read_value(const Parameter& parameter, const Node& node, Scene& scene, std::vector<Problem>& problems);

/// The key that sets other keys, those of a level.
inline constexpr std::string_view level_key = "detail.level";
/// Rows of a section of a file, detail.level first: keys beside it take precedence.
[[nodiscard]] std::vector<const Entry*> level_first(const std::vector<Entry>& rows);

/// The words of a text that spaces separate.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);

/// A condition that the values of a scene must satisfy together.
struct CrossCheck {
    std::vector<std::string_view> keys;  ///< keys whose values are compared; a problem is reported at the first that the scene gives
    /// The violation (a full sentence with its key), or nothing. Expects every key to be within its range.
    std::function<std::optional<std::string>(const Scene&)> violation;
};
[[nodiscard]] std::span<const CrossCheck> cross_checks();

/// Notes that a scene gives a key, of which clamping.safety else has no floor: clamping.driven, hydraulics.driven_pressure.
void note_floor(Scene& scene, std::string_view key) noexcept;
/// Whether a scene leaves that floor to clamping.safety, or to the default. @param key any other: false
[[nodiscard]] bool lacks_floor(const Scene& scene, std::string_view key) noexcept;
/// Whether any key follows from others: from vehicle and cycle, control.gains = "found", clamping.safety, or a table of friction.
[[nodiscard]] bool has_derived(const Scene& scene) noexcept;
/// Whether others determine the value of `key`, and the scene must not.
[[nodiscard]] bool is_derived(const Scene& scene, std::string_view key) noexcept;
/// The problem of a scene that sets such a key.
[[nodiscard]] std::string derived_text(const Scene& scene, std::string_view key);
/// Sets those keys.
void derive(Scene& scene);
/// Sets them to their defaults, before others are set of which they follow.
void forget_derived(Scene& scene);
/// C: the ratio changes by C ω_1 (S_1 - S_1*)/S_2 per time; 0.0018 to 0.012 at operating points [1].
inline constexpr double ratio_mobility = 0.0051;
/// How far a groove between elastic sheaves opens per clamping force, by attachment and tilt of its sheaves and by tips [m/N].
[[nodiscard]] double groove_yield(const model::Parameters& parameters);
/// Clamping force of the driven sheaves at t = 0: by table or pressure, and at least what clamping.safety requires where the chain begins
/// [N].
[[nodiscard]] double driven_clamping_at_start(const model::Parameters& parameters);

/// Keys with other values than their defaults that have no effect on a run of the scene, with the reason: a line for each reason.
[[nodiscard]] std::vector<std::string> idle_keys(const Scene& scene);

/// Suggestions for an unknown key: similar spelling, or the same name in other sections. May be empty.
[[nodiscard]] std::vector<std::string> nearest_keys(std::string_view key);
/// Key of earlier versions. Scenes of their records contain it.
inline constexpr std::string_view order_key = "detail.order";
/// Text behind "unknown key": what replaces a key of earlier versions, or the nearest keys. May be empty.
[[nodiscard]] std::string key_hint(std::string_view key);
/// Text behind "not one of …": what replaces a level of earlier versions, or the nearest choice. May be empty.
[[nodiscard]] std::string choice_hint(std::string_view value, const std::vector<std::string>& choices);

/// Section names in the order of the table.
[[nodiscard]] std::vector<std::string> section_names();

/// The value of a key in `scene`, as TOML.
[[nodiscard]] std::string value_text(const Parameter& parameter, const Scene& scene);

/// The value for people: numbers with their unit, in the usual one where that is shorter ("11 deg").
[[nodiscard]] std::string readable_value(const Parameter& parameter, const Scene& scene);

/// A key in which two scenes differ, with the values of both as text.
struct KeyDifference {
    const Parameter* key;
    std::string a, b;
};

/// Keys of two scenes that differ, in the order of the table. @param counts whether a key is compared   @param text its value in a scene
[[nodiscard]] std::vector<KeyDifference> differing_keys(const Scene& a, const Scene& b, const std::function<bool(const Parameter&)>& counts,
                                                        std::string (*text)(const Parameter&, const Scene&) = value_text);

/// Text of `cvtflow explain key`: meaning, unit, range, default and source.
/// @throws SceneError  unknown key, with the key that was probably meant
[[nodiscard]] std::string explain(std::string_view key);

/// JSON schema (draft 2020-12) of a scene, for editors.
[[nodiscard]] std::string json_schema();

}  // namespace cvtflow::tasks
