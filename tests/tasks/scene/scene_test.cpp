#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/parameters/chain_layout.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/csv_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {

namespace {

const std::filesystem::path scenes = std::filesystem::path(CVTFLOW_SOURCE_DIR) / "scenes";

TEST(Scene, EmptyTextIsTheDefaultScene) {
    const Scene scene = parse_scene("", "folder/empty.toml");
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
    EXPECT_EQ(scene.name, "empty");
    EXPECT_EQ(scene.state_file, "");
}

TEST(Scene, KeepsItsTextAndPath) {
    const std::string text = "[scene]\nname = \"mine\" # a comment\n";
    const Scene scene = parse_scene(text, "folder/scene.toml");
    EXPECT_EQ(scene.name, "mine");
    EXPECT_EQ(scene.text, text);
    EXPECT_EQ(scene.path, "folder/scene.toml");
}

TEST(Scene, BaselineIsTheDefaultScene) {
    const Scene scene = read_scene(scenes / "baseline.toml");
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{}) << "also with the method that a scene without one takes";
    EXPECT_TRUE(scene.run.step.automatic());
}

TEST(Scene, EveryReadySceneIsGoodNamedAsItsFileAndDescribed) {
    int count = 0;
    for (const auto& file : std::filesystem::directory_iterator(scenes)) {
        if (file.path().extension() != ".toml") continue;
        const Scene scene = read_scene(file.path());
        EXPECT_EQ(scene.name, file.path().stem().string());
        EXPECT_FALSE(scene.description.empty()) << scene.name;
        ++count;
    }
    EXPECT_GE(count, 8);
}

TEST(Scene, EachKeyRoundTrips) {
    const Scene defaults;
    for (const Parameter& parameter : parameter_table()) {
        const auto text = fmt::format("[{}]\n{} = {}", parameter.section(), parameter.name(), value_text(parameter, defaults));
        const Scene scene = parse_scene(text, "scene.toml");
        EXPECT_EQ(value_text(parameter, scene), parameter.key == "scene.name" ? "\"scene\"" : value_text(parameter, defaults)) << text;
        EXPECT_EQ(scene.parameters, defaults.parameters) << text;
        EXPECT_EQ(scene.run, defaults.run) << text;
    }
}

TEST(Scene, FileThatIsNotThereIsAnError) {
    EXPECT_EQ(message_of([] { return read_scene("/nowhere/at/all.toml"); }),
              "/nowhere/at/all.toml: cannot be read: No such file or directory");
    EXPECT_EQ(message_of([] { return read_scene(scenes); }), scenes.string() + ": cannot be read: a folder, not a file");
}

TEST(Scene, StateIsRelativeToTheSceneFile) {
    const tests::TemporaryFolder folder("scene_state");
    std::filesystem::create_directories(folder / "states");
    std::ofstream(folder / "states/settled.h5") << "state";
    std::ofstream(folder / "scene.toml") << "[start]\nstate = \"states/settled.h5\"\n";
    EXPECT_EQ(read_scene(folder / "scene.toml").state_file, (folder / "states/settled.h5").string());
}

TEST(SetValue, TakesValuesAsInTomlAndWithoutQuotes) {
    Scene scene;
    set_value(scene, "half.length=40 mm");
    set_value(scene, "chain.damping_ratio=0.05");
    set_value(scene, "detail.plates=lumped");
    set_value(scene, "record.ledger=true");
    set_value(scene, "load.torque=[[0, 0], [\"10 ms\", \"150 N*m\"]]");
    set_value(scene, "run.method=\"heun\"");
    set_value(scene, "scene.name=84");
    EXPECT_EQ(scene.parameters.half.length, 40e-3);
    EXPECT_EQ(scene.parameters.chain.damping_ratio, 0.05);
    EXPECT_EQ(scene.parameters.detail.plates, model::PlateDetail::lumped);
    EXPECT_TRUE(scene.parameters.ledger);
    EXPECT_EQ(scene.parameters.load.torque, model::TimeTable({0.0, 0.01}, {0.0, 150.0}));
    EXPECT_EQ(scene.run.method, "heun");
    EXPECT_EQ(scene.name, "84");
}

TEST(SetValue, EveryKeyTakesItsOwnDefault) {
    Scene scene;
    for (const Parameter& parameter : parameter_table())
        set_value(scene, fmt::format("{}={}", parameter.key, value_text(parameter, Scene{})));
    EXPECT_EQ(scene.parameters, model::Parameters{});
    EXPECT_EQ(scene.run, RunSettings{});
}

