#include "engine/executor/catalogue.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace cvtflow::engine {
namespace {

TEST(ExecutorCatalogue, EveryRowMakesAnExecutorOfItsName) {
    for (const ExecutorRow& row : executors()) {
        EXPECT_EQ(row.make({.threads = 2})->name(), row.name);
        EXPECT_FALSE(row.description.empty()) << row.name;
    }
}

TEST(ExecutorCatalogue, NamesAreUniqueAndFound) {
    std::set<std::string_view> names;
    for (const ExecutorRow& row : executors()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_EQ(find_executor(row.name), &row);
    }
    EXPECT_EQ(find_executor("magic"), nullptr);
}

TEST(ExecutorCatalogue, AbsentOnesSayWhatTheyNeedAndAreNotFound) {
    for (const ExecutorRow& row : absent_executors()) {
        EXPECT_FALSE(row.needs.empty()) << row.name << " is absent for no reason";
        EXPECT_EQ(row.make, nullptr) << row.name;
        EXPECT_EQ(find_executor(row.name), nullptr) << row.name;
        EXPECT_NE(missing_executor(row.name).find("requires " + std::string(row.needs)), std::string::npos) << row.name;
    }
    EXPECT_EQ(missing_executor("fow"), " (did you mean \"flow\"?)");
    EXPECT_EQ(missing_executor("quite another thing"), "");
}

}  // namespace
}  // namespace cvtflow::engine
