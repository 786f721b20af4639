#include "tasks/scene/kept_state.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace cvtflow::tasks {
namespace {

class KeptStateTest : public testing::Test {
protected:
    ~KeptStateTest() override { std::filesystem::remove(file_); }
    void write(double value) const { engine::write_state(file_, {.state = {value}}); }

    const std::string file_ = (std::filesystem::temp_directory_path() / ("cvtflow_kept_" + std::to_string(getpid()) + ".h5")).string();
    const KeptState kept_;
};

TEST_F(KeptStateTest, IsReadOnceForAllCopies) {
    write(1.0);
    const auto first = kept_.read(file_);
    EXPECT_EQ(first->state, std::vector<double>{1.0});
    const KeptState copy = kept_;
    EXPECT_EQ(copy.read(file_), first);  // the same object
    std::filesystem::remove(file_);
    EXPECT_EQ(copy.read(file_), first);  // and it outlives its file
}

TEST_F(KeptStateTest, IsReadAnewWhenTheFileIsAnotherOne) {
    write(1.0);
    (void)kept_.read(file_);
    write(2.0);
    EXPECT_EQ(kept_.read(file_)->state, std::vector<double>{2.0});
    EXPECT_THROW((void)kept_.read(file_ + ".absent"), engine::RecordError);
}

}  // namespace
}  // namespace cvtflow::tasks