TEST(SetValue, ErrorsShowTheSetting) {
    for (const auto& [setting, message] : {
             std::pair{"chain.pitch=8.12", "chain.pitch: 8.12 m is outside [1e-3, 5e-2] m (did you mean \"8.12 mm\"?)"},
             {"chain.pitch=8.12 kg", "chain.pitch: 8.12 kg is a mass, expected a length (m)"},
             {"chain.pich=8.12 mm", "chain.pich: unknown key (did you mean \"chain.pitch\"?)"},
             {"chain.pitch", "not of the form key=value"},
             {"chain.pins=all", "chain.pins: \"all\" is not an integer"},
             {"chain.pitch=", "chain.pitch: \"\" does not begin with a number"},
             {"half.length=8 mm\npins = 2", ""},
             {"chain.pitch=[8e-3", "chain.pitch: not valid TOML: Error whil"},
             {"start.state=nowhere.h5", "start.state: no file \"nowhere.h5\""},
         })
        EXPECT_THAT(message_of_settings({}, {setting}), testing::StartsWith(fmt::format("--set {}: {}", setting, message)));
    Scene scene;
    EXPECT_THROW(set_value(scene, "chain.pitch=8.12"), SceneError);
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(SetValue, ChecksWhatValuesMustSatisfyTogether) {
    Scene scene;
    EXPECT_EQ(message_of_settings(scene, {"chain.pins=40"}),
              "--set chain.pins=40: chain.pins: 40 pins make a chain of 324.8 mm, too short for pulley.centre_distance = 170 mm");
    EXPECT_EQ(scene.parameters.chain.pins, 84);
}

TEST(SetValues, ThatAreConsistentOnlyTogetherAreTakenTogether) {
    Scene scene;
    const std::vector<std::string> settings{"detail.pulleys=absent", "start.layout=ring"};
    EXPECT_NE(message_of([&] { set_value(scene, settings[0]); }), "");
    set_values(scene, settings);
    EXPECT_EQ(scene.parameters.start.layout, model::StartLayout::ring);
}

TEST(SetValues, ReportAllProblemsInTheirOrder) {
    Scene scene;
    const std::vector<std::string> settings{"tip.angle=11", "half.length=40 mm", "chain.pins=two"};
    EXPECT_EQ(message_of([&] { set_values(scene, settings); }),
              "--set tip.angle=11: tip.angle: 11 rad is outside [1e-2, 0.8] rad (did you mean \"11 deg\"?)\n"
              "--set chain.pins=two: chain.pins: \"two\" is not an integer");
    EXPECT_EQ(scene.parameters, model::Parameters{});
}

TEST(SetValues, TheLastOfTwoSettingsOfAKeyCounts) {
    Scene scene;
    set_values(scene, std::vector<std::string>{"half.length=40 mm", "half.length=50 mm"});
    EXPECT_EQ(scene.parameters.half.length, 50e-3);
}

TEST(KeptState, IsReadOnceForAllCopiesAndAnewWhereTheFileIsAnotherOne) {
    const tests::TemporaryFile file("kept");
    const auto write = [&](double value) {
        engine::SavedState saved;
        saved.state = {value};
        engine::write_state(file.path(), saved);
    };
    const KeptState kept;
    write(1.0);
    const auto first = kept.read(file.path());
    EXPECT_EQ(first->state, std::vector<double>{1.0});
    const KeptState copy = kept;
    EXPECT_EQ(copy.read(file.path()), first);  // the same object
    std::filesystem::remove(file.path());
    EXPECT_EQ(copy.read(file.path()), first);  // and it outlives its file
    write(2.0);
    EXPECT_EQ(kept.read(file.path())->state, std::vector<double>{2.0});
    EXPECT_THROW((void)kept.read(file.path() + ".absent"), engine::RecordError);
}

TEST(DetailPresets, SetTheirDialsAndKeepTheOthers) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene scene;
        scene.parameters.detail.friction = model::FrictionLaw::smoothed;
        scene.parameters.detail.smoothing = 0.25;
        scene.parameters.detail.stick_slip = true;
        apply_detail(scene, preset.name);
        const model::Detail expected{.pins = preset.pins,
                                     .plates = preset.plates,
                                     .joint_points = preset.joint_points,
                                     .pulleys = preset.pulleys,
                                     .friction = model::FrictionLaw::smoothed,
                                     .smoothing = 0.25,
                                     .stick_slip = true};
        EXPECT_EQ(scene.parameters.detail, expected) << preset.name;
        EXPECT_FALSE(preset.meaning.empty());
        scene.parameters.detail.pulleys = model::PulleyDetail::absent;
        apply_detail(scene, preset.name);
        EXPECT_EQ(scene.parameters.detail.pulleys, model::PulleyDetail::absent) << preset.name;
    }
}

