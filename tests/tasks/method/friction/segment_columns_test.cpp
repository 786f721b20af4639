#include "tasks/method/friction/segment_columns.hpp"

#include <gtest/gtest.h>

#include <map>
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
    [[nodiscard]] static int line() { return model::ColumnsOf<double>::line; }
    [[nodiscard]] static double number(int row, int link) { return 1000.0 * row + link + 1; }

    SegmentColumnsTest() { columns_.lay_out(Partition::at(GetParam().cuts)); }
    [[nodiscard]] int links() const { return GetParam().cuts.back(); }

    SegmentColumns columns_{GetParam().halo, line()};
};

INSTANTIATE_TEST_SUITE_P(Partitions, SegmentColumnsTest,
                         testing::Values(Cut{{0, 84}, 1}, Cut{{0, 40, 84}, 1}, Cut{{0, 1, 2, 3}, 1}, Cut{{0, 42, 84}, 3},
                                         Cut{{0, 1, 2, 3, 4, 5, 6, 7}, 3}, Cut{{0, 7, 9, 10, 30}, 3}),
                         [](const auto& info) {
                             std::string name = "halo" + std::to_string(info.param.halo);
                             for (const int cut : info.param.cuts) name += "_" + std::to_string(cut);
                             return name;
                         });

TEST_P(SegmentColumnsTest, SegmentsShareNoCacheLine) {
    std::map<int, int> writer;  // of lines
    for (int s = 0; s < columns_.segments(); ++s) {
        EXPECT_EQ(columns_.first(s) % line(), 1);
        const int halo = GetParam().halo;
        for (int column = columns_.first(s) - halo; column < columns_.first(s) + columns_.segment(s).size() + halo; ++column) {
            EXPECT_LT(column, columns_.count());
            const auto [entry, is_new] = writer.emplace((column - 1 + 8 * line()) / line(), s);
            EXPECT_EQ(entry->second, s) << "column " << column;
        }
    }
}

TEST_P(SegmentColumnsTest, GhostColumnsRepeatTheLinksBesideASegment) {
    model::ColumnsOf<double> field(rows, columns_.count());
    SegmentEdges<double> edges(rows, GetParam().halo);
    edges.make_room(columns_.segments());
    for (int s = 0; s < columns_.segments(); ++s) {
        for (int link = columns_.segment(s).first; link < columns_.segment(s).last; ++link) {
            for (int row = 0; row < rows; ++row) *field.at(row, link + columns_.shift(s)) = number(row, link);
        }
        edges.give(columns_, field, s);
    }
    for (int s = 0; s < columns_.segments(); ++s) {
        edges.take(columns_, field, s);
        const Segment& own = columns_.segment(s);
        for (int link = own.first - GetParam().halo; link < own.last + GetParam().halo; ++link) {
            for (int row = 0; row < rows; ++row)
                EXPECT_EQ(*field.at(row, link + columns_.shift(s)), number(row, (link + 10 * links()) % links())) << "segment " << s;
        }
    }
}

TEST(SegmentColumns, OfOneSegmentAreLinksSideBySide) {
    SegmentColumns columns(1, 8);
    columns.lay_out(Partition::equal(84, 1));
    EXPECT_EQ(columns.first(0), 1);
    EXPECT_EQ(columns.shift(0), 1);
    EXPECT_EQ(columns.count(), 86);
}

}  // namespace
}  // namespace cvtflow::tasks
