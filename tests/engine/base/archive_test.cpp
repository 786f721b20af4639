#include "engine/base/archive.hpp"

#include <gtest/gtest.h>

#include <array>

namespace cvtflow::engine {
namespace {

enum class Phase : std::uint8_t { free, touching };
struct Pair {
    double depth, slip;
    bool operator==(const Pair&) const = default;
};

/// A field of every type.
struct Everything {
    bool flag = false;
    int small = 0;
    long count = 0;
    std::size_t size = 0;
    double number = 0.0;
    float single = 0.0F;
    std::optional<double> given, absent;
    std::string text;
    std::vector<Phase> phases;
    std::vector<Pair> pairs;
    std::array<double, 2> both{};
    bool operator==(const Everything&) const = default;
    void visit(Archive& archive) {
        archive("flag", flag), archive("small", small, -1, 5), archive("count", count), archive("size", size), archive("number", number);
        archive("single", single), archive("given", given), archive("absent", absent), archive("text", text);
        archive("phases", phases), archive("pairs", pairs), archive("both", both);
    }
};

Everything every_field() {
    return {true,      -1, -5'000'000'000, 7, -0.5, 0.25F, 3.0, {}, "text", {Phase::free, Phase::touching}, {{1.0, 2.0}, {3.0, 4.0}},
            {5.0, 6.0}};
}

std::vector<std::byte> bytes_of(Everything all) {
    return state_of([&](Archive& archive) { all.visit(archive); });
}

Everything everything_in(std::span<const std::byte> state) {
    Everything all;
    read_fields(fields_of_state(state), [&](Archive& archive) { all.visit(archive); });
    return all;
}

TEST(Archive, GivesBackFieldsOfEveryType) { EXPECT_EQ(everything_in(bytes_of(every_field())), every_field()); }

TEST(Archive, RefusesEveryChangedBitAndEveryCut) {
    const std::vector<std::byte> good = bytes_of(every_field());
    for (std::size_t at = 0; at < good.size(); ++at) {
        std::vector<std::byte> bad = good;
        bad[at] ^= std::byte{4};
        EXPECT_THROW((void)everything_in(bad), ArchiveError) << at;
        EXPECT_THROW((void)everything_in(std::span(good).first(at)), ArchiveError) << at;
    }
}

/// Without the checksum: other names, types and sizes, values out of range, fields too many.
TEST(Archive, RefusesOtherFields) {
    const auto reading = [](auto written, auto into) {
        std::vector<std::byte> fields;
        write_fields(fields, written);
        read_fields(fields, into);
    };
    double number = 1.0;
    bool flag = false;
    int small = 9;
    std::array<double, 2> both{};
    std::vector<Pair> pairs;
    const auto visit = [](const char* name, auto& value) { return [name, &value](Archive& archive) { archive(name, value); }; };
    EXPECT_NO_THROW(reading(visit("a", number), visit("a", number)));
    EXPECT_THROW(reading(visit("a", number), visit("b", number)), ArchiveError);
    EXPECT_THROW(reading(visit("a", number), visit("ab", number)), ArchiveError);
    EXPECT_THROW(reading(visit("a", number), visit("a", flag)), ArchiveError);
    EXPECT_THROW(reading(visit("a", number), visit("a", both)), ArchiveError);
    EXPECT_THROW(reading(visit("a", number), visit("a", pairs)), ArchiveError) << "half of a pair";
    EXPECT_THROW(reading(visit("a", small), visit("a", flag)), ArchiveError);
    EXPECT_THROW(reading(visit("a", small), [&](Archive& archive) { archive("a", small, 0, 8); }), ArchiveError);
    EXPECT_THROW(reading(visit("a", number), [](Archive&) {}), ArchiveError);
}

}  // namespace
}  // namespace cvtflow::engine
