#include "engine/record/hdf5/hdf5_checksum.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace cvtflow::engine::hdf5 {
namespace {

TEST(Hdf5Checksum, IsJenkinsLookup3) {
    const auto sum = [](std::string_view text) { return metadata_checksum(std::as_bytes(std::span(text))); };
    EXPECT_EQ(sum(""), 0xdeadbeefU);  // values of its author's own self-test
    EXPECT_EQ(sum("Four score and seven years ago"), 0x17770551U);
}

}  // namespace
}  // namespace cvtflow::engine::hdf5