TEST(DetailPresets, SetNothingButTheDialsAndNoneOfThemInVain) {
    std::set<std::string_view> changed;
    for (const DetailPreset& preset : detail_presets()) {
        Scene before;
        before.parameters.detail = {.pins = model::PinDetail::rigid,
                                    .joint_points = 5,
                                    .pulleys = model::PulleyDetail::rigid,
                                    .friction = model::FrictionLaw::smoothed};
        Scene after = before;
        apply_detail(after, preset.name);
        for (const Parameter& parameter : parameter_table()) {
            if (value_text(parameter, before) != value_text(parameter, after)) changed.insert(parameter.key);
        }
    }
    const auto dials = dial_keys();
    std::set<std::string_view> expected(dials.begin(), dials.end());
    expected.insert(level_key);  // whose value follows from them
    EXPECT_EQ(changed, expected);
}

TEST(DetailPresets, FineIsTheDefault) {
    Scene scene;
    apply_detail(scene, "full");
    EXPECT_NE(scene.parameters.detail, model::Detail{});
    apply_detail(scene, "fine");
    EXPECT_EQ(scene.parameters.detail, model::Detail{});
}

TEST(DetailPresets, WithStatesThatDoNotFitDifferInAStateKey) {
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

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.at(values.size() / 2);
}

/// Errors of a level at every operating point, against the reference there; of several columns the largest [1].
std::vector<double> errors_of(std::string_view level, const std::vector<std::string>& columns) {
    const auto rows = cvtflow::test::committed_rows("bench/results/detail_ladder.csv");
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
    std::map<std::string, double> fine, level_seconds;
    for (const auto& row : cvtflow::test::committed_rows("bench/results/detail_ladder.csv")) {
        if (row.at("share") != "1") continue;
        if (row.at("detail") == "fine") fine[row.at("point")] = std::stod(row.at("seconds"));
        if (row.at("detail") == level) level_seconds[row.at("point")] = std::stod(row.at("seconds"));
    }
    std::vector<double> costs;
    for (const auto& [point, seconds] : level_seconds) costs.push_back(seconds / fine.at(point));
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
    EXPECT_EQ(message_of([&] { apply_detail(scene, "fein"); }), "detail fein: not one of rigid, fine, full (did you mean \"fine\"?)");
}

TEST(DetailPresets, LevelOfAFileSetsItsKeysAndKeysBesideItTakePrecedenceWhereverTheyAre) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene expected;
        apply_detail(expected, preset.name);
        const Scene scene = parse_scene(fmt::format("[detail]\nlevel = \"{}\"\n", preset.name), "scene.toml");
        EXPECT_EQ(scene.parameters, expected.parameters) << preset.name;
        EXPECT_EQ(level_of(scene), preset.name);
        EXPECT_EQ(value_text(*find_parameter("detail.level"), scene), fmt::format("\"{}\"", preset.name));
    }
    const Scene above = parse_scene("[detail]\njoint_points = 2\nlevel = \"full\"\n", "scene.toml");
    const Scene below = parse_scene("[detail]\nlevel = \"full\"\njoint_points = 2\n", "scene.toml");
    EXPECT_EQ(above.parameters, below.parameters);
    EXPECT_EQ(above.parameters.detail.plates, model::PlateDetail::each);
    EXPECT_EQ(above.parameters.detail.joint_points, 2);
    EXPECT_EQ(value_text(*find_parameter("detail.level"), above), "\"given\"");
    EXPECT_EQ(parse_scene(write_scene(above), "scene.toml").parameters, above.parameters);
}

