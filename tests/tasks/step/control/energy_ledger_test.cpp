#include "tasks/step/control/energy_ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tasks/run/run_means.hpp"

namespace cvtflow::tasks {
namespace {

/// Samples of a chain that dissipates `power` [W] and whose energy changes at `rate` [W], for 4 ms.
EnergyLedger sampled(double power, double rate) {
    EnergyLedger ledger;
    ledger.restart(1);
    for (int k = 0; k <= 400; ++k) {
        model::Account links;
        links.lose(model::Loss::tip_friction, power);
        links.store(model::Energy::plates, 1.0 + rate * 1e-5 * k);
        ledger.sample(1e-5 * k, links, {}, 7e-4);
    }
    return ledger;
}

TEST(EnergyLedger, ClosesWhereWhatIsLostWasStored) {
    const EnergyLedger honest = sampled(300.0, -300.0);
    EXPECT_NEAR(honest.balance().loss, 300.0 * 4e-3, 1e-12);
    EXPECT_NEAR(honest.balance().residual(), 0.0, 1e-12);
    EXPECT_TRUE(honest.reliable());
}

TEST(EnergyLedger, CallsEnergyFromNowhereUnreliable) {
    const EnergyLedger wrong = sampled(300.0, -297.0);  // a hundredth of what is lost comes from nowhere: ten times the tolerance
    EXPECT_NEAR(wrong.balance().relative(), 0.01, 1e-9);
    EXPECT_GT(wrong.suspicion(), 5.0);
    EXPECT_FALSE(wrong.reliable());
}

/// Powers that grow and turn over from sample to sample, as where a step is too long for damping: as much noise as power, and nothing
/// was stored.
TEST(EnergyLedger, NoiseThatARunMakesByItselfExcusesNothing) {
    EnergyLedger ledger;
    ledger.restart(1);
    for (int k = 0; k <= 40; ++k) {
        model::Account links;
        links.lose(model::Loss::tip_friction, k % 2 == 0 ? std::ldexp(1e-6, k) : 0.0);
        links.store(model::Energy::plates, 1.0);
        ledger.sample(1e-5 * k, links, {}, 7e-4);
    }
    EXPECT_GT(6.0 * ledger.balance().deviation, ledger.balance().loss) << "noise alone would explain it";
    EXPECT_NEAR(ledger.balance().relative(), 1.0, 1e-12);
    EXPECT_FALSE(ledger.reliable());
}

/// A start that does not fit: what it dissipates at once is as noisy as it is large.
TEST(EnergyLedger, NoiseExcusesNoMoreThanAHundredthOfTheLossesWhereThereAreInputs) {
    EnergyBalance balance{.span = 20e-3, .change = -100.0, .loss = 101.1, .stored = 100.0, .deviation = 50.0, .samples = 500.0};
    EXPECT_LT(balance.suspicion(), 1.0) << "a ring: nothing comes in";
    balance.through = 600.0;
    EXPECT_GT(balance.suspicion(), 1.0);
    balance.loss = 100.6;  // no right run exceeded 0.0063
    EXPECT_LT(balance.suspicion(), 1.0);
}

TEST(EnergyLedger, GoesOnFromItsMemoryBitByBit) {
    const EnergyLedger before = sampled(300.0, -297.0);
    std::vector<double> memory, again;
    before.save(memory);
    EnergyLedger after;
    after.load(memory, 1);
    after.save(again);
    EXPECT_EQ(memory, again);
    EXPECT_EQ(after.suspicion(), before.suspicion());
    memory.pop_back();
    EXPECT_THROW(after.load(memory, 1), std::invalid_argument);
}

TEST(EnergySums, EfficiencyIsOneLessLossesOverWhatTheInputsBrought) {
    EnergySums before, after;
    after.loss[0] = 2.0;
    after.work = {100.0, -98.0, 0.0};  // drive brings, load takes
    EXPECT_DOUBLE_EQ(after.efficiency_since(before), 0.98);
    EXPECT_TRUE(std::isnan(before.efficiency_since(before))) << "without input there is none";
}

TEST(RunMeans, AreOverWholePinPeriodsAndSayWhatIsOdd) {
    RunMeans means;
    for (int k = 0; k <= 5000; ++k) {  // more outputs than bins: 100 ms of a chain that begins to slide
        model::Observation now;
        now.time = 2e-5 * k;
        now.ratio = 1.0;
        now.speed = {200.0, 200.0};
        now.slip = k < 2500 ? 0.002 : 0.1;
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work[0] = 1e4 * now.time;
        sums.work[1] = -9.8e3 * now.time;
        sums.loss[0] = 200.0 * now.time;
        means.add(now, sums, 7e-4);
    }
    EXPECT_NEAR(means.all().slip, 0.051, 1e-4);
    EXPECT_NEAR(means.last_fifth().slip, 0.1, 1e-14);  // rounding of a sum of a thousand
    EXPECT_NEAR(means.all().efficiency, 0.98, 1e-9);
    EXPECT_EQ(means.all().periods, std::floor(0.1 / 7e-4));
    std::string names;
    EnergyBalance balance{.work = 20.0, .loss = 20.0, .through = 1e3, .stored = 4.0, .samples = 100.0};
    means.name_notes(balance, names);
    EXPECT_EQ(names, "gross_slip unsteady");
    balance.loss = 0.05;  // 1e-5 of what came in are a fifth of it
    means.name_notes(balance, names);
    EXPECT_EQ(names, "gross_slip unsteady unresolved");
    std::vector<double> memory;
    means.save(memory);
    RunMeans again;
    EXPECT_TRUE(again.load(memory).empty());
    EXPECT_EQ(again.all().slip, means.all().slip);
}

/// One output above the limit of clamping is enough.
TEST(RunMeans, SayWhereClampingWasAboveItsLimit) {
    for (const double most : {0.99, 1.01}) {
        RunMeans means;
        for (int k = 0; k <= 1000; ++k) {
            model::Observation now;
            now.time = 1e-3 * k;
            now.limit_use = k == 500 ? most : 0.5;
            means.add(now, {}, 1e-3);
        }
        std::string names;
        means.name_notes({}, names);
        EXPECT_EQ(names.find("clamping_limit") != std::string::npos, most > 1.0) << names;
        EXPECT_NEAR(means.all().beyond, most > 1.0 ? 1.0 / 1001.0 : 0.0, 1e-15);
    }
}

/// 1 s of a machine that carries nothing. speed of its shafts [rad/s]
std::string notes_of_idling(double speed) {
    RunMeans means;
    for (int k = 0; k <= 1000; ++k) {
        model::Observation now;
        now.time = 1e-3 * k;
        now.ratio = 1.0;
        now.speed = {speed, -speed};
        now.slip = k % 2 == 0 ? 0.4 : -0.3;
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work = {100.0 * now.time, -10.0 * now.time, 150.0 * now.time};  // clamping brings energy, what moves keeps it
        sums.loss[0] = 90.0 * now.time;
        means.add(now, sums, 1e-3);
    }
    std::string names;
    means.name_notes({.work = 240.0, .loss = 90.0, .through = 250.0, .samples = 100.0}, names);
    return names;
}

TEST(RunMeans, SayWhereSlipIsNoiseAndWhereEfficiencyIsThatOfIdling) {
    EXPECT_EQ(notes_of_idling(200.0), "gross_slip unsteady no_load") << "64 % of the input are neither lost nor carried";
    EXPECT_EQ(notes_of_idling(2e-3), "standstill");
}

/// Means of a steady chain, a tenth of a second, of 100 W of losses, whose drive and load have those powers [W].
RunMeans steady_means(double drive, double load, double pin_period = 7e-4, double cylinder = 0.0) {
    RunMeans means;
    for (int k = 0; k <= 5000; ++k) {
        model::Observation now;
        now.time = 2e-5 * k;
        now.ratio = 1.0;
        now.speed = {200.0, -200.0};
        now.slack = 100.0;
        EnergySums sums;
        sums.time = now.time;
        sums.work[0] = drive * now.time;
        sums.work[1] = -load * now.time;
        sums.work[2] = -cylinder * now.time;
        sums.loss[0] = 100.0 * now.time;
        means.add(now, sums, pin_period);
    }
    return means;
}

constexpr EnergyBalance closed_balance{.work = 10.0, .loss = 10.0, .through = 1000.0, .samples = 100.0};

std::string names_of(const RunMeans& means) {
    std::string names;
    means.name_notes(closed_balance, names);
    return names;
}

TEST(RunMeans, OfAStateThatStoresOrGivesEnergyAreNotSteady) {
    EXPECT_EQ(names_of(steady_means(10000.0, 9900.0)), "");
    EXPECT_EQ(names_of(steady_means(10000.0, 9600.0)), "unsteady") << "3 % of the input are stored";
    EXPECT_EQ(names_of(steady_means(6000.0, 9600.0)), "unsteady") << "the load is carried by what moves";
    EXPECT_THAT(steady_means(6000.0, 9600.0).notes(closed_balance).front().text,
                testing::HasSubstr("the stored energy has given 61.7 % of the input"));
    EXPECT_EQ(names_of(steady_means(10000.0, 9900.0, 0.2)), "unsteady") << "half a pin period";
}

TEST(RunMeans, WithoutLoadThereIsNoEfficiency) {
    const RunMeans means = steady_means(100.0, 0.0);
    EXPECT_TRUE(std::isnan(means.all().efficiency));
    EXPECT_EQ(names_of(means), "no_load");
    EXPECT_TRUE(std::isnan(steady_means(120.0, 0.0, 7e-4, 20.0).all().efficiency)) << "what a cylinder takes is no load";
}

}  // namespace
}  // namespace cvtflow::tasks
