#include "engine/executor/cancellation.hpp"

#include <gtest/gtest.h>

namespace cvtflow::engine {
namespace {

TEST(Cancellation, AsksUntilTheAnswerIsYes) {
    int asked = 0;
    const std::function<bool()> third = [&] { return ++asked == 3; };
    Cancellation cancel(third);
    EXPECT_FALSE(cancel.requested());
    EXPECT_FALSE(cancel.requested());
    EXPECT_TRUE(cancel.requested());
    EXPECT_TRUE(cancel.requested()) << "although the answer would be no again";
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(cancel.withdraw());
    EXPECT_FALSE(cancel.requested());
}

TEST(Cancellation, AsksNoFunctionWhereThereIsNone) {
    const std::function<bool()> none;
    Cancellation cancel(none);
    EXPECT_FALSE(cancel.requested());
    cancel.request();
    EXPECT_TRUE(cancel.requested());
}

}  // namespace
}  // namespace cvtflow::engine
