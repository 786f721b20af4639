#include "engine/record/case_table.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

class TornTable : public RecordTest {
protected:
    /// The nine rows of the example, as a kill leaves them while the table grows. @return the file's bytes
    [[nodiscard]] std::string growing() const {
        EXPECT_EQ(wait_for(start_child([&] {
                      CaseTable begin = table_;
                      begin.rows.resize(3 * table_.layout.bytes());
                      CaseWriter writer(file_, begin);
                      for (std::size_t i = 3; i < table_.size(); ++i) writer.append(table_.row(i));
                      _exit(0);
                  })),
                  0);
        return read_text_file(file_);
    }
    void write(const std::string& bytes) const {
        std::filesystem::remove(file_);
        std::ofstream(file_, std::ios::binary) << bytes;
    }
    /// Cases of the rows that are found.
    [[nodiscard]] std::vector<std::int64_t> found() const {
        CaseTable left{table_.layout, {}, whole_rows(file_, table_.layout, [&](std::span<const std::byte> row) {
                           const std::int64_t of_case = table_.layout.integer(row, 0);
                           return of_case >= 0 && of_case < 9 && table_.layout.text(row, 2) == "ok";
                       })};
        std::vector<std::int64_t> cases;
        for (std::size_t i = 0; i < left.size(); ++i) cases.push_back(left.layout.integer(left.row(i), 0));
        return cases;
    }

    const CaseTable table_ = example_cases();
    const std::string file_ = path("cases.h5");
    const std::vector<std::int64_t> all_{0, 1, 2, 3, 4, 5, 6, 7, 8};
};

TEST_F(TornTable, HasItsRowsWhereHdf5FindsNone) {
    std::string bytes = growing();
    bytes.replace(0, 48, 48, '\0');  // HDF5's first block, without which nothing is found
    write(bytes);
    EXPECT_EQ(error_of([&] { (void)read_cases(file_); }), file_ + ": not an HDF5 file");
    EXPECT_EQ(found(), all_);
}

TEST_F(TornTable, LosesTheRowOfWhichAnyByteHasChangedAndNoOther) {
    const std::string bytes = growing();
    const auto row = table_.row(4);
    const auto begin = bytes.find(std::string_view(reinterpret_cast<const char*>(row.data()), row.size()));
    ASSERT_NE(begin, std::string::npos);
    for (std::size_t i = 0; i < row.size(); ++i) {
        std::string changed = bytes;
        changed[begin + i] = static_cast<char>(changed[begin + i] ^ 1);
        write(changed);
        EXPECT_EQ(found(), (std::vector<std::int64_t>{0, 1, 2, 3, 5, 6, 7, 8})) << "byte " << i;
    }
    write(bytes.substr(0, begin + row.size() - 1));  // cut within
    EXPECT_EQ(found(), (std::vector<std::int64_t>{0, 1, 2, 3}));
}

TEST_F(TornTable, IsSearchedCompletelyWhereverRowsLie) {
    const auto* rows = reinterpret_cast<const char*>(table_.rows.data());
    const std::size_t size = table_.layout.bytes();
    for (std::size_t before = 0; before <= size; ++before) {  // rows at every place about the end of a mebibyte, and at the file's end
        std::string bytes((std::size_t{1} << 20U) - before, '\0');
        bytes.append(rows, 4 * size).append(1'500'000, '\0').append(rows + 4 * size, 5 * size);
        write(bytes);
        EXPECT_EQ(found(), all_) << before;
    }
}

TEST_F(TornTable, IsKnownByItsTextUnlessItWasFinished) {
    const std::string bytes = growing();
    EXPECT_TRUE(torn_while_growing(file_, "cvtflow cases"));
    EXPECT_FALSE(torn_while_growing(file_, "cvtflow causes"));
    EXPECT_FALSE(torn_while_growing(path("nothing.h5"), "cvtflow cases"));
    write_cases({file_, {.force = true}}, table_);
    EXPECT_FALSE(torn_while_growing(file_, "cvtflow cases"));
    std::string changed = read_text_file(file_);
    changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
    write(changed);
    EXPECT_FALSE(torn_while_growing(file_, "cvtflow cases"));
}

