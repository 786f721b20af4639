#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>

#include "api/fmi/fmi.hpp"
#include "engine/base/archive.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::fmi {

namespace {

using tasks::number_text;

[[nodiscard]] Input input_of(const std::string& name) {
    int number = 0;
    while (input_info(static_cast<Input>(number)).name != name) ++number;  // throws behind the last one
    return static_cast<Input>(number);
}

constexpr double latest_time = 1e6;  ///< 0.1 ns, a thousandth of the shortest steps, is the resolution of time there [s]

/// Thrown through advance_to() by a callback that ends a step early.
struct Enough {};

/// Removes the callback at the end of a step, however that ends: it refers to what the step holds.
class Listener {
public:
    explicit Listener(Simulation& simulation) : simulation_(simulation) {}
    ~Listener() {
        try {
            simulation_.on_output(1.0, nullptr);
        } catch (...) {}  // in use by another thread, which is an error of the importer
    }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

private:
    Simulation& simulation_;
};

/// All bytes of a file. @throws Error (argument)
[[nodiscard]] std::string read_file(const std::string& path) {
    const std::filesystem::path place(std::u8string(path.begin(), path.end()));  // FMI's paths are UTF-8, Windows' are not
    std::ifstream file(place, std::ios::binary);
    if (!file) throw Error(ErrorCode::argument, path + ": cannot be read");
    return {std::istreambuf_iterator<char>(file), {}};
}

/// @throws Error (argument) for malformed lines
[[nodiscard]] Variables read_variables(const std::string& path) {
    constexpr std::string_view kinds[] = {"time", "input", "output", "parameter", "flag"};  // in the order of VariableKind
    Variables variables;
    std::istringstream lines(read_file(path));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        std::uint32_t reference = 0;
        std::string kind;
        Variable variable;
        words >> reference >> kind >> variable.width >> variable.name;
        const auto found = std::ranges::find(kinds, kind);
        if (!words || found == std::end(kinds)) throw Error(ErrorCode::argument, path + ": not a variable: " + line);
        words >> variable.element;
        variable.kind = static_cast<VariableKind>(found - std::begin(kinds));
        variables[reference] = variable;
    }
    return variables;
}

}  // namespace

Instance::Instance(std::string resources)
    : resources_(std::move(resources)),
      variables_(read_variables(resources_ + "/variables.txt")),
      scene_(Scene::parse(read_file(resources_ + "/scene.toml"), resources_ + "/scene.toml")) {}

const Variable& Instance::variable(std::uint32_t reference) const {
    const auto found = variables_.find(reference);
    if (found == variables_.end()) throw Error(ErrorCode::argument, "value reference: there is no " + std::to_string(reference));
    return found->second;
}

/// The state that was exported fits the scene that was exported; another one begins with its geometric start, and settles.
Simulation Instance::made(const std::map<std::string, double>& parameters) const {
    std::vector<std::string> settings;
    for (const auto& [key, value] : parameters) settings.push_back(key + "=" + number_text(value));
    Simulation simulation(scene_.with(settings));
    if (parameters.empty()) {
        const std::string bytes = read_file(resources_ + "/state.bin");
        simulation.set_state(State::from_bytes(std::as_bytes(std::span(bytes.data(), bytes.size()))));
    }
    return simulation;
}

Simulation& Instance::simulation() {
    if (!simulation_) simulation_.emplace(made(parameters_));
    return *simulation_;
}

void Instance::set_start(double time) {
    if (!std::isfinite(time)) throw Error(ErrorCode::argument, "the start time is not a finite number");
    start_ = now_ = time;
}

void Instance::finish_initialisation() {
    simulation().advance_to(0.0);
    ready_ = true;
}

void Instance::reset() {
    simulation_.reset();
    parameters_.clear();
    start_ = now_ = 0.0;
    ready_ = false;
}

double Instance::number(const std::string& key) const { return engine::number_of(scene_.value(key)).value(); }

double Instance::parameter(const std::string& key) const {
    const auto changed = parameters_.find(key);
    return changed != parameters_.end() ? changed->second : number(key);
}

void Instance::get(std::uint32_t reference, std::vector<double>& values) {
    const Variable& row = variable(reference);
    if (row.kind == VariableKind::time) return values.push_back(now_);
    if (row.kind == VariableKind::parameter) return values.push_back(parameter(row.name));
    if (row.kind == VariableKind::input) return values.push_back(simulation().input(input_of(row.name)));
    if (row.kind == VariableKind::flag) throw Error(ErrorCode::argument, row.name + ": is Boolean");
    const std::span<const double> now = simulation().channel(row.name);
    if (row.element + row.width > now.size()) throw Error(ErrorCode::argument, row.name + ": has fewer values");
    values.insert(values.end(), now.begin() + static_cast<std::ptrdiff_t>(row.element),
                  now.begin() + static_cast<std::ptrdiff_t>(row.element + row.width));
}

