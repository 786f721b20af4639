#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/random_state.hpp"

namespace cvtflow::model {
namespace {

/// Whole pins of one scene at a random state.
struct Rig {
    Rig(const Parameters& p, std::uint64_t seed) : parameters(p), variator(p), random(oracle::random_state(p, seed)), scratch(layout()) {
        fill_window(variator, random.state.data(), scratch);
        if (layout().pulley_size != 0) variator.pulleys().motions(random.state.data() + layout().pulley_begin(), scratch.sheaves);
    }
    [[nodiscard]] const ChainLayout& layout() const { return variator.layout(); }
    [[nodiscard]] const double* window(int first) const { return scratch.window.data() + first * layout().link_block(); }
    [[nodiscard]] ChainRange range(int first, int last) const {
        return {first, last, window(first), scratch.sheaves, random.phases.data()};
    }

    Parameters parameters;
    Variator variator;
    oracle::RandomState random;
    EvaluationScratch scratch;
};

/// Slopes and loads of all pins, evaluated in ranges of a length.
std::vector<double> slopes_in_ranges(Rig& rig, int length, bool observe) {
    const ChainLayout& at = rig.layout();
    std::vector<double> slope(static_cast<std::size_t>(at.pulley_begin()));
    std::vector<LinkLoad> loads(static_cast<std::size_t>(at.links), LinkLoad{});
    std::vector<Account> accounts(static_cast<std::size_t>(account_parts * at.links));
    for (int first = 0; first < at.links; first += length) {
        const ChainRange range = rig.range(first, std::min(first + length, at.links));
        double* to = slope.data() + at.link_begin(first);
        if (observe) {
            rig.variator.chain().observed_slopes(range, to, loads.data() + first, accounts.data() + account_parts * first);
        } else {
            rig.variator.chain().slopes(range, to, loads.data() + first);
        }
    }
    for (const LinkLoad& load : loads) {
        double numbers[sizeof load.load / sizeof(double)];
        std::memcpy(numbers, &load.load, sizeof numbers);
        slope.insert(slope.end(), std::begin(numbers), std::end(numbers));
    }
    return slope;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(PinKernels, GiveTheSameBitsInRangesOfAnyLengthAndWithAccounts) {
    std::uint64_t seed = 40;
    std::vector<oracle::Case> cases = oracle::whole_pins(oracle::small_scene());
    cases.push_back({"the chain of the baseline, longer than what is computed together", Parameters{}});
    cases.back().parameters.detail.pins = PinDetail::whole;
    for (const oracle::Case& one : cases) {
        Rig rig(one.parameters, ++seed);
        const std::vector<double> whole = slopes_in_ranges(rig, rig.layout().links, false);
        for (const int length : {1, 2, 3, 5, 8, 11}) {
            EXPECT_TRUE(same_bits(slopes_in_ranges(rig, length, false), whole)) << one.name << ", ranges of " << length;
        }
        EXPECT_TRUE(same_bits(slopes_in_ranges(rig, rig.layout().links, true), whole)) << one.name;
    }
}

/// Accounts of all pins and what they carry, evaluated in ranges of a length.
std::vector<double> observed_in_ranges(Rig& rig, int length) {
    const ChainLayout& at = rig.layout();
    std::vector<double> slope(static_cast<std::size_t>(at.pulley_begin()));
    std::vector<LinkLoad> loads(static_cast<std::size_t>(at.links), LinkLoad{});
    std::vector<Account> accounts(static_cast<std::size_t>(account_parts * at.links));
    std::vector<LinkContact> contacts(static_cast<std::size_t>(at.links));
    for (int first = 0; first < at.links; first += length) {
        rig.variator.chain().observed_slopes(rig.range(first, std::min(first + length, at.links)), slope.data() + at.link_begin(first),
                                             loads.data() + first, accounts.data() + account_parts * first, contacts.data() + first);
    }
    std::vector<double> numbers;
    for (const Account& account : accounts) {
        numbers.insert(numbers.end(), account.loss.begin(), account.loss.end());
        numbers.insert(numbers.end(), account.energy.begin(), account.energy.end());
    }
    for (const LinkContact& contact : contacts) {
        double carried[sizeof contact / sizeof(double)];
        std::memcpy(carried, &contact, sizeof carried);
        numbers.insert(numbers.end(), std::begin(carried), std::end(carried));
    }
    return numbers;
}

/// In ranges of one pin every lane but one is somebody else's.
TEST(PinKernels, KeepTheSameAccountsOfPinsSideBySideAsOneByOne) {
    std::uint64_t seed = 70;
    std::vector<oracle::Case> cases = oracle::whole_pins(oracle::small_scene());
    cases.push_back({"the chain of the baseline, longer than what is computed together", Parameters{}});
    cases.back().parameters.detail.pins = PinDetail::whole;
    for (const oracle::Case& one : cases) {
        Rig rig(one.parameters, ++seed);
        const std::vector<double> alone = observed_in_ranges(rig, 1);
        EXPECT_TRUE(std::any_of(alone.begin(), alone.end(), [](double number) { return number != 0.0; })) << one.name;
        for (const int length : {2, 3, 5, 8, 11, rig.layout().links})
            EXPECT_TRUE(same_bits(observed_in_ranges(rig, length), alone)) << one.name << ", ranges of " << length;
    }
}

TEST(PinKernels, ProbePinsSideBySideAsOneByOne) {
    for (const oracle::Case& one : oracle::whole_pins(oracle::small_scene())) {
        const Rig rig(one.parameters, 11);
        const ChainLayout& at = rig.layout();
        if (at.pulley_size == 0) continue;
        std::vector<TipProbe> probes(static_cast<std::size_t>(at.links));
        rig.variator.chain().probe_links(rig.window(at.halo()), at.links, rig.scratch.sheaves, true, probes.data());
        for (int pin = 0; pin < at.links; ++pin) {
            NeighbourWindow strip;
            TipProbe probe;
            rig.variator.chain().probe(strip.of(at, rig.random.state.data(), pin), rig.scratch.sheaves, true, probe);
            EXPECT_EQ(std::memcmp(&probe, &probes[static_cast<std::size_t>(pin)], sizeof probe), 0) << one.name << ", pin " << pin;
            EXPECT_LT(probe.depth[2], -0.1);  // nobody's tip
            EXPECT_LT(probe.depth[3], -0.1);
        }
    }
}

/// Accelerations of all pins by friction alone and by all the rest, in ranges of a length; pins after pins.
struct Parts {
    std::vector<double> friction, rest;
};

Parts parts_of(const Rig& rig, int length) {
    const ChainLayout& at = rig.layout();
    const int size = at.link_size(), ghosts = at.halo(), columns = at.links + 2 * ghosts;
    const FrictionOperator friction(rig.variator.chain(), rig.parameters.detail.stick_slip);
    ContactField field(rig.variator.chain());
    Columns frictionless(size, columns), velocity(size, columns), slope(size, columns);
    std::vector<LinkLoad> loads(static_cast<std::size_t>(at.links));
    for (int first = 0; first < at.links; first += length)
        friction.record(rig.range(first, std::min(first + length, at.links)), {}, field, frictionless, loads.data() + first);
    for (int pin = -ghosts; pin < at.links + ghosts; ++pin) {
        const double* v = rig.random.state.data() + at.link_begin(at.wrapped(pin)) + size;
        for (int row = 0; row < size; ++row) *velocity.at(row, pin + 1) = v[row];
    }
    for (int first = 0; first < at.links; first += length) {
        const int last = std::min(first + length, at.links);
        std::vector<double> scratch(static_cast<std::size_t>(friction.scratch_size(last - first)));
        friction.slopes(field, {first, last, velocity.at(0, first), velocity.stride(), scratch.data(), rig.random.phases.data(), 0.0},
                        {nullptr, &slope});
    }
    Parts parts;
    for (int pin = 0; pin < at.links; ++pin) {
        for (int row = 0; row < size; ++row) {
            parts.friction.push_back(*slope.at(row, pin + 1));
            parts.rest.push_back(*frictionless.at(row, pin + 1));
        }
    }
    return parts;
}

/// Both sides differ by rounding of forces that cancel: 1e-11 of the largest acceleration, as for halves.
TEST(PinKernels, SplitFrictionFromTheRestForStagesOfItsOwn) {
    std::uint64_t seed = 60;
    for (oracle::Case one : oracle::whole_pins(oracle::small_scene())) {
        one.parameters.detail.stick_slip = one.parameters.detail.order == 2;
        Rig rig(one.parameters, ++seed);
        const ChainLayout& at = rig.layout();
        const std::vector<double> both = slopes_in_ranges(rig, at.links, false);
        const Parts parts = parts_of(rig, at.links);
        double largest = 0.0, difference = 0.0;
        for (int pin = 0; pin < at.links; ++pin) {
            for (int row = 0; row < at.link_size(); ++row) {
                const std::size_t k = static_cast<std::size_t>(pin * at.link_size() + row);
                const double expected = both[static_cast<std::size_t>(at.link_begin(pin) + at.link_size() + row)];
                largest = std::max(largest, std::abs(expected));
                difference = std::max(difference, std::abs(parts.friction[k] + parts.rest[k] - expected));
            }
        }
        EXPECT_LT(difference, 1e-11 * largest) << one.name;
        for (const int length : {1, 3, 7}) {
            const Parts cut = parts_of(rig, length);
            EXPECT_TRUE(same_bits(cut.friction, parts.friction)) << one.name << ", ranges of " << length;
            EXPECT_TRUE(same_bits(cut.rest, parts.rest)) << one.name << ", ranges of " << length;
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
