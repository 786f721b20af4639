#include "tools/program/output/fmu/fmu_variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "engine/base/spelling.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

/// Those of the wanted names that are there, all if none is wanted.
std::vector<std::string> chosen(const char* option, const std::vector<std::string>& wanted, const std::vector<std::string>& there) {
    for (const std::string& name : wanted) {
        if (std::find(there.begin(), there.end(), name) != there.end()) continue;
        throw UsageError(fmt::format("{}: the scene has no '{}'{}", option, name, engine::did_you_mean(engine::closest(name, there))));
    }
    return wanted.empty() ? there : wanted;
}

std::vector<FmuVariable> inputs(const Simulation& simulation, const std::vector<std::string>& wanted) {
    std::vector<FmuVariable> rows;
    std::vector<std::string> names;
    for (int number = 0; number <= static_cast<int>(Input::ratio); ++number) {
        const auto input = static_cast<Input>(number);
        const InputInfo info = input_info(input);
        try {
            rows.push_back({0, "input", std::string(info.name), std::string(info.unit), std::string(info.description), 1,
                            simulation.input(input), std::string(info.name)});
            names.emplace_back(info.name);
        } catch (const Error&) {  // not in this scene
        }
    }
    const std::vector<std::string> kept = chosen("--inputs", wanted, names);
    std::erase_if(rows, [&](const FmuVariable& row) { return std::find(kept.begin(), kept.end(), row.name) == kept.end(); });
    return rows;
}

std::vector<FmuVariable> outputs(const Simulation& simulation, const std::vector<std::string>& wanted, bool arrays) {
    std::vector<std::string> names, scalars;
    for (std::size_t index = 0; index < simulation.channels(); ++index) {
        const ChannelInfo info = simulation.channel_info(index);
        names.emplace_back(info.name);
        if (info.width == 1) scalars.emplace_back(info.name);
    }
    std::vector<FmuVariable> rows;
    for (const std::string& name : wanted.empty() ? scalars : chosen("--outputs", wanted, names)) {
        const ChannelInfo info = simulation.channel_info(simulation.find_channel(name));
        const bool whole = arrays || info.width == 1;
        for (std::size_t element = 0; element < (whole ? 1 : info.width); ++element) {
            rows.push_back({0, "output", whole ? name : fmt::format("{}[{}]", name, element + 1), std::string(info.unit),
                            std::string(info.description), whole ? info.width : 1, 0.0, name, element});
        }
    }
    return rows;
}

/// Numbers of the machine; what decides the size of the state, the method or the run stays as it was exported.
std::vector<FmuVariable> parameters(const Scene& scene) {
    std::vector<FmuVariable> rows;
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        if (row.kind() != tasks::Kind::number || row.section() == "run" || row.section() == "start") continue;
        const std::string key(row.key);
        rows.push_back(
            {0, "parameter", key, std::string(row.unit), std::string(row.meaning), 1, std::strtod(scene.value(key).c_str(), nullptr), key});
    }
    return rows;
}

}  // namespace

std::vector<FmuVariable> fmu_variables(Simulation& simulation, const FmuChoice& choice, bool arrays) {
    std::vector<FmuVariable> all{{0, "time", "time", "s", "simulated time", 1, 0.0, "time"}};
    for (auto& rows : {inputs(simulation, choice.inputs), outputs(simulation, choice.outputs, arrays), parameters(simulation.scene())})
        all.insert(all.end(), rows.begin(), rows.end());
    for (std::size_t number = 0; number < all.size(); ++number) all[number].reference = static_cast<std::uint32_t>(number);
    return all;
}

std::string variables_text(const std::vector<FmuVariable>& variables) {
    std::string text;
    for (const FmuVariable& row : variables)
        text += fmt::format("{} {} {} {} {}\n", row.reference, row.kind, row.width, row.source, row.element);
    return text;
}

}  // namespace cvtflow::tools
