#include <gtest/gtest.h>
#include <filesystem>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "engine/base/text.hpp"

namespace cvtflow::engine {

namespace {

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

}  // namespace

}  // namespace cvtflow::engine