TEST(DetailPresets, LevelIsASettingAndGivesWayToWhatFollows) {
    Scene scene = parse_scene("[detail]\nlevel = \"rigid\"\n", "scene.toml");
    set_values(scene, std::vector<std::string>{"detail.level=full", "detail.joint_points=2"});
    EXPECT_EQ(scene.parameters.detail.pins, model::PinDetail::halves);
    EXPECT_EQ(scene.parameters.detail.joint_points, 2);
    set_value(scene, "detail.level=given");
    EXPECT_EQ(scene.parameters.detail.joint_points, 2);
}

/// Versions up to 0.3 had a level "medium" and the orders 0 to 2 of pin halves.
TEST(DetailPresets, LevelAndOrderOfEarlierVersionsAreErrorsThatNameWhatToUse) {
    const std::string level = "not one of given, rigid, fine, full (use \"fine\", or \"rigid\" at lower cost)";
    const std::string order = "unknown key (pin halves always have order 3: omit the key, or use detail.level = \"fine\" or \"rigid\")";
    EXPECT_EQ(message_of([] { return parse_scene("[detail]\nlevel = \"medium\"\n", "s.toml"); }),
              "s.toml:2:9: detail.level: \"medium\" is " + level);
    EXPECT_EQ(message_of([] { return parse_scene("[detail]\norder = 3\n", "s.toml"); }), "s.toml:2:1: detail.order: " + order);
    Scene scene;
    EXPECT_EQ(message_of_settings(scene, {"detail.level=medium"}), "--set detail.level=medium: detail.level: \"medium\" is " + level);
    EXPECT_THAT(message_of([] { return parse_scene("[detail]\nmass_scaling = 3\n", "s.toml"); }), testing::HasSubstr("(gone since 1.0: "));
    EXPECT_THAT(message_of_settings(scene, {"record.channels=[\"balance/suspicion\"]"}), testing::HasSubstr("(named balance/error_ratio "));
    EXPECT_EQ(message_of_settings(scene, {"detail.order=1"}), "--set detail.order=1: detail.order: " + order);
    EXPECT_EQ(message_of([&] { apply_detail(scene, "medium"); }),
              "detail medium: not one of rigid, fine, full (use \"fine\", or \"rigid\" at lower cost)");
    EXPECT_EQ(message_of([] { return explain("detail.order"); }), "detail.order: " + order);
}

/// Their records contain the order of their pins.
TEST(DetailPresets, RecordsOfEarlierVersionsAreReadIfTheirPinsAreThoseOfToday) {
    const auto recorded = [](const char* detail) { return parse_scene(std::string("[detail]\n") + detail, "r.h5", StartState::recorded); };
    EXPECT_EQ(recorded("order = 3\nplates = \"lumped\"\n").parameters.detail.plates, model::PlateDetail::lumped);
    EXPECT_EQ(recorded("pins = \"rigid\"\norder = 2\nplates = \"lumped\"\n").parameters.detail.pins, model::PinDetail::rigid);
    for (const char* other : {"order = 1\n", "order = 2\n", "order = \"3\"\n", "pins = \"rigid\"\norder = 3\nplates = \"lumped\"\n"})
        EXPECT_THAT(message_of([&] { return recorded(other); }), testing::HasSubstr("detail.order: unknown key (pin halves always"))
            << other;
}

TEST(DetailPresets, ConflictsWithALevelAreReported) {
    Scene palmgren = parse_scene("[joint]\nlaw = \"palmgren\"\n", "s.toml");
    EXPECT_EQ(message_of([&] { set_value(palmgren, "detail.level=rigid"); }),
              "--set detail.level=rigid: joint.law: detail.pins = \"rigid\" has joints of law \"linear\"");
    EXPECT_EQ(message_of([] { return parse_scene("[detail]\nlevel = \"rigid\"\nplates = \"each\"\n", "s.toml"); }),
              "s.toml:3:10: detail.plates: detail.pins = \"rigid\" has \"lumped\" plates");
    EXPECT_EQ(message_of([] { return parse_scene("[detail]\nlevel = \"rigid\"\n[run]\nsegments = 4\n", "s.toml"); }),
              "s.toml:4:12: run.segments: detail.pins = \"rigid\" is one segment, not 4");
    EXPECT_EQ(message_of([] { return parse_scene("[detail]\nlevel = \"rigdi\"\n", "s.toml"); }),
              "s.toml:2:9: detail.level: \"rigdi\" is not one of given, rigid, fine, full (did you mean \"rigid\"?)");
}

}  // namespace

}  // namespace cvtflow::tasks
