#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/parameters/chain_layout.hpp"
#include "tasks/scene/csv/csv_text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

TEST(DetailPresets, SetTheirDialsAndKeepTheOthers) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene scene;
        scene.parameters.detail.friction = model::FrictionLaw::smoothed;
        scene.parameters.detail.smoothing = 0.25;
        scene.parameters.detail.stick_slip = true;
        scene.parameters.detail.mass_scaling = 3.0;
        apply_detail(scene, preset.name);
        const model::Detail expected{.pins = preset.pins,
                                     .order = preset.order,
                                     .plates = preset.plates,
                                     .joint_points = preset.joint_points,
                                     .mass_scaling = preset.mass_scaling,
                                     .pulleys = preset.pulleys,
                                     .friction = model::FrictionLaw::smoothed,
                                     .smoothing = 0.25,
                                     .stick_slip = true};
        EXPECT_EQ(scene.parameters.detail, expected) << preset.name;
        EXPECT_FALSE(preset.meaning.empty());
    }
}

TEST(DetailPresets, SetNothingButTheDialsAndNoneOfThemInVain) {
    std::set<std::string_view> changed;
    for (const DetailPreset& preset : detail_presets()) {
        Scene before;
        before.parameters.detail = {.pins = model::PinDetail::rigid,
                                    .order = 0,
                                    .joint_points = 5,
                                    .mass_scaling = 3.0,
                                    .pulleys = model::PulleyDetail::rigid,
                                    .friction = model::FrictionLaw::smoothed};
        Scene after = before;
        apply_detail(after, preset.name);
        for (const Parameter& parameter : parameter_table()) {
            if (value_text(parameter, before) != value_text(parameter, after)) changed.insert(parameter.key);
        }
    }
    const auto dials = dial_keys();
    EXPECT_EQ(changed, std::set<std::string_view>(dials.begin(), dials.end()));
}

TEST(DetailPresets, LeaveAbsentPulleysAbsent) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene scene;
        scene.parameters.detail.pulleys = model::PulleyDetail::absent;
        apply_detail(scene, preset.name);
        EXPECT_EQ(scene.parameters.detail.pulleys, model::PulleyDetail::absent);
        EXPECT_EQ(scene.parameters.detail.order, preset.order);
    }
}

TEST(DetailPresets, FineIsTheDefault) {
    Scene scene;
    apply_detail(scene, "medium");
    EXPECT_NE(scene.parameters.detail, model::Detail{});
    apply_detail(scene, "fine");
    EXPECT_EQ(scene.parameters.detail, model::Detail{});
}

TEST(DetailPresets, WithStatesThatDoNotFitDifferInAKeyThatSaysSo) {
    const auto described = [](const Scene& scene) {
        std::string text;
        for (const std::string_view key : state_keys()) text += value_text(*find_parameter(key), scene) + " ";
        return text;
    };
    for (const DetailPreset& one : detail_presets()) {
        for (const DetailPreset& other : detail_presets()) {
            Scene first, second;
            apply_detail(first, one.name);
            apply_detail(second, other.name);
            const bool fits = model::layout_of(first.parameters) == model::layout_of(second.parameters);
            EXPECT_TRUE(fits || described(first) != described(second)) << one.name << ", " << other.name;
        }
    }
}

/// A committed measurement: cells of its columns, by the columns' names.
std::vector<std::map<std::string, std::string>> measured(const std::string& name) {
    std::ifstream file(std::string(CVTFLOW_SOURCE_DIR) + "/bench/results/" + name);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    const auto lines = csv_lines(text);
    std::vector<std::map<std::string, std::string>> rows;
    for (std::size_t k = 1; k < lines.size(); ++k) {
        if (lines[k].size() != lines[0].size()) continue;
        rows.emplace_back();
        for (std::size_t column = 0; column < lines[0].size(); ++column) rows.back()[lines[0][column]] = lines[k][column];
    }
    return rows;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.at(values.size() / 2);
}

/// Errors of a level at every operating point, against the reference there; of several columns the largest [1].
std::vector<double> errors_of(std::string_view level, const std::vector<std::string>& columns) {
    const auto rows = measured("detail_ladder.csv");
    std::vector<double> errors;
    for (const auto& row : rows) {
        if (row.at("detail") != level || row.at("share") != "1") continue;
        const auto reference = std::find_if(
            rows.begin(), rows.end(), [&](const auto& other) { return other.at("point") == row.at("point") && other.at("share") != "1"; });
        EXPECT_EQ(row.at("status"), "finished") << level << " at " << row.at("point");
        double most = 0.0;
        for (const std::string& column : columns)
            most = std::max(most, std::abs(std::stod(row.at(column)) / std::stod(reference->at(column)) - 1.0));
        errors.push_back(most);
    }
    return errors;
}

/// Stated to two digits, from bench/results/detail_ladder.csv: seven operating points.
TEST(DetailPresets, SayTheErrorsThatWereMeasured) {
    for (const DetailPreset& preset : detail_presets()) {
        const auto tensions = errors_of(preset.name, {"tight_N", "slack_N"}), slip = errors_of(preset.name, {"slip"});
        ASSERT_EQ(tensions.size(), 7u) << preset.name;
        EXPECT_NEAR(preset.tension_error / median(tensions), 1.0, 0.1) << preset.name << " " << median(tensions);
        EXPECT_NEAR(preset.slip_error / median(slip), 1.0, 0.1) << preset.name << " " << median(slip);
    }
}

/// Processor time per simulated second over that of "fine", at every operating point: all levels took turns there.
std::vector<double> costs_of(std::string_view level) {
    std::map<std::string, double> fine, own;
    for (const auto& row : measured("detail_ladder.csv")) {
        if (row.at("share") != "1") continue;
        if (row.at("detail") == "fine") fine[row.at("point")] = std::stod(row.at("seconds"));
        if (row.at("detail") == level) own[row.at("point")] = std::stod(row.at("seconds"));
    }
    std::vector<double> costs;
    for (const auto& [point, seconds] : own) costs.push_back(seconds / fine.at(point));
    return costs;
}

/// The machine was busy: to a tenth.
TEST(DetailPresets, SayTheCostsThatWereMeasuredAndBecomeDearerUpTheLadder) {
    double below = 0.0;
    for (const DetailPreset& preset : detail_presets()) {
        const std::vector<double> costs = costs_of(preset.name);
        ASSERT_EQ(costs.size(), 7u) << preset.name;
        EXPECT_NEAR(preset.cost / median(costs), 1.0, 0.1) << preset.name;
        EXPECT_GT(preset.cost, below) << preset.name;
        below = preset.cost;
    }
}

TEST(DetailPresets, UnknownNameIsAnErrorWithASuggestion) {
    Scene scene;
    try {
        apply_detail(scene, "meduim");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "detail meduim: not one of rigid, medium, fine, full (did you mean \"medium\"?)");
    }
}

TEST(DetailPresets, OneThatIsGoneNamesWhatTakesItsPlace) {
    Scene scene;
    try {
        apply_detail(scene, "coarse");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(),
                     "detail coarse: not one of rigid, medium, fine, full; whole pins that roll by constraint are gone: \"rigid\" is more "
                     "accurate and takes a twelfth of their time");
    }
}

}  // namespace
}  // namespace cvtflow::tasks
