#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

using nlohmann::json;

namespace {

struct DrawArguments {
    std::string input, output;
};

const std::map<std::string, Scale> scales{{"linear", Scale::linear}, {"log", Scale::logarithmic}, {"symlog", Scale::symlog}};
const std::map<std::string, Mark> marks{{"none", Mark::none},         {"dot", Mark::dot},       {"small_dot", Mark::small_dot},
                                        {"ring", Mark::ring},         {"square", Mark::square}, {"diamond", Mark::diamond},
                                        {"triangle", Mark::triangle}, {"cross", Mark::cross}};
const std::map<std::string, Line> lines{{"none", Line::none}, {"solid", Line::solid}, {"dashed", Line::dashed}, {"dotted", Line::dotted}};

template <class Value>
Value chosen(const std::map<std::string, Value>& names, const json& object, const std::string& key, const std::string& otherwise) {
    const std::string name = object.value(key, otherwise);
    const auto found = names.find(name);
    if (found == names.end()) throw UsageError(fmt::format("{}: no {} of a picture", name, key));
    return found->second;
}

tools::Axis axis_of(const json& object) {
    tools::Axis axis{
        object.at("label").get<std::string>(), chosen(scales, object, "scale", "linear"), object.value("linear_up_to", 1.0), {}, {}};
    if (object.contains("from")) axis.from = object.at("from").get<double>();
    if (object.contains("to")) axis.to = object.at("to").get<double>();
    return axis;
}

Plot plot_of(const json& object) {
    Plot plot;
    plot.title = object.at("title").get<std::string>();
    plot.subtitle = object.value("subtitle", "");
    plot.x = axis_of(object.at("x"));
    plot.y = axis_of(object.at("y"));
    plot.height = object.value("height", plot.height);
    for (const json& each : object.at("series")) {
        Series series{
            each.value("name", ""),  {}, chosen(marks, each, "mark", "dot"), chosen(lines, each, "line", "none"), each.value("colour", ""),
            each.value("width", 1.6)};
        for (const json& point : each.at("points")) series.points.push_back({point.at(0).get<double>(), point.at(1).get<double>()});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

ExitStatus draw(const DrawArguments& arguments) {
    std::ifstream input(arguments.input);
    std::vector<Plot> plots;
    try {
        const json parsed = json::parse(input);
        for (const json& each : parsed) plots.push_back(plot_of(each));
    } catch (const json::exception& error) {
        throw UsageError(fmt::format("{}: {}", arguments.input, error.what()));
    }
    std::ofstream output(arguments.output, std::ios::binary);
    output << svg(plots);
    output.close();
    if (!output) throw std::runtime_error(arguments.output + ": cannot write");
    return ExitStatus::finished;
}

}  // namespace

Action declare_draw(CLI::App& app) {
    const auto arguments = std::make_shared<DrawArguments>();
    app.add_option("FILE", arguments->input, "Pictures as JSON")->required()->check(CLI::ExistingFile)->type_name("");
    app.add_option("-o,--output", arguments->output, "SVG to write, the pictures below one another")->required()->type_name("FILE");
    app.footer(
        "A list of pictures: [{\"title\": T, \"subtitle\": T, \"x\": AXIS, \"y\": AXIS, \"series\": [{\"name\": T, \"points\": [[x, y], "
        "…],\n"
        "\"mark\": none|dot|small_dot|ring|square|diamond|triangle|cross, \"line\": none|solid|dashed|dotted, \"colour\": T}, …]}, …]\n"
        "AXIS: {\"label\": T, \"scale\": linear|log|symlog, \"from\": x, \"to\": x}");
    return [arguments] { return draw(*arguments); };
}

}  // namespace cvtflow::bench
