/// Hashes, texts, input files, provenance.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/base/input_file.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

// Vectors of the FNV reference (isthe.com/chongo/tech/comp/fnv).
TEST(Hash, IsFnv1aOf64Bits) {
    EXPECT_EQ(Hash{}.hex(), "cbf29ce484222325");
    EXPECT_EQ(Hash{}.add(std::string_view("a")).hex(), "af63dc4c8601ec8c");
    EXPECT_EQ(Hash{}.add(std::string_view("foo")).add(std::string_view("bar")).hex(), "85944171f73967e8");
    EXPECT_EQ(hex(0x1fULL), "000000000000001f");
}

TEST(Hash, ReadsDoublesAsLittleEndianBytes) {
    const std::array<std::uint8_t, 8> one{0, 0, 0, 0, 0, 0, 0xf0, 0x3f};  // 1.0 in IEEE 754
    EXPECT_EQ(state_hash(std::array{1.0}), Hash{}.add(std::span<const std::uint8_t>(one)).value());
}

TEST(Hash, DistinguishesNegativeZeroFromZeroAndSeesOrder) {
    EXPECT_NE(state_hash(std::array{0.0}), state_hash(std::array{-0.0}));
    EXPECT_NE(state_hash(std::array{1.0, 2.0}), state_hash(std::array{2.0, 1.0}));
}

std::vector<std::byte> some_bytes(std::size_t count) {
    std::mt19937 draw(3);
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(draw() & 255U);
    return bytes;
}

TEST(Checksum, DoesNotDependOnHowBytesWereCutIntoCalls) {
    const std::vector<std::byte> bytes = some_bytes(300);
    const std::uint64_t whole = Checksum().add(bytes).value();
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
        const std::span<const std::byte> all(bytes);
        EXPECT_EQ(Checksum().add(all.first(cut)).add(all.subspan(cut)).value(), whole);
    }
}

template <class Body>
std::string text_of(const Body& body) {
    try {
        body();
    } catch (const std::exception& error) {
        return error_text(error);
    }
    return "nothing was thrown";
}

TEST(ErrorText, OfFilesIsPathAndReason) {
    const std::string name(300, 'a');
    EXPECT_EQ(text_of([&] { (void)std::filesystem::is_directory(name); }), name + ": File name too long");
    EXPECT_EQ(text_of([] { std::filesystem::create_directories("/proc/self/here"); }), "/proc/self/here: No such file or directory");
}

TEST(ErrorText, OfAnInternalErrorStatesThat) {
    const std::vector<int> empty;
    EXPECT_TRUE(text_of([&] { (void)empty.at(3); }).starts_with("an error in this program, please report it (vector::_M_range_check"));
}

TEST(ErrorText, OfOurOwnExceptionsIsWhatTheySay) {
    EXPECT_EQ(text_of([] { throw std::runtime_error("x.h5: No such file or directory"); }), "x.h5: No such file or directory");
}

TEST(Spelling, DistanceCountsInsertionsDeletionsReplacementsAndSwaps) {
    for (const auto& [word, meant, distance] : {std::tuple{"pitch", "pitch", 0U},
                                                {"pich", "pitch", 1U},
                                                {"pittch", "pitch", 1U},
                                                {"patch", "pitch", 1U},
                                                {"ptich", "pitch", 1U},
                                                {"", "pitch", 5U},
                                                {"kitten", "sitting", 3U}}) {
        EXPECT_EQ(edit_distance(word, meant), distance) << word;
        EXPECT_EQ(edit_distance(meant, word), distance) << word;
    }
}

TEST(Spelling, TheNearestCandidateIsAskedForUnlessItIsFar) {
    EXPECT_EQ(closest("chian", {"chain", "half", "plate"}), "chain");
    EXPECT_EQ(closest("drivem", {"driving", "driven"}), "driven");
    EXPECT_EQ(closest("gearbox", {"chain", "half", "plate"}), "");
    EXPECT_EQ(closest("x", {"y", "z"}), "");
    EXPECT_EQ(closest("pitch", {}), "");
    EXPECT_EQ(did_you_mean("chain"), " (did you mean \"chain\"?)");
    EXPECT_EQ(did_you_mean(""), "");
    EXPECT_EQ(did_you_mean(std::vector<std::string>{"pins", "rods"}), " (did you mean \"pins\" or \"rods\"?)");
}

using InputFileTest = RecordTest;

std::string refusal(const std::string& path, std::uint64_t most = 1'000'000) {
    try {
        (void)read_text_input(path, most);
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST_F(InputFileTest, IsReadCompletely) {
    const std::string text(100'000, 'x');
    std::ofstream(path("text")) << text;
    EXPECT_EQ(read_text_input(path("text"), 1'000'000), text);
}

TEST_F(InputFileTest, LosesItsByteOrderMark) {
    std::ofstream(path("text")) << "\xEF\xBB\xBFkey = 1\n";
    EXPECT_EQ(read_text_input(path("text"), 1'000'000), "key = 1\n");
}

TEST_F(InputFileTest, MayBeNoPipeNoDeviceAndNoFolder) {
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_EQ(refusal(path("pipe")), "not a regular file");  // without a writer, opening it would wait for ever
    EXPECT_EQ(refusal("/dev/zero"), "not a regular file");
    EXPECT_EQ(refusal(path("")), "a folder, not a file");
    EXPECT_EQ(refusal(path("absent")), "No such file or directory");
}

TEST_F(InputFileTest, MayComeThroughAPipeWithoutAName) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const std::string name = "/dev/fd/" + std::to_string(ends[0]);
    ASSERT_EQ(write(ends[1], "12345", 5), 5);
    close(ends[1]);
    EXPECT_EQ(read_text_input(name, 5), "12345");
    EXPECT_EQ(read_text_input(name, 5), "");  // taken out of it
    close(ends[0]);
    ASSERT_EQ(pipe(ends), 0);
    ASSERT_EQ(write(ends[1], "12345", 5), 5);
    EXPECT_EQ(refusal("/dev/fd/" + std::to_string(ends[0]), 4), "more than the 4 bytes that such a file may have");
    close(ends[0]);
    close(ends[1]);
}

TEST_F(InputFileTest, HasALimitedSizeAlsoIfItDoesNotTellIt) {
    std::ofstream(path("text")) << "12345";
    EXPECT_EQ(refusal(path("text"), 5), "none");
    EXPECT_EQ(refusal(path("text"), 4), "5 bytes, more than the 4 that such a file may have");
    EXPECT_EQ(refusal("/proc/self/status", 4), "more than the 4 bytes that such a file may have");  // its size is said to be 0
}

TEST(Provenance, NamesProgramBuildAndMachine) {
    const Provenance here = current_provenance();
    EXPECT_THAT(here.version, testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
    EXPECT_FALSE(here.commit.empty());
    EXPECT_THAT(here.compiler, testing::MatchesRegex("[A-Za-z]+ [0-9.]+"));
    EXPECT_FALSE(here.build_type.empty());
    EXPECT_FALSE(here.instruction_set.empty());
    EXPECT_FALSE(here.cpu.empty());
    EXPECT_GE(here.cores, 1);
    EXPECT_FALSE(here.os.empty());
}

TEST(Provenance, DatesInUtc) {
    EXPECT_THAT(current_provenance().date, testing::MatchesRegex("20[0-9][0-9]-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z"));
}

}  // namespace
}  // namespace cvtflow::engine