bool Instance::flag(std::uint32_t reference) {
    const Variable& row = variable(reference);
    if (row.kind != VariableKind::flag) throw Error(ErrorCode::argument, row.name + ": is not Boolean");
    return unreliable();
}

void Instance::set(std::uint32_t reference, double value) {
    const Variable& row = variable(reference);
    if (row.kind == VariableKind::input) return simulation().set_input(input_of(row.name), value);
    if (row.kind != VariableKind::parameter) throw Error(ErrorCode::argument, row.name + ": cannot be set");
    if (value == parameter(row.name)) return;
    if (ready_) throw Error(ErrorCode::argument, row.name + ": a parameter is set before the initialisation ends");
    static_cast<void>(scene_.with(row.name + "=" + number_text(value)));  // the range
    parameters_[row.name] = value;
    if (simulation_) simulation_.reset();
}

void Instance::require_step(double begin, double length) const {
    const std::string step = "a step from " + number_text(begin) + " s of " + number_text(length) + " s";
    if (!(length >= 0.0) || !(std::abs(begin - now_) <= 1e-9 * std::max(1.0, std::abs(now_))))
        throw Error(ErrorCode::argument, step + " after " + number_text(now_) + " s");
    if (length > 0.0 && !(begin + length > begin)) throw Error(ErrorCode::argument, step + ": shorter than the resolution of time there");
    if (!(begin + length - start_ < latest_time))
        throw Error(ErrorCode::argument, step + ": so late that time resolves no step of the chain");
}

void Instance::step(double begin, double length, const Intermediate& intermediate) {
    require_step(begin, length);
    const double last = now_, end = std::max(begin + length, now_);
    Simulation& inside = simulation();
    const Listener listener(inside);
    if (intermediate) {
        const double interval = number("run.output_interval");
        inside.on_output(interval, [&](Simulation& there) {
            if (there.time() + start_ >= end) return;
            now_ = there.time() + start_;
            if (intermediate(now_)) throw Enough{};
        });
    }
    try {
        inside.advance_to(end - start_);
        now_ = end;
    } catch (const Enough&) {  // now_ is the time there
    } catch (...) {
        now_ = last;
        throw;
    }
}

Snapshot Instance::snapshot() { return {parameters_, start_, now_, ready_, simulation().state()}; }

void Instance::restore(const Snapshot& snapshot) {
    const auto take = [&snapshot](Simulation& to) {
        to.set_state(snapshot.state);
        const double ahead = snapshot.now - snapshot.start - std::max(0.0, to.time());
        if (!(ahead <= 1e-9 * std::max(1.0, std::abs(snapshot.now))))
            throw Error(ErrorCode::state, "saved state of an FMU: its times disagree with its state");
    };
    // a snapshot that is refused changes nothing
    if (snapshot.parameters == parameters_) {
        const State before = simulation().state();
        try {
            take(simulation());
        } catch (...) {
            simulation().set_state(before);
            throw;
        }
    } else {
        Simulation other = made(snapshot.parameters);
        take(other);
        simulation_ = std::move(other);
        parameters_ = snapshot.parameters;
    }
    start_ = snapshot.start;
    now_ = snapshot.now;
    ready_ = snapshot.ready;
}

namespace {

void visit(Snapshot& of, std::string& names, std::vector<double>& values, std::vector<std::byte>& state, engine::Archive& archive) {
    archive("fmu_start", of.start), archive("fmu_time", of.now), archive("fmu_ready", of.ready);
    archive("parameters", names), archive("parameter_values", values), archive("state", state);
}

}  // namespace

std::vector<std::byte> Snapshot::bytes() const {
    Snapshot copy = *this;
    std::string names;
    std::vector<double> values;
    for (const auto& [key, value] : parameters) names += key + '\n', values.push_back(value);
    std::vector<std::byte> inside(state.bytes().begin(), state.bytes().end());
    return engine::state_of([&](auto& archive) { visit(copy, names, values, inside, archive); }, inside.size() + names.size() + 1024);
}

Snapshot Snapshot::from_bytes(std::span<const std::byte> bytes) {
    try {
        Snapshot made;
        std::string names;
        std::vector<double> values;
        std::vector<std::byte> inside;
        engine::read_fields(engine::fields_of_state(bytes), [&](auto& archive) { visit(made, names, values, inside, archive); });
        std::istringstream lines(names);
        std::string key;
        for (const double value : values) std::getline(lines, key), made.parameters[key] = value;
        made.state = State::from_bytes(inside);
        if (!std::isfinite(made.start) || !std::isfinite(made.now)) throw engine::ArchiveError("its times are not finite");
        return made;
    } catch (const engine::ArchiveError& error) {
        throw Error(ErrorCode::state, std::string("saved state of an FMU: ") + error.what());
    }
}

}  // namespace cvtflow::fmi
