#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <stdexcept>

#include "bench/lab/command/command.hpp"
#include "bench/lab/show.hpp"
#include "tasks/sizing/belt_drive.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tasks;
using namespace tools;

namespace {

struct BeltArguments {
    SceneArguments scene;
    OutputArguments output;
    std::vector<double> ratios, loads, growths{0.0};
    std::vector<std::string> without;
    double vibration = 0.0;
};

const std::map<std::string, bool BeltParts::*> parts_by_name{{"tilt", &BeltParts::tilting_sheaves},
                                                             {"yield", &BeltParts::yielding_pins},
                                                             {"stretch", &BeltParts::stretching_belt},
                                                             {"crown", &BeltParts::crowned_flank},
                                                             {"saturation", &BeltParts::saturation_speed}};

/// A row of the table. Its status is "ok", or why the theory has no solution there. @param load  share of 2 mu S_2 R_2/cos(beta)
/// @param arcs  gets the nodes of the arcs
Json row_of(const model::Parameters& p, const BeltPoint& point, double load, const BeltParts& parts, Json& arcs) {
    Json row =
        named("ratio,load,torque_Nm,growth_m_per_s,status,clamping_driving_N,thrust_ratio,tight_N,slack_N,slip,sliding_W,shift_per_s",
              {point.ratio, load, point.torque, point.growth, "ok", {}, {}, {}, {}, {}, {}, {}});
    row["torque_limit_Nm"] = belt_torque_limit(p, point);
    try {
        const BeltDrive drive = solve_belt(p, point, parts);
        row.update(named("clamping_driving_N,thrust_ratio,tight_N,slack_N,slip,sliding_W,shift_per_s",
                         {drive.arc[0].clamping, drive.thrust_ratio, drive.tight, drive.slack, drive.slip,
                          drive.arc[0].sliding_power + drive.arc[1].sliding_power, drive.shift + 0.0}));
        for (std::size_t k = 0; k < drive.arc.size(); ++k)
            for (const BeltNode& node : drive.arc[k].nodes)
                arcs.push_back(
                    named("ratio,load,pulley,angle,tension_N,axial_N_per_rad,inset_m,along_m_per_s,across_m_per_s",
                          {point.ratio, load, k + 1, node.angle, node.tension, node.axial, node.inset, node.along, node.across}));
    } catch (const std::domain_error& error) {
        row["status"] = error.what();
    }
    return row;
}

ExitStatus belt(const BeltArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const model::Parameters& p = loaded.scene.parameters;
    if (p.detail.pulleys == model::PulleyDetail::absent) throw UsageError(loaded.scene.name + " has no pulleys");
    if (p.tip.pressure_sensitivity != 0.0)
        throw UsageError("friction of the theory does not depend on pressure: set tip.pressure_sensitivity=0");
    BeltParts parts;
    parts.vibration = arguments.vibration;
    for (const std::string& name : arguments.without) parts.*parts_by_name.at(name) = false;
    Json results{{"points", Json::array()}, {"arcs", Json::array()}};
    const std::vector<double> ratios = arguments.ratios.empty() ? std::vector<double>{p.start.ratio} : arguments.ratios;
    for (const double ratio : ratios) {
        BeltPoint point{ratio, p.clamping.driven.at(0.0), p.load.torque.at(0.0), p.drive.speed.at(0.0)};
        const double limit = belt_torque_limit(p, point);
        for (const double load : arguments.loads.empty() ? std::vector<double>{point.torque / limit} : arguments.loads)
            for (const double growth : arguments.growths) {
                point.torque = load * limit;
                point.growth = growth;
                results["points"].push_back(row_of(p, point, load, parts, results["arcs"]));
            }
    }
    show("belt", std::move(results), arguments.output);
}

}  // namespace

Action declare_belt(CLI::App& app) {
    const auto arguments = std::make_shared<BeltArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("--ratios", arguments->ratios, "Ratios of radii, separated by commas (default: start.ratio)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(0.1, 10.0));
    app.add_option("--loads", arguments->loads, "Loads as shares of 2 mu S_2 R_2/cos(beta), separated by commas (default: load.torque)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(-2.0, 2.0));
    app.add_option("--growths", arguments->growths, "Rates of change of the driving radius [m/s], separated by commas (default: 0)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(-1.0, 1.0));
    app.add_option("--without", arguments->without, "Leave out: tilt, yield, stretch, crown, saturation, separated by commas")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::IsMember(parts_by_name));
    app.add_option("--vibration", arguments->vibration, "Standard deviation of the pins' velocity across the flank [m/s] (default: 0)")
        ->type_name("SPEED")
        ->check(CLI::Range(0.0, 10.0));
    declare_output(app, arguments->output);
    app.footer(
        "A continuous belt with Coulomb friction in two directions between sheaves that tilt (Carbone, Mangialardi and Mantriota 2005),\n"
        "with the scene's machine, driven clamping force, speed and load at t = 0. docs/validation.md has its equations and its results\n"
        "beside those of the chain. Files: belt.csv (a row per point), arcs.csv (forces and sliding along both arcs).");
    return [arguments] { return belt(*arguments); };
}

}  // namespace cvtflow::bench
