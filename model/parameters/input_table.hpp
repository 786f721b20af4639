#pragma once
/// Every input over time in one table: what a scene gives as a table, and which of them a host may set instead. A new one is a row here,
/// an enumerator, and where it acts: the scene's key (tasks/scene/parameter_table.cpp) and the model take it from there.

#include <array>
#include <cstddef>
#include <optional>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// Number of a row of input_table. Those that hosts set come first, with the numbers of their interfaces (cvtflow::Input).
enum class Input : int {
    clamping_driving,
    clamping_driven,
    load_torque,
    drive_torque,
    drive_speed,
    ratio,
    load_speed,
    load_angle,
    drive_angle,
    pressure_driving,
    pressure_driven,
    slip,  // first that no host sets
    safety,
    pump_speed,
    count
};
inline constexpr std::size_t input_count = static_cast<std::size_t>(Input::count), host_inputs = static_cast<std::size_t>(Input::slip);

struct InputRow {
    const char* name;                              ///< name in hosts
    const char* key;                               ///< key of scenes, whose unit and range hold; of angles of far ends the name
    const TimeTable* (*table)(const Parameters&);  ///< nullptr: a scene has none, since it follows from a speed
    bool (*acts)(const Parameters&);               ///< whether the machine has it
    const char* needs;                             ///< the same in words
    int turns = none;                              ///< shaft whose far end it turns, by its speed, or by its angle without a table

    static constexpr int none = -1;
    [[nodiscard]] constexpr bool is_angle() const noexcept { return table == nullptr; }
};
extern const std::array<InputRow, input_count> input_table;

/// Values in place of tables, by Input.
struct InputValues {
    std::array<std::optional<double>, input_count> value{};

    [[nodiscard]] std::optional<double>& operator[](Input input) noexcept { return value[static_cast<std::size_t>(input)]; }
    [[nodiscard]] const std::optional<double>& operator[](Input input) const noexcept { return value[static_cast<std::size_t>(input)]; }
    /// What is set, or what the table gives. t [s]   @return [unit of the input]
    [[nodiscard]] double at(Input input, const TimeTable& table, double t) const noexcept {
        const std::optional<double>& set = (*this)[input];
        return set ? *set : table.at(t);
    }
    bool operator==(const InputValues&) const = default;
};

}  // namespace cvtflow::model
