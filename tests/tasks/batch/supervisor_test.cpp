#include "tasks/batch/batch.hpp"

#include <gmock/gmock.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <utility>

namespace cvtflow::tasks {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A sweep of eight cases on two workers whose table is a byte per case, shared by all its children.
class Supervisor : public testing::Test {
protected:
    static constexpr int cases = 8;
    enum Row : char { missing, ok, booked };

    Supervisor() : rows_(static_cast<char*>(mmap(nullptr, 64, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
    ~Supervisor() override { munmap(rows_, 64); }

    /// Work of a child: two cases side by side until all are done. `die` may end the process.
    int work(const SweepPart& part, const std::function<void(long)>& die) {
        if (part.only) {
            EXPECT_NE(part.attempt, 0);
            if (part.crashed.empty()) {
                journal_.set(0, *part.only);
                die(*part.only);
            }
            rows_[*part.only] = part.crashed.empty() ? ok : booked;
            return 0;
        }
        for (long number = 0; number < cases; number += 2) {
            for (int worker = 0; worker < 2; ++worker) {
                if (rows_[number + worker] == missing) journal_.set(worker, number + worker);
            }
            for (int worker = 0; worker < 2; ++worker) {
                if (rows_[number + worker] != missing) continue;
                die(number + worker);
                rows_[number + worker] = ok;
                journal_.set(worker, engine::SharedSlots::none);
            }
        }
        return 5;
    }

    int run(const std::function<void(long)>& die) {
        return supervise(
            journal_, [&](const SweepPart& part) { return work(part, die); }, [this](const std::string& line) { said_.push_back(line); });
    }
    [[nodiscard]] std::string rows() const { return {rows_, rows_ + cases}; }

    engine::SharedSlots journal_{2};
    char* rows_;
    std::vector<std::string> said_;
};

TEST_F(Supervisor, WithoutACrashPassesTheStatusOn) {
    EXPECT_EQ(run([](long) {}), 5);
    EXPECT_EQ(rows(), std::string(cases, ok));
    EXPECT_TRUE(said_.empty());
}

/// Every way in which a case can take its process down.
TEST_F(Supervisor, BooksTheCaseThatCrashesAndNoOther) {
    for (const int signal : {SIGSEGV, SIGFPE, SIGABRT, SIGBUS, SIGILL, SIGKILL}) {
        std::fill_n(rows_, cases, missing);
        EXPECT_EQ(run([&](long number) {
                      if (number != 3) return;
                      std::signal(signal, SIG_DFL);
                      std::raise(signal);
                  }),
                  5);
        EXPECT_EQ(rows(), std::string({ok, ok, ok, booked, ok, ok, ok, ok})) << signal;
    }
    EXPECT_THAT(said_, testing::SizeIs(12));
    EXPECT_EQ(said_[0], "a process of the sweep was ended by SIGSEGV (Segmentation fault); its cases run again one by one: case 3");
    EXPECT_EQ(said_[1], "case 3 crashed: SIGSEGV (Segmentation fault)");
}

TEST_F(Supervisor, RunsTheInnocentAloneAndKeepsTheirResults) {
    EXPECT_EQ(run([&](long number) {
                  if (number == 2 || number == 5) std::abort();
              }),
              5);
    EXPECT_EQ(rows(), std::string({ok, ok, booked, ok, ok, booked, ok, ok}));
    EXPECT_THAT(said_, ElementsAre(HasSubstr("cases 2, 3"), StartsWith("case 2 "), HasSubstr("case 5"), StartsWith("case 5 ")));
}

/// Killed from outside, by an operator or for memory: once is not the case's fault.
TEST_F(Supervisor, GivesACaseThatCrashesOnceItsResult) {
    char* once = rows_ + 32;
    EXPECT_EQ(run([&](long number) {
                  if (number == 4 && std::exchange(*once, '\1') == 0) std::raise(SIGKILL);
              }),
              5);
    EXPECT_EQ(rows(), std::string(cases, ok));
}

TEST_F(Supervisor, EndsAfterACrashOutsideOfAnyCase) {
    EXPECT_EQ(supervise(
                  journal_, [](const SweepPart&) -> int { std::abort(); }, [this](const std::string& line) { said_.push_back(line); }),
              1);
    EXPECT_THAT(said_, ElementsAre("a process of the sweep was ended by SIGABRT (Aborted) outside its cases"));
}

TEST_F(Supervisor, BeginsNothingNewAfterAWishToStop) {
    EXPECT_EQ(run([&](long number) {
                  if (number != 3) return;
                  std::signal(SIGTERM, SIG_IGN);
                  kill(getppid(), SIGTERM);  // handed on to this child, which ignores it
                  std::abort();
              }),
              130);
    EXPECT_EQ(rows_[3], missing);
}

}  // namespace
}  // namespace cvtflow::tasks
