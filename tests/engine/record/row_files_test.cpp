#include "engine/record/row_files.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

class Rows : public RecordTest {
protected:
    const std::string folder_ = std::filesystem::path(path("x")).parent_path().string();
    const std::string heading_ = checked_heading("case,status,slip");

    [[nodiscard]] std::string file(const std::string& name) const { return folder_ + "/" + name; }
    void add(const std::string& name, const std::string& text) const {
        std::ofstream(file(name), std::ios::app | std::ios::binary) << text;
    }
};

TEST_F(Rows, HaveTheChecksumOfZlib) {
    EXPECT_EQ(crc32("123456789"), 0xCBF43926U);
    const std::string line = checked_line("3,ok,0.25");
    EXPECT_EQ(checked_cells(std::string_view(line).substr(0, line.size() - 1)), "3,ok,0.25");
    for (std::size_t at = 0; at + 1 < line.size(); ++at) {
        std::string changed = line.substr(0, line.size() - 1);
        changed[at] ^= 1;
        EXPECT_FALSE(checked_cells(changed)) << changed;
    }
}

TEST_F(Rows, OfAllFilesAreOneTableWithoutTornLines) {
    add("rows-a-1.csv", heading_ + checked_line("2,ok,0.5") + checked_line("0,ok,0.125") + checked_line("7,ok,1").substr(0, 9));
    add("rows-b-1.csv", heading_ + checked_line("1,ok,2") + "5,ok,2,00000000\n" + checked_line("2,ok,0.5"));
    RowFiles rows(folder_);
    EXPECT_THAT(rows.numbers(), testing::ElementsAre(0, 1, 2));
    EXPECT_EQ(rows.row(1), "1,ok,2");
    EXPECT_THAT(rows.damage(), testing::ElementsAre(file("rows-b-1.csv") + ":3: its checksum differs"));
    EXPECT_FALSE(rows.refresh());
    add("rows-a-1.csv", checked_line("7,ok,1").substr(9));
    EXPECT_TRUE(rows.refresh());
    EXPECT_EQ(rows.row(7), "7,ok,1") << "the line was complete a moment later";
    add("rows-c-1.csv", checked_heading("case,status") + checked_line("9,ok"));
    EXPECT_EQ(error_of([&] { rows.refresh(); }), file("rows-c-1.csv") + ": rows with other columns than beside it");
}

TEST_F(Rows, WhoseFirstPageAPowerCutHasTakenAreReadBehindIt) {
    add("rows-a-1.csv", std::string(200, '\0') + "\n" + checked_line("4,ok,1"));
    EXPECT_THAT(RowFiles(folder_).numbers(), testing::ElementsAre(4));
}

TEST_F(Rows, AreAddedByManyThreadsToTheFileOfTheirProcess) {
    {
        RowWriter writer(folder_, heading_);
        RowWriter another(folder_, heading_);
        EXPECT_NE(writer.name(), another.name());
        EXPECT_TRUE(being_written(file(writer.name())));
        std::vector<std::jthread> threads;
        for (int k = 0; k < 4; ++k)
            threads.emplace_back([&, k] {
                for (int i = 0; i < 50; ++i) writer.append(checked_line(std::to_string(50 * k + i) + ",ok,1"));
            });
        threads.clear();
        writer.finish();
        another.finish();
        EXPECT_FALSE(std::filesystem::exists(file(another.name()))) << "it has no row";
    }
    EXPECT_EQ(RowFiles(folder_).size(), 200u);
    EXPECT_FALSE(being_written(file(row_files_in(folder_).front())));
}

TEST_F(Rows, ArePiecesOfWorkThatOneProcessTakesUntilItIsDead) {
    RowWriter mine(folder_, heading_);
    Claims claims(folder_, mine.name());
    EXPECT_TRUE(claims.take("000000"));
    EXPECT_TRUE(claims.take("000000")) << "it is mine";
    const int other = start_child([&] {
        RowWriter rows(folder_, heading_);
        rows.append(checked_line("1,ok,1"));
        if (!Claims(folder_, rows.name()).take("000001") || Claims(folder_, rows.name()).take("000000")) _exit(2);
        pause();
    });
    while (!read_claims(folder_).contains("000001")) usleep(1000);
    EXPECT_FALSE(claims.take("000001"));
    EXPECT_THAT(claims.holder(), testing::EndsWith(std::to_string(other) + ".csv"));
    kill(other, SIGKILL);
    EXPECT_EQ(wait_for(other), 128 + SIGKILL);
    EXPECT_TRUE(claims.take("000001"));
    EXPECT_EQ(read_claims(folder_).at("000001"), mine.name());
    claims.remove();
    EXPECT_FALSE(std::filesystem::exists(file("claims")));
}

/// Of another machine nothing is known but whether its file changes, by the clock of this one.
TEST_F(Rows, AreTakenOverFromAnotherMachineThatIsSilent) {
    using namespace std::chrono_literals;
    add("rows-elsewhere-7.csv", heading_);
    RowWriter mine(folder_, heading_);
    Claims claims(folder_, mine.name(), 0.2);
    add("claims/000003", "rows-elsewhere-7.csv\n");
    EXPECT_FALSE(claims.take("000003"));
    std::this_thread::sleep_for(150ms);
    std::filesystem::last_write_time(file("rows-elsewhere-7.csv"), std::filesystem::file_time_type::clock::now() - 48h);
    EXPECT_FALSE(claims.take("000003")) << "a sign of life, whatever its clock says";
    std::this_thread::sleep_for(150ms);
    EXPECT_FALSE(claims.take("000003"));
    std::this_thread::sleep_for(150ms);
    EXPECT_TRUE(claims.take("000003"));
    add("claims/000004", "");  // a power cut took its contents
    EXPECT_FALSE(claims.take("000004"));
    std::this_thread::sleep_for(300ms);
    EXPECT_TRUE(claims.take("000004"));
}

TEST_F(Rows, ThatCannotBeWrittenAreAMessage) {
    Claims claims(folder_, "rows-a-1.csv");
    EXPECT_THAT(error_of([&] { RowWriter(folder_ + "/none", heading_); }), testing::EndsWith(": cannot create: No such file or directory"));
    std::filesystem::rename(folder_, folder_ + ".moved");
    EXPECT_EQ(error_of([&] { static_cast<void>(claims.take("000000")); }),
              folder_ + ": the folder of the sweep was moved or removed meanwhile");
    std::filesystem::rename(folder_ + ".moved", folder_);
    std::filesystem::remove(file("claims"));
    std::filesystem::create_symlink("elsewhere", file("claims"));
    EXPECT_EQ(error_of([&] { Claims(folder_, "rows-a-1.csv"); }), file("claims") + ": cannot create: a file, or a link");
}

}  // namespace
}  // namespace cvtflow::engine
