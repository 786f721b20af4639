/// The table in scenes/sweeps is what the program computes: a sample of its rows in every run, all of them nightly.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/record/case_table.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tests/csv_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

constexpr const char* sweep_file = "scenes/sweeps/slip_efficiency.toml";

/// Runs one share of the sweep and compares it with the published rows.
void compare(int shard, int of) {
    const std::vector<cvtflow::test::CsvRow> published = cvtflow::test::committed_rows("scenes/sweeps/slip_efficiency_results.csv");
    ASSERT_EQ(published.size(), 36u);
    const tests::TemporaryFolder out("published");
    BatchOptions options;
    options.folder = out / "";
    options.threads = 2;
    options.shard = {shard, of};
    const Sweep sweep = read_sweep(std::string(CVTFLOW_SOURCE_DIR "/") + sweep_file, scene_file);
    const BatchReport report = run_batch(sweep, options);
    const auto computed = cvtflow::test::csv_rows(csv_text(engine::read_cases(report.folder + "/cases.h5")));
    EXPECT_EQ(computed.size(), 36u / static_cast<unsigned>(of));
    for (const cvtflow::test::CsvRow& row : computed) {
        const std::string& number = row.at("case");
        const auto& there = *std::ranges::find_if(published, [&](const auto& each) { return each.at("case") == number; });
        EXPECT_EQ(row.at("status"), "ok") << "case " << number;
        EXPECT_EQ(row.at("notes"), there.at("notes")) << "case " << number;
        // Same bits on every machine; 1e-9 is for texts that were rounded.
        for (const char* column : {"slip_mean", "efficiency", "tight_tension_mean", "tips_axial_force_max"}) {
            const double is = std::stod(row.at(column)), was = std::stod(there.at(column));
            EXPECT_NEAR(is, was, 1e-9 * std::abs(was)) << "case " << number << " " << column;
        }
    }
}

TEST(PublishedSweep, ASampleOfItsRowsIsWhatTheProgramComputes) { compare(3, cvtflow::test::depth(36, 12)); }
TEST(NightlyPublishedSweep, AllOfItsRowsAreWhatTheProgramComputes) { compare(1, 1); }

}  // namespace
}  // namespace cvtflow::tasks
