#include "tasks/method/friction/kick_system.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cvtflow::tasks {
namespace {

class SegmentColumnsTest : public testing::TestWithParam<std::vector<int>> {
protected:
    static constexpr int rows = 5;
    [[nodiscard]] static double number(int row, int link) { return 1000.0 * row + link + 1; }

    SegmentColumnsTest() { columns_.lay_out(Partition::at(GetParam())); }
    [[nodiscard]] int links() const { return GetParam().back(); }

    SegmentColumns columns_;
};

INSTANTIATE_TEST_SUITE_P(Partitions, SegmentColumnsTest,
                         testing::Values(std::vector{0, 84}, std::vector{0, 40, 84}, std::vector{0, 1, 2, 3},
                                         std::vector{0, 1, 2, 3, 4, 5, 6, 7}, std::vector{0, 7, 9, 10, 30}),
                         [](const auto& info) {
                             std::string name = "cut";
                             for (const int cut : info.param) name += "_" + std::to_string(cut);
                             return name;
                         });

TEST_P(SegmentColumnsTest, GhostColumnsRepeatTheLinksBesideASegment) {
    std::vector<model::ColumnsOf<double>> fields;
    SegmentEdges<double> edges(rows);
    edges.make_room(columns_.segments());
    for (int s = 0; s < columns_.segments(); ++s) {
        model::ColumnsOf<double>& field = fields.emplace_back(rows, columns_.count(s));
        for (int link = columns_.segment(s).first; link < columns_.segment(s).last; ++link) {
            for (int row = 0; row < rows; ++row) *field.at(row, link + columns_.shift(s)) = number(row, link);
        }
        edges.give(columns_, field, s);
    }
    for (int s = 0; s < columns_.segments(); ++s) {
        model::ColumnsOf<double>& field = fields[static_cast<std::size_t>(s)];
        edges.take(columns_, field, s);
        const Segment& own = columns_.segment(s);
        for (int link = own.first - 1; link <= own.last; ++link) {
            for (int row = 0; row < rows; ++row)
                EXPECT_EQ(*field.at(row, link + columns_.shift(s)), number(row, (link + 10 * links()) % links())) << "segment " << s;
        }
    }
}

TEST(SegmentColumns, OfOneSegmentAreLinksSideBySide) {
    SegmentColumns columns;
    columns.lay_out(Partition::equal(84, 1));
    EXPECT_EQ(columns.shift(0), 1);
    EXPECT_EQ(columns.count(0), 86);
}

}  // namespace
}  // namespace cvtflow::tasks
