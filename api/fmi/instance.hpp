#pragma once
/// One instance of an FMU, without the standard's types: what both versions of the standard ask for.

#include <cstddef>
#include <cstdint>
#include <cvtflow/simulation.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace cvtflow::fmi {

enum class VariableKind { time, input, output, parameter, flag };

struct Variable {
    VariableKind kind = VariableKind::time;
    std::size_t width = 1;    ///< values
    std::size_t element = 0;  ///< the first of them in the channel
    std::string name;
};

/// By value reference, as the FMU's description numbers them: a text file in its resources, a line each, written by `cvtflow export-fmu`.
///
///     0 time 1 time
///     1 input 1 load_torque
///     5 output 24 links/tension        value reference, kind, values, name
///     29 output 1 links/tension 3      one element of a channel, counted from 0
///     40 parameter 1 tip.mass
///     41 flag 1 unreliable                 the only Boolean
using Variables = std::map<std::uint32_t, Variable>;

/// @throws Error (argument) for malformed lines
[[nodiscard]] Variables read_variables(const std::string& path);

/// All bytes of a file. @throws Error (argument)
[[nodiscard]] std::string read_file(const std::string& path);

/// Everything that a later instance of the same FMU needs for a bitwise continuation.
struct Snapshot {
    std::map<std::string, double> parameters;  ///< that differ from the scene's
    double start = 0.0, now = 0.0;             ///< communication points [s]
    bool ready = false;                        ///< the initialisation is over
    State state;

    [[nodiscard]] std::vector<std::byte> bytes() const;
    /// @throws Error (state)
    [[nodiscard]] static Snapshot from_bytes(std::span<const std::byte> bytes);
};

/// Called at output times inside a communication step with the time there [s]. @return whether the step shall end there
using Intermediate = std::function<bool(double)>;

class Instance {
public:
    /// @param resources folder of the FMU's resources. @throws Error
    explicit Instance(std::string resources);

    void set_start(double time);  ///< time [s]. @throws Error (argument)
    /// The start state with the parameters and inputs so far; settles it if parameters ask for that. @throws Error
    void finish_initialisation();
    void reset();

    /// All values of a variable, appended. @throws Error (argument) for an unknown reference, and for the flag
    void get(std::uint32_t reference, std::vector<double>& values);
    /// Value of the flag. @throws Error (argument) for other references
    [[nodiscard]] bool flag(std::uint32_t reference);
    /// value [unit of the variable]. @throws Error (argument) for outputs, and for parameters after the initialisation
    void set(std::uint32_t reference, double value);

    /// One communication step [s]; now() is then its end, or where `intermediate` ended it. @throws Error (argument) if it does not
    /// begin where the last one ended; faults, after which now() is the end of the last step
    void step(double begin, double length, const Intermediate& intermediate);

    [[nodiscard]] Snapshot snapshot();
    /// @throws Error (state); nothing has changed then
    void restore(const Snapshot& snapshot);
    /// Inside a step the time of the callback [s].
    [[nodiscard]] double now() const noexcept { return now_; }
    /// Whether the energy balance does not close, so that results are wrong.
    [[nodiscard]] bool unreliable() { return !simulation().energy().reliable; }
    /// Warnings, one line each.
    [[nodiscard]] std::vector<std::string> notices() { return simulation().notices(); }

private:
    [[nodiscard]] const Variable& variable(std::uint32_t reference) const;
    [[nodiscard]] Simulation& simulation();
    [[nodiscard]] Simulation made(const std::map<std::string, double>& parameters) const;
    void require_step(double begin, double length) const;
    [[nodiscard]] double number(const std::string& key) const;  ///< of the scene
    [[nodiscard]] double parameter(const std::string& key) const;

    std::string resources_;
    Variables variables_;
    Scene scene_;
    std::map<std::string, double> parameters_;
    std::optional<Simulation> simulation_;
    double start_ = 0.0, now_ = 0.0;  ///< [s]
    bool ready_ = false;
};

}  // namespace cvtflow::fmi
