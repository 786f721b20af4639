/// Friction in single precision: the same friction as in double precision but for rounding, and the same bits however it is computed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/friction_operator.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// A random state, and velocities as far from its own as those of a step's stages are.
class SingleRig {
public:
    SingleRig(const Parameters& p, std::uint64_t seed, Isa isa = chosen_isa())
        : parameters_(p),
          random_(oracle::random_state(p, seed)),
          variator_(p, isa),
          scratch_(variator_.layout()),
          start_(random_.state),
          friction_(make_friction(variator_.chain(), p.detail.stick_slip)),
          field_(variator_.chain()),
          single_field_(variator_.chain()) {
        fill_window(variator_, random_.state.data(), scratch_);
        if (at().pulley_size != 0) variator_.pulleys().motions(random_.state.data() + at().pulley_begin(), scratch_.sheaves);
        const int columns_wanted = at().links + 2 * at().halo();
        for (Columns* columns : {&frictionless_, &velocity_, &slope_}) *columns = Columns(size(), columns_wanted);
        for (auto* columns : {&single_push_, &single_velocity_, &single_slope_}) *columns = ColumnsOf<float>(size(), columns_wanted);
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) {
                double& v = start_[static_cast<std::size_t>(at().link_begin(link) + size() + row)];
                v += 1e-3 * std::sin(1.0 + row + 2.4 * link) * std::abs(v);
            }
        }
    }

    void in_double() {
        friction_.record(range(0, at().links), {}, field_, frictionless_, scratch_.loads.data());
        for (int link = -at().halo(); link < at().links + at().halo(); ++link) {
            const double* v = start_.data() + at().link_begin(at().wrapped(link)) + size();
            for (int row = 0; row < size(); ++row) *velocity_.at(row, link + 1) = v[row];
        }
        std::vector<double> memory(static_cast<std::size_t>(friction_.scratch_size(at().links)));
        friction_.slopes(field_, {0, at().links, velocity_.at(0, 0), velocity_.stride(), memory.data(), random_.phases.data(), 0.25},
                         {nullptr, &slope_});
    }
    /// @param length of ranges
    void in_single(int length) {
        for (int first = 0; first < at().links; first += length) {
            const SinglePrecisionRecord start{start_.data() + at().link_begin(first), single_field_, single_push_, single_velocity_};
            friction_.record(range(first, std::min(first + length, at().links)), {}, start, scratch_.loads.data() + first);
        }
        for (int row = 0; row < size(); ++row) {
            for (int ghost = 0; ghost < at().halo(); ++ghost) {
                *single_velocity_.at(row, -ghost) = *single_velocity_.at(row, at().links - ghost);
                *single_velocity_.at(row, at().links + 1 + ghost) = *single_velocity_.at(row, 1 + ghost);
            }
        }
        for (int first = 0; first < at().links; first += length) {
            const int last = std::min(first + length, at().links);
            std::vector<float> memory(static_cast<std::size_t>(friction_.scratch_size<float>(last - first)));
            friction_.slopes(
                single_field_,
                {first, last, single_velocity_.at(0, first), single_velocity_.stride(), memory.data(), random_.phases.data(), 0.25},
                {nullptr, &single_slope_});
        }
    }

    [[nodiscard]] std::vector<double> slopes() const { return listed(slope_); }
    [[nodiscard]] std::vector<double> single_slopes() const { return listed(single_slope_); }
    [[nodiscard]] std::vector<double> forces() const { return listed(frictionless_); }
    [[nodiscard]] std::vector<double> single_forces() const { return listed(single_push_); }
    [[nodiscard]] const ColumnsOf<float>& single_slope() const { return single_slope_; }
    [[nodiscard]] const ChainLayout& at() const { return variator_.layout(); }

private:
    [[nodiscard]] int size() const { return at().link_size(); }
    [[nodiscard]] ChainRange range(int first, int last) const {
        return {first, last, scratch_.window.data() + first * at().link_block(), scratch_.sheaves, random_.phases.data()};
    }
    template <class Number>
    [[nodiscard]] std::vector<double> listed(const ColumnsOf<Number>& columns) const {
        std::vector<double> all;
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) all.push_back(*columns.at(row, link + 1));
        }
        return all;
    }

    Parameters parameters_;
    oracle::RandomState random_;
    Variator variator_;
    EvaluationScratch scratch_;
    std::vector<double> start_;
    FrictionOperator friction_;
    ContactField field_;
    ContactFieldOf<float> single_field_;
    Columns frictionless_, velocity_, slope_;
    ColumnsOf<float> single_push_, single_velocity_, single_slope_;
};

double largest_of(const std::vector<double>& numbers) {
    double largest = 0.0;
    for (const double x : numbers) largest = std::max(largest, std::abs(x));
    return largest;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
}

std::vector<oracle::Case> cases() {
    std::vector<oracle::Case> cases;
    for (int order = 0; order <= 3; ++order) {
        for (const bool stick_slip : {false, true}) {
            for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
                Parameters p = oracle::small_scene();
                p.detail.order = order;
                p.detail.stick_slip = stick_slip;
                p.detail.friction = law;
                p.detail.joint_points = order == 1 ? 8 : 3;
                cases.push_back({"order " + std::to_string(order) + (stick_slip ? " stick and slip " : " ") +
                                     (law == FrictionLaw::smoothed ? "smoothed" : ""),
                                 p});
            }
        }
    }
    cases.push_back({"the baseline, longer than what is computed together", Parameters{}});
    return cases;
}

/// A float has 6e-8 of itself; forces of the contacts of a link, some of which cancel, are added up: 2e-6 of the largest.
TEST(SingleKernels, GiveFrictionAndAllOtherForcesButForRounding) {
    std::uint64_t seed = 500;
    for (const oracle::Case& one : cases()) {
        SingleRig rig(one.parameters, ++seed);
        rig.in_double();
        rig.in_single(rig.at().links);
        ASSERT_GT(largest_of(rig.slopes()), 0.0);
        EXPECT_LT(largest_difference(rig.single_slopes(), rig.slopes()), 2e-6 * largest_of(rig.slopes())) << one.name;
        EXPECT_LT(largest_difference(rig.single_forces(), rig.forces()), 1e-7 * largest_of(rig.forces())) << one.name;
    }
}

TEST(SingleKernels, GiveTheSameBitsForRangesOfAnyLengthAndEveryInstructionSet) {
    std::uint64_t seed = 600;
    for (const oracle::Case& one : cases()) {
        SingleRig whole(one.parameters, ++seed);
        whole.in_single(whole.at().links);
        for (const int length : {1, 2, 3, 5, 8, 11}) {
            SingleRig cut(one.parameters, seed);
            cut.in_single(length);
            EXPECT_EQ(cut.single_slopes(), whole.single_slopes()) << one.name << ", ranges of " << length;
            EXPECT_EQ(cut.single_forces(), whole.single_forces()) << one.name << ", ranges of " << length;
        }
        for (const Isa isa : usable_isas()) {
            SingleRig other(one.parameters, seed, isa);
            other.in_single(other.at().links);
            EXPECT_EQ(other.single_slopes(), whole.single_slopes()) << one.name << ", " << name_of(isa);
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