TEST_F(TornTable, IsReplacedIfItsBeginningWasTornAndNoRecordWas) {
    const std::string part = file_ + ".part", signature = "\x89HDF\r\n\x1a\n\x03";
    const IsOwn same_sweep = table_with("definition", "of this sweep");
    const auto is_own = [&](const std::string& mark) {
        std::ofstream(part, std::ios::binary) << signature << std::string(20'000, '\0') << mark;
        return same_sweep(part);
    };
    EXPECT_TRUE(is_own("a page of attributes"));
    EXPECT_FALSE(is_own("cvtflow run"));
    std::filesystem::rename(part, file_);
    EXPECT_FALSE(same_sweep(file_));  // finished tables are never torn
}

using Claims = RecordTest;

TEST_F(Claims, OfProcessesSideBySideCoverEveryCaseOnce) {
    const std::string file = path("claims");
    EXPECT_TRUE(read_claims(file).empty());
    std::vector<int> workers;
    for (int worker = 1; worker <= 4; ++worker) {
        workers.push_back(start_child([&] {
            while (claim_cases(file, worker, 2000, 2).cases > 0) {}
        }));
    }
    for (const int worker : workers) EXPECT_EQ(wait_for(worker), 0);
    const std::vector<Claim> claims = read_claims(file);
    ASSERT_FALSE(claims.empty());
    EXPECT_EQ(claims.front().cases, 2 * (1000 / 256)) << "a 256th of the strands";
    for (std::size_t i = 1; i < claims.size(); ++i) EXPECT_LE(claims[i].cases, claims[i - 1].cases);
    EXPECT_EQ(claims.back().cases, 2) << "one strand at last";
    EXPECT_EQ(claims.back().end(), 2000);
    long sum = 0;
    for (const Claim& claim : claims) sum += claim.cases;
    EXPECT_EQ(sum, 2000) << "without a gap";
}

TEST_F(Claims, ContinueBeforeWhatAKillOrAPowerCutHasTorn) {
    const std::string file = path("claims");
    EXPECT_EQ(claim_cases(file, 3, 20, 1).first, 0);
    EXPECT_EQ(claim_cases(file, 12, 20, 1).first, 1);
    const std::string text = read_text_file(file);
    std::ofstream(file) << text.substr(0, text.size() - 1);
    EXPECT_EQ(read_claims(file).size(), 1u);
    EXPECT_EQ(claim_cases(file, 4, 20, 1).first, 1);
    EXPECT_EQ(read_claims(file).back().worker, 4);
    for (const auto& [from, to] : {std::pair{"           1            1", "           2            1"}, {"4", "0"}, {"4", "x"}}) {
        std::string other = read_text_file(file);
        const auto at = other.find(from, 35);
        ASSERT_NE(at, std::string::npos);
        std::ofstream(file) << other.replace(at, std::string(from).size(), to);
        if (*to == 'x')
            EXPECT_EQ(error_of([&] { (void)read_claims(file); }), file + ": not the claims of a sweep's workers; move it away");
        else
            EXPECT_EQ(read_claims(file).size(), 1u) << "the cases behind are unclaimed";
        std::ofstream(file) << text.substr(0, 35) << "       4            1            1\n";
    }
    std::filesystem::resize_file(file, std::uintmax_t{17} << 20U);
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    for (const std::string& wrong : {file, path("pipe")})  // neither is read, nor waited for
        EXPECT_THAT(error_of([&] { (void)read_claims(wrong); }), testing::HasSubstr("none of a sweep; move it away"));
    std::filesystem::create_symlink(file, path("link"));
    EXPECT_EQ(error_of([&] { (void)claim_cases(path("link"), 1, 20, 1); }),
              path("link") + ": cannot be opened: Too many levels of symbolic links");
}

TEST_F(Claims, FolderLockIsFreeOnlyWhenItsProcessAndThatProcesssChildrenAreGone) {
    const std::string folder = path("place");
    auto lock = FolderLock::if_free(folder);
    ASSERT_NE(lock, nullptr);
    EXPECT_EQ(FolderLock::if_free(folder), nullptr);
    const int child = start_child([] { pause(); });
    lock.reset();
    EXPECT_EQ(FolderLock::if_free(folder), nullptr) << "the child has it still";
    kill(child, SIGKILL);
    EXPECT_EQ(wait_for(child), 128 + SIGKILL);
    EXPECT_NE(FolderLock::if_free(folder), nullptr);
}

}  // namespace
}  // namespace cvtflow::engine
