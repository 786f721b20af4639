#include "tasks/step/control/step_grid.hpp"

#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

constexpr double point = 1e-3;  // [s]

/// First point after 0 in any mode of drive, load, hydraulics and control. scene [with the table]
[[nodiscard]] double first_point_in_some_mode(Scene scene) {
    model::Parameters& p = scene.parameters;
    double first = 1.0;
    for (int mode = 0; mode < 36; ++mode) {
        p.drive.mode = mode % 2 == 0 ? model::DriveMode::torque : model::DriveMode::speed;
        p.load.mode = mode / 2 % 3 == 0 ? model::LoadMode::torque : mode / 2 % 3 == 1 ? model::LoadMode::speed : model::LoadMode::coupling;
        p.hydraulics.mode = static_cast<model::HydraulicMode>(mode / 6 % 3);
        p.control.enabled = mode / 18 == 1;
        first = std::min(first, next_input_point(p, model::HeldInputs{}, 0.0));
    }
    return first;
}

TEST(InputPoints, OfEveryTableOverTimeAreSeen) {
    int tables = 0;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.kind() != Kind::time_table) continue;
        if (parameter.section() == "vehicle" || parameter.section() == "cycle") continue;  // other tables follow from them
        ++tables;
        Scene scene = ready_tiny();
        ASSERT_EQ(first_point_in_some_mode(scene), 1.0) << "tiny has constant inputs";
        model::TimeTable& table = *std::get<model::TimeTable*>(parameter.member(scene));
        table.time = {0.0, point};
        table.value = {1.0, 2.0};
        EXPECT_EQ(first_point_in_some_mode(scene), point) << parameter.key;
    }
    EXPECT_GE(tables, 10);
}

}  // namespace
}  // namespace cvtflow::tasks
