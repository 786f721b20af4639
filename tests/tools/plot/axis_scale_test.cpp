#include "tools/program/plot/axis_scale.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace cvtflow::tools {
namespace {

using testing::ElementsAre;

std::vector<std::string> labels(const AxisScale& scale, int count) {
    std::vector<std::string> texts;
    for (const Tick& tick : scale.ticks(count)) {
        if (!tick.label.empty()) texts.push_back(tick.label);
    }
    return texts;
}

const Axis logarithmic{"h", Scale::logarithmic, 1.0, {}, {}};

TEST(AxisScale, PlacesAndValuesAreInverse) {
    for (const Scale kind : {Scale::linear, Scale::logarithmic, Scale::symlog}) {
        const AxisScale scale({"", kind, 10.0, 1.0, 1e6}, {});
        for (const double value : {1.0, 3.0, 10.0, 77.0, 1e6}) EXPECT_NEAR(scale.value(scale.place(value)) / value, 1.0, 1e-9);
        EXPECT_EQ(scale.place(1.0), 0.0);
        EXPECT_EQ(scale.place(1e6), 1.0);
    }
}

TEST(AxisScale, DecadesAreEquallyLongOnALogarithmicAxis) {
    const AxisScale scale({"", Scale::logarithmic, 1.0, 1e-8, 1e-4}, {});
    EXPECT_DOUBLE_EQ(scale.place(1e-7), 0.25);
    EXPECT_DOUBLE_EQ(scale.place(1e-6), 0.5);
}

TEST(AxisScale, SymlogIsOddAndContinuesSmoothlyWhereItsLinearPartEnds) {
    const AxisScale scale({"", Scale::symlog, 1e3, -1e6, 1e6}, {});
    EXPECT_DOUBLE_EQ(scale.place(0.0), 0.5);
    for (const double value : {1.0, 999.0, 1001.0, 1e5}) EXPECT_NEAR(scale.place(value) - 0.5, 0.5 - scale.place(-value), 1e-15);
    EXPECT_NEAR(scale.place(1e3 + 1e-9), scale.place(1e3 - 1e-9), 1e-11);
    // 1 of the linear part and 3 decades on either side.
    EXPECT_DOUBLE_EQ(scale.place(1e3) - 0.5, 0.5 / 4.0);
}

TEST(AxisScale, EndsEncloseTheValuesWithAMargin) {
    const AxisScale scale({"", Scale::linear, 1.0, {}, {}}, {2.0, 12.0, NAN, INFINITY});
    EXPECT_NEAR(scale.value(0.0), 1.6, 1e-12);
    EXPECT_NEAR(scale.value(1.0), 12.4, 1e-12);
}

TEST(AxisScale, WithoutValuesOrWithOneStillHasALength) {
    EXPECT_LT(AxisScale({}, {}).place(0.0), AxisScale({}, {}).place(1.0));
    const AxisScale one(logarithmic, {1e-3});
    EXPECT_GT(one.place(1e-3), 0.0);
    EXPECT_LT(one.place(1e-3), 1.0);
    const AxisScale zero({}, {0.0});
    EXPECT_DOUBLE_EQ(zero.place(0.0), 0.5);
}

TEST(AxisScale, LogarithmicLeavesOutWhatIsNotPositive) {
    const AxisScale scale(logarithmic, {-1.0, 0.0, 1e-2, 1.0});
    EXPECT_FALSE(scale.shows(0.0));
    EXPECT_FALSE(scale.shows(-1.0));
    EXPECT_GT(scale.value(0.0), 5e-3);
}

TEST(AxisScale, TicksAreRoundNumbersBetweenTheEnds) {
    EXPECT_THAT(labels(AxisScale({"", Scale::linear, 1.0, 0.0, 1.0}, {}), 5), ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
    EXPECT_THAT(labels(AxisScale({"", Scale::linear, 1.0, -6e7, 1e6}, {}), 4), ElementsAre("−6·10⁷", "−4·10⁷", "−2·10⁷", "0"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 1e-8, 1e-2}, {}), 3), ElementsAre("10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 1e-7, 1e-6}, {}), 9), ElementsAre("10⁻⁷", "2·10⁻⁷", "5·10⁻⁷", "10⁻⁶"));
    EXPECT_THAT(labels(AxisScale({"", Scale::symlog, 10.0, -1e3, 100.0}, {}), 9), ElementsAre("−10³", "−10²", "−10", "0", "10", "10²"));
}

TEST(AxisScale, WithinADecadeTicksOfALogarithmicAxisAreNiceRatios) {
    const Axis ratio{"ratio", Scale::logarithmic, 1.0, {}, {}};
    EXPECT_THAT(labels(AxisScale(ratio, {0.417, 2.4}), 6), ElementsAre("0.5", "0.75", "1", "1.5", "2"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 2e-7, 1.4e-6}, {}), 6),
                ElementsAre("2·10⁻⁷", "3·10⁻⁷", "5·10⁻⁷", "7.5·10⁻⁷", "10⁻⁶"));
    EXPECT_THAT(labels(AxisScale({"", Scale::logarithmic, 1.0, 0.9, 1.1}, {}), 4), ElementsAre("0.9", "0.95", "1", "1.05", "1.1"))
        << "one of them would be too few";
}

TEST(AxisScale, TicksAscendAndAreSeenByTheAxis) {
    for (const Scale kind : {Scale::linear, Scale::logarithmic, Scale::symlog}) {
        const AxisScale scale({"", kind, 5.0, {}, {}}, {0.3, 4e4});
        double last = -INFINITY;
        for (const Tick& tick : scale.ticks(6)) {
            EXPECT_GT(tick.value, last);
            EXPECT_GE(scale.place(tick.value), -1e-9);
            EXPECT_LE(scale.place(tick.value), 1.0 + 1e-9);
            last = tick.value;
        }
        EXPECT_TRUE(std::isfinite(last));
    }
}

TEST(AxisScale, LabelsAreAsShortAsTheStepAllows) {
    EXPECT_EQ(tick_label(0.25, 0.05), "0.25");
    EXPECT_EQ(tick_label(1200.0, 200.0), "1200");
    EXPECT_EQ(tick_label(1.5e6, 5e5), "1.5·10⁶");
    EXPECT_EQ(tick_label(-2e-8, 1e-8), "−2·10⁻⁸");
    EXPECT_EQ(tick_label(1e-25, 1.0), "0");
    EXPECT_EQ(power_of_ten(0), "1");
    EXPECT_EQ(power_of_ten(12, true), "−10¹²");
}

TEST(AxisScale, WithoutLengthIsRefused) {
    EXPECT_THROW(AxisScale({"x", Scale::linear, 1.0, 2.0, 2.0}, {}), std::invalid_argument);
    EXPECT_THROW(AxisScale({"x", Scale::symlog, 0.0, {}, {}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::tools
