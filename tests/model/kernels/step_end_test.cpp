/// Links at a step's end, by the kernels of every instruction set, against a plain loop.

#include "model/kernels/step_end.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "model/kernels/available_isas.hpp"
#include "model/kernels/kernels.hpp"

namespace cvtflow::model {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
constexpr double limit = 1e4, step = 2e-6;

template <class Number>
SweepKernels<Number> kernels(Isa isa, int order) {
    const Kernels all = kernels_of(isa).of_order(order);
    if constexpr (std::is_same_v<Number, float>) {
        return all.single.sweeps;
    } else {
        return all.friction.sweeps;
    }
}

/// Links with numbers that are drawn, one more block of canaries behind them.
template <class Number>
struct Links {
    int links, size;
    ColumnsOf<Number> velocity;
    std::vector<double> counted_from, start, end, secants;

    Links(int links_, int order) : links(links_), size(ChainLayout{order}.link_size()), velocity(size, links + 2) {
        std::mt19937_64 chance(7);
        std::uniform_real_distribution<double> drawn(-9.0, 9.0);
        for (std::vector<double>* each : {&counted_from, &start, &end, &secants}) {
            each->resize(static_cast<std::size_t>(2 * size * (links + 1)));
            for (double& number : *each) number = drawn(chance);
        }
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < velocity.stride() - 1; ++column) *velocity.at(row, column) = static_cast<Number>(nan);
            for (int link = 0; link < links; ++link) *velocity.at(row, 1 + link) = static_cast<Number>(drawn(chance));
        }
    }

    bool finish(Isa isa, int order, bool with_secants) {
        return kernels<Number>(isa, order)
            .end({velocity.at(0, 1), velocity.stride(), counted_from.data(), start.data(), end.data(),
                  with_secants ? secants.data() : nullptr, step, limit},
                 links);
    }
    /// finish() number by number.
    void finish_plainly(bool with_secants) {
        for (int link = 0; link < links; ++link) {
            for (int row = 0; row < size; ++row) {
                const auto q = static_cast<std::size_t>(2 * size * link + row), v = q + static_cast<std::size_t>(size);
                end[v] = *velocity.at(row, 1 + link);
                if (std::is_same_v<Number, float>) end[v] += counted_from[v];
                end[q] = start[q] + 0.5 * step * (start[v] + end[v]);
                if (!with_secants) continue;
                secants[q] = end[v];
                secants[v] = (end[v] - start[v]) / step;
            }
        }
    }
};

template <class Number>
void expect_plain_bits(int order, int links, bool with_secants) {
    Links<Number> plain(links, order);
    plain.finish_plainly(with_secants);
    for (const Isa isa : usable_isas()) {
        Links<Number> own(links, order);
        EXPECT_TRUE(own.finish(isa, order, with_secants)) << "NaN beside the links has no effect";
        for (const auto& [is, expected] : {std::pair{&own.end, &plain.end}, {&own.secants, &plain.secants}}) {
            EXPECT_EQ(std::memcmp(is->data(), expected->data(), is->size() * sizeof(double)), 0)
                << name_of(isa) << ", order " << order << ", " << links << " links";
        }
    }
}

TEST(StepEnd, HasTheBitsOfAPlainLoopForEveryNumberOfLinks) {
    for (int order = 0; order <= 3; ++order) {
        for (int links = 1; links <= 33; ++links) {
            expect_plain_bits<double>(order, links, links % 2 == 0);
            expect_plain_bits<float>(order, links, links % 2 == 0);
        }
    }
}

/// Whether links are sound of which one number is another one.
bool sound_with(Isa isa, int link, bool coordinate, double number) {
    constexpr int order = 3, links = 19;
    Links<double> own(links, order);
    if (coordinate) {
        own.start[static_cast<std::size_t>(2 * own.size * link + 5)] = number;
    } else {
        *own.velocity.at(5, 1 + link) = number;
    }
    return own.finish(isa, order, true);
}

TEST(StepEnd, NoticesEveryNumberThatIsBeyondTheLimitOrNone) {
    const double beyond = std::nextafter(limit, infinity);
    for (const Isa isa : usable_isas()) {
        for (const int link : {0, 7, 18}) {
            for (const double sign : {-1.0, 1.0}) {
                EXPECT_TRUE(sound_with(isa, link, false, sign * limit)) << "the limit itself";
                EXPECT_FALSE(sound_with(isa, link, false, sign * beyond));
                for (const bool coordinate : {false, true}) EXPECT_FALSE(sound_with(isa, link, coordinate, sign * infinity));
                EXPECT_FALSE(sound_with(isa, link, true, sign * 1.1 * limit));
            }
            for (const bool coordinate : {false, true}) {
                EXPECT_FALSE(sound_with(isa, link, coordinate, nan));
                EXPECT_TRUE(sound_with(isa, link, coordinate, 1e-310)) << "denormal";
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
