/// A default cannot be silently wrong: machines drawn by chance, run with what somebody gets who sets nothing.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "bench/study/extremes/lottery.hpp"

namespace cvtflow::tasks {
namespace {

/// Draws machines and prints the counts by status. Whoever is called finished agrees with a run of a quarter of its step; nine of ten
/// finish.
void play_honestly(long first, long count) {
    const bench::LotteryRules rules;
    std::map<std::string, long> statuses;
    double slip = 0.0, loss = 0.0;
    for (const bench::LotteryTicket& ticket : bench::play_all(1, first, count, 2, rules)) {
        ++statuses[ticket.status];
        EXPECT_TRUE(ticket.honest(rules)) << "machine " << ticket.number << " (cvtflow-lab lottery --first " << ticket.number
                                          << " --machines 1): slip off by " << ticket.slip_error(rules) << ", losses by "
                                          << ticket.loss_error() << ", suspicion " << ticket.suspicion;
        if (ticket.status != "finished") continue;
        slip = std::max(slip, ticket.slip_error(rules));
        loss = std::max(loss, ticket.loss_error());
    }
    std::string counts;
    for (const auto& [status, number] : statuses) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", number, status);
    fmt::print("{} machines: {}; finished ones off by {:.2g} % in slip, {:.2g} % in losses at most\n", count, counts, 100.0 * slip,
               100.0 * loss);
    testing::Test::RecordProperty("counts", counts);
    EXPECT_GE(10 * statuses["finished"], 9 * count) << counts;
}

TEST(Lottery, FortyMachinesEndRightOrSayThatTheyDoNot) { play_honestly(0, 40); }

TEST(NightlyLottery, FourHundredMachinesEndRightOrSayThatTheyDoNot) { play_honestly(40, 400); }

TEST(Lottery, DrawsTheSameMachineForTheSameSeedAndAnotherForEveryNumber) {
    EXPECT_EQ(bench::lottery_machine(3, 5), bench::lottery_machine(3, 5));
    EXPECT_NE(bench::lottery_machine(3, 5), bench::lottery_machine(3, 6));
    EXPECT_NE(bench::lottery_machine(3, 5), bench::lottery_machine(4, 5));
}

}  // namespace
}  // namespace cvtflow::tasks
