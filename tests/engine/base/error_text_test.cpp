#include "engine/base/error_text.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

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

TEST(ErrorText, OfWhatOnlyAMistakeOfOursCanCauseSaysSo) {
    const std::vector<int> empty;
    EXPECT_TRUE(text_of([&] { (void)empty.at(3); }).starts_with("an error in this program, please report it (vector::_M_range_check"));
}

TEST(ErrorText, OfOurOwnExceptionsIsWhatTheySay) {
    EXPECT_EQ(text_of([] { throw std::runtime_error("x.h5: No such file or directory"); }), "x.h5: No such file or directory");
}

}  // namespace
}  // namespace cvtflow::engine
