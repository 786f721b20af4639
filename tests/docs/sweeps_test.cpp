/// The reference of sweeps on its page is the program's.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

TEST(SweepPage, HasARowForEveryKey) {
    const std::string text = page("docs/sweeps.md").text;
    for (const tasks::SweepKey& row : tasks::sweep_keys()) {
        if (row.table.find('.') != std::string_view::npos) continue;  // the row of the list names what is in its tables
        const std::string key = row.form == tasks::SweepForm::scene_keys ? "sweep.set" : row.key();
        EXPECT_THAT(text, testing::HasSubstr("\n| `" + key + "` | ")) << key;
    }
}

TEST(SweepPage, NamesNoKeyThatIsNotThere) {
    const std::string text = page("docs/sweeps.md").text;
    for (std::size_t row = text.find("\n| `sweep."); row != std::string::npos; row = text.find("\n| `sweep.", row + 1)) {
        const std::size_t begin = row + 4;
        EXPECT_NO_THROW((void)tasks::explain_sweep(text.substr(begin, text.find('`', begin) - begin)));
    }
}

}  // namespace
}  // namespace cvtflow::docs
