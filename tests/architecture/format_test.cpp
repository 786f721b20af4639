/// Sources are formatted by .clang-format, so that a change shows only what changed.

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

TEST(Format, OfEverySourceIsThatOfTheFile) {
    const std::string formatter = output_of("command -v clang-format-14 2>/dev/null");  // other versions break lines elsewhere
    if (formatter.empty()) GTEST_SKIP() << "needs clang-format-14";
    const std::string changed = output_of("cd '" CVTFLOW_SOURCE_DIR
                                          "' && git ls-files -z '*.cpp' '*.hpp' 2>/dev/null | xargs -0 -r clang-format-14 --dry-run 2>&1 | "
                                          "grep -o '^[^:]*:[0-9]*:[0-9]*: warning' | sort -u | head -40; true");
    EXPECT_EQ(changed, "") << "clang-format-14 -i FILE corrects it";
}

}  // namespace
}  // namespace cvtflow::architecture
