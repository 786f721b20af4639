/// The table in scenes/sweeps is what the program computes: a sample of its rows in every run, all of them nightly.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "engine/record/case_table.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const std::string folder = std::string(CVTFLOW_SOURCE_DIR) + "/scenes/sweeps/";

/// Cells by column, of every row, by number of the case.
using Table = std::map<long, std::map<std::string, std::string>>;

Table read_table(std::istream& text) {
    const auto cells = [](const std::string& line) {
        std::vector<std::string> found;
        std::istringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) found.push_back(cell);
        return found;
    };
    std::string line;
    std::getline(text, line);
    const std::vector<std::string> names = cells(line);
    Table table;
    while (std::getline(text, line)) {
        const std::vector<std::string> row = cells(line);
        for (std::size_t k = 0; k < row.size(); ++k) table[std::stol(row[0])][names[k]] = row[k];
    }
    return table;
}

/// Runs one share of the sweep and compares it with the published rows.
void compare(int shard, int of) {
    std::ifstream file(folder + "slip_efficiency_results.csv");
    const Table published = read_table(file);
    ASSERT_EQ(published.size(), 36u);
    const std::filesystem::path out = std::filesystem::temp_directory_path() / ("cvtflow_published_" + std::to_string(getpid()));
    BatchOptions options;
    options.folder = out.string();
    options.threads = 2;
    options.shard = {shard, of};
    const Sweep sweep = read_sweep(folder + "slip_efficiency.toml", [](const std::string& name) {
        return find_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name + ".toml");
    });
    const BatchReport report = run_batch(sweep, options);
    std::istringstream text(csv_text(engine::read_cases(report.folder + "/cases.h5")));
    const Table computed = read_table(text);
    EXPECT_EQ(computed.size(), 36u / static_cast<unsigned>(of));
    for (const auto& [number, row] : computed) {
        const auto& there = published.at(number);
        EXPECT_EQ(row.at("status"), "ok") << "case " << number;
        EXPECT_EQ(row.at("notes"), there.at("notes")) << "case " << number;
        // Same bits on every machine; 1e-9 is for texts that were rounded.
        for (const char* column : {"slip_mean", "efficiency", "tight_tension_mean", "tips_axial_force_max"}) {
            const double is = std::stod(row.at(column)), was = std::stod(there.at(column));
            EXPECT_NEAR(is, was, 1e-9 * std::abs(was)) << "case " << number << " " << column;
        }
    }
    std::filesystem::remove_all(out);
}

TEST(PublishedSweep, ASampleOfItsRowsIsWhatTheProgramComputes) { compare(3, test::depth(36, 12)); }
TEST(NightlyPublishedSweep, AllOfItsRowsAreWhatTheProgramComputes) { compare(1, 1); }

}  // namespace
}  // namespace cvtflow::tasks
