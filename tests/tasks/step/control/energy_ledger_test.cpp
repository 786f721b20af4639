#include "tasks/step/control/energy_ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
    EXPECT_LE(honest.balance_error_ratio(), 1.0);
}

/// A memory as long as ours, of a program whose fields were others.
TEST(EnergyLedger, RefusesAMemoryOfAnotherLayout) {
    std::vector<double> memory;
    sampled(300.0, -300.0).save(memory);
    EnergyLedger same, other;
    same.load(memory, 1);
    EXPECT_EQ(same.balance().loss, sampled(300.0, -300.0).balance().loss);
    std::vector<double> again;
    same.save(again);
    EXPECT_EQ(again, memory);
    ++memory.front();
    EXPECT_THROW(other.load(memory, 1), std::invalid_argument);
    memory.erase(memory.begin());
    EXPECT_THROW(other.load(memory, 1), std::invalid_argument) << "of programs before layouts";
}

TEST(EnergyLedger, CallsEnergyFromNowhereUnreliable) {
    const EnergyLedger wrong = sampled(300.0, -297.0);  // a hundredth of what is lost comes from nowhere: ten times the tolerance
    EXPECT_NEAR(wrong.balance().relative(), 0.01, 1e-9);
    EXPECT_GT(wrong.balance_error_ratio(), 5.0);
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
    EXPECT_GT(ledger.balance_error_ratio(), 1.0);
}

/// A start that does not fit: what it dissipates at once is as noisy as it is large.
TEST(EnergyLedger, NoiseExcusesNoMoreThanAHundredthOfTheLossesWhereThereAreInputs) {
    EnergyBalance balance{.span = 20e-3, .change = -100.0, .loss = 101.1, .stored = 100.0, .deviation = 50.0, .samples = 500.0};
    EXPECT_LT(balance.balance_error_ratio(), 1.0) << "a ring: nothing comes in";
    balance.energy_in = 600.0;
    EXPECT_GT(balance.balance_error_ratio(), 1.0);
    balance.loss = 100.6;  // no right run exceeded 0.0063
    EXPECT_LT(balance.balance_error_ratio(), 1.0);
}

TEST(EnergyLedger, ContinuesFromItsMemoryBitByBit) {
    const EnergyLedger before = sampled(300.0, -297.0);
    std::vector<double> memory, again;
    before.save(memory);
    EnergyLedger after;
    after.load(memory, 1);
    after.save(again);
    EXPECT_EQ(memory, again);
    EXPECT_EQ(after.balance_error_ratio(), before.balance_error_ratio());
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

}  // namespace
}  // namespace cvtflow::tasks
