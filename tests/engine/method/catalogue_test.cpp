#include "engine/method/catalogue.hpp"

#include <gtest/gtest.h>

#include <set>

namespace cvtflow::engine {
namespace {

TEST(MethodCatalogue, EveryMethodIsDescribed) {
    for (const StagePlan& plan : methods()) {
        EXPECT_FALSE(plan.description.empty()) << plan.name;
        EXPECT_FALSE(plan.source.empty()) << plan.name;
    }
}

TEST(MethodCatalogue, NamesAreUniqueAndFound) {
    std::set<std::string> names;
    for (const StagePlan& plan : methods()) {
        EXPECT_TRUE(names.insert(plan.name).second) << plan.name;
        const StagePlan* found = find_method(plan.name);
        ASSERT_NE(found, nullptr) << plan.name;
        EXPECT_EQ(found->name, plan.name);
    }
}

TEST(MethodCatalogue, UnknownNamesGiveNothing) {
    EXPECT_EQ(find_method("rk5"), nullptr);
    EXPECT_EQ(find_method(""), nullptr);
}

}  // namespace
}  // namespace cvtflow::engine
