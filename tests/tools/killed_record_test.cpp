/// A kill (SIGKILL) ends a write of the kernel between two pages of the file. Whatever write that is, the record that is left is readable.

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/record/run/run_file.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tests/tools/power_cut_fixture.hpp"

#ifdef CVTFLOW_POWER

namespace cvtflow::tools {
namespace {

constexpr std::size_t page = 4096;
constexpr int rows = 3000, rows_per_flush = 20;
constexpr std::size_t links = 65;  // chunks of 8 rows then have 4,160 bytes, more than a page

/// The writer, which the test below starts with the path of the record and a log of all writes; no test of its own.
TEST(KilledRecordWriter, DISABLED_Writes) {
    engine::RunContents contents;
    contents.channels = {{.name = "one", .unit = "1"}, {.name = "links/many", .unit = "N", .width = links, .axis = "link"}};
    contents.state_size = 5;
    contents.state_description = "five";
    contents.tables = {{"events", "of a table", {{"time", "s"}}}};
    const char* path = std::getenv("CVTFLOW_KILLED_RECORD");
    ASSERT_NE(path, nullptr);
    engine::RunFile file({path, {}}, contents, {.flush_seconds = 1e9, .channel_rows = 8});
    for (int i = 0; i < rows; ++i) {
        const double number = i;
        file.append(number, std::vector<double>(1 + links, number));
        file.append_state(number, std::vector<double>(5, number), {});
        file.append_row("events", std::vector<double>{number});
        if ((i + 1) % rows_per_flush == 0) file.flush();
    }
}

/// The record as the kernel has it.
struct Kept {
    std::uint64_t inode = 0;
    std::string bytes;
    std::size_t flushed = 0;  ///< rows of completed flushes
};

/// Rows that a reader finds, each checked.
std::size_t readable_rows(const std::string& path) {
    const engine::RunReader reader(path);
    const auto times = reader.times(), many = reader.channel("links/many"), state_times = reader.state_times();
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] != static_cast<double>(i) || many[links * (i + 1) - 1] != times[i])
            throw std::runtime_error("row " + std::to_string(i));
    if (!state_times.empty() && reader.state(state_times.size() - 1).state.back() != state_times.back())
        throw std::runtime_error("last state");
    return times.size();
}

class KilledRecord : public testing::Test {
protected:
    KilledRecord() { std::filesystem::create_directories(folder_); }
    ~KilledRecord() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::vector<Change> logged() const {
        const std::string command = "LD_PRELOAD=" CVTFLOW_POWER " CVTFLOW_POWER_LOG=" + (folder_ / "log").string() +
                                    " CVTFLOW_KILLED_RECORD=" + path_ + " " + std::filesystem::read_symlink("/proc/self/exe").string() +
                                    " --gtest_also_run_disabled_tests --gtest_filter=KilledRecordWriter.* > /dev/null";
        EXPECT_EQ(std::system(command.c_str()), 0);
        return read_power_log(folder_ / "log", folder_);
    }

    /// The record after a kill within `change`.
    /// @param border  of two pages, up to which the kernel came
    void expect_readable(const Kept& kept, const Change& change, std::size_t border) {
        std::string torn = kept.bytes;
        Change part = change;
        part.bytes.resize(border - change.at);
        carry_out(part, torn);
        std::ofstream(left_, std::ios::binary) << torn;
        try {
            EXPECT_GE(readable_rows(left_), kept.flushed);
        } catch (const std::exception& error) {
            ADD_FAILURE() << change.bytes.substr(0, 4) << ", " << change.bytes.size() << " bytes at " << change.at << ": " << error.what();
        }
    }

    const std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("cvtflow_killed_" + std::to_string(getpid()));
    const std::string path_ = (folder_ / "run.h5").string(), left_ = (folder_ / "left.h5").string();
};

TEST_F(KilledRecord, IsReadableWhereverAWriteEnded) {
    const std::vector<Change> changes = logged();
    Kept kept;
    int cuts = 0, flushes = 0;
    const auto end_of = [](const Change& change) { return change.what == "write" ? change.at + change.bytes.size() : 0; };
    for (const Change& change : changes) {
        if (change.what == "create" && change.path == path_ + ".part") kept.inode = change.inode;
        if (change.inode != kept.inode || kept.inode == 0) continue;
        if (change.what == "sync" && flushes < rows / rows_per_flush) kept.flushed = static_cast<std::size_t>(rows_per_flush * ++flushes);
        for (std::size_t border = (change.at / page + 1) * page; flushes > 0 && border < end_of(change); border += page, ++cuts)
            expect_readable(kept, change, border);
        if (change.what == "write" || change.what == "size") carry_out(change, kept.bytes);
    }
    EXPECT_EQ(flushes, rows / rows_per_flush);
    EXPECT_GE(cuts, rows / 8 - rows_per_flush) << "chunks of rows after the first flush";
}

}  // namespace
}  // namespace cvtflow::tools

#endif
