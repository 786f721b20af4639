#include "tasks/method/friction/segment_columns.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cvtflow::tasks {
namespace {

struct Cut {
    std::vector<int> cuts;
    int halo;
};

class SegmentColumnsTest : public testing::TestWithParam<Cut> {
protected:
    static constexpr int rows = 5;
    [[nodiscard]] static double number(int row, int link) { return 1000.0 * row + link + 1; }

    SegmentColumnsTest() { columns_.lay_out(Partition::at(GetParam().cuts)); }
    [[nodiscard]] int links() const { return GetParam().cuts.back(); }

    SegmentColumns columns_{GetParam().halo};
};

INSTANTIATE_TEST_SUITE_P(Partitions, SegmentColumnsTest,
                         testing::Values(Cut{{0, 84}, 1}, Cut{{0, 40, 84}, 1}, Cut{{0, 1, 2, 3}, 1}, Cut{{0, 42, 84}, 3},
                                         Cut{{0, 1, 2, 3, 4, 5, 6, 7}, 3}, Cut{{0, 7, 9, 10, 30}, 3}),
                         [](const auto& info) {
                             std::string name = "halo" + std::to_string(info.param.halo);
                             for (const int cut : info.param.cuts) name += "_" + std::to_string(cut);
                             return name;
                         });

TEST_P(SegmentColumnsTest, GhostColumnsRepeatTheLinksBesideASegment) {
    std::vector<model::ColumnsOf<double>> fields;
    SegmentEdges<double> edges(rows, GetParam().halo);
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
        for (int link = own.first - GetParam().halo; link < own.last + GetParam().halo; ++link) {
            for (int row = 0; row < rows; ++row)
                EXPECT_EQ(*field.at(row, link + columns_.shift(s)), number(row, (link + 10 * links()) % links())) << "segment " << s;
        }
    }
}

TEST(SegmentColumns, OfOneSegmentAreLinksSideBySide) {
    SegmentColumns columns(1);
    columns.lay_out(Partition::equal(84, 1));
    EXPECT_EQ(columns.shift(0), 1);
    EXPECT_EQ(columns.count(0), 86);
}

}  // namespace
}  // namespace cvtflow::tasks
