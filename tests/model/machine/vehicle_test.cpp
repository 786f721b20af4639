#include "model/machine/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace cvtflow::model {
namespace {

Vehicle car() {
    Vehicle v;
    v.mass = 1500.0, v.wheel_inertia = 4.5, v.efficiency = 0.95;
    return v;
}

Cycle cycle_of(std::vector<double> time, std::vector<double> speed) {
    Cycle c;
    c.speed = TimeTable(std::move(time), std::move(speed));
    return c;
}

double of(const TripSums& sums, TripAccount account) { return sums[static_cast<std::size_t>(account)]; }

double parts(const TripSums& sums) {
    using enum TripAccount;
    double sum = 0.0;
    for (const TripAccount account : {kinetic, climb, air, rolling, brakes, clutch, final_drive}) sum += of(sums, account);
    return sum;
}

TEST(Vehicle, LoadsShaftTwoByItsInertiaWeightAndDrag) {
    Vehicle v = car();
    v.grade = TimeTable({0.0, 1.0}, {0.0, 0.75});  // 3, 4, 5: sine 0.6, cosine 0.8
    Load load;
    load_by(v, load);
    const double lever = 0.3 / 5.5, weight = 1500.0 * 9.81;
    EXPECT_DOUBLE_EQ(load.inertia, (1500.0 + 4.5 / 0.09) * lever * lever);
    EXPECT_DOUBLE_EQ(load.quadratic, 0.5 * 1.2 * 0.62 * lever * lever * lever);
    EXPECT_EQ(load.torque.time, v.grade.time);
    EXPECT_NEAR(load.torque.value[0], weight * 0.012 * lever, 1e-12);
    EXPECT_NEAR(load.torque.value[1], weight * (0.012 * 0.8 + 0.6) * lever, 1e-10);
}

/// The midpoint rule with 20 parts per pedal time: air (a cubic) to 1e-6 of it, all others exactly.
TEST(Trip, EnergiesOfAConstantAccelerationAreThoseOfTheClosedForm) {
    using enum TripAccount;
    const double v0 = 8.0, v1 = 14.0, a = 1.5, mass = 1550.0, weight = 1500.0 * 9.81;
    Vehicle v = car();
    v.grade = TimeTable(0.05);
    const TripSums sums = Trip(v, cycle_of({0.0, 4.0}, {v0, v1})).sums(4.0);
    const double way = 0.5 * (v0 + v1) * 4.0, norm = std::sqrt(1.0 + 0.05 * 0.05);
    const double kinetic_gained = 0.5 * mass * (v1 * v1 - v0 * v0),
                 drag = 0.5 * 1.2 * 0.62 * (std::pow(v1, 4) - std::pow(v0, 4)) / (4.0 * a);
    EXPECT_NEAR(of(sums, distance), way, 1e-9);
    EXPECT_NEAR(of(sums, kinetic), kinetic_gained, 1e-9 * kinetic_gained);
    EXPECT_NEAR(of(sums, rolling), weight * 0.012 / norm * way, 1e-6);
    EXPECT_NEAR(of(sums, climb), weight * 0.05 / norm * way, 1e-6);
    EXPECT_NEAR(of(sums, air), drag, 1e-5 * drag);
    const double traction_work = kinetic_gained + of(sums, rolling) + of(sums, climb) + of(sums, air);
    EXPECT_NEAR(of(sums, traction), traction_work, 1e-9 * traction_work) << "kinetic energy and road load";
    EXPECT_NEAR(of(sums, shaft), traction_work / 0.95, 1e-9 * traction_work);
    EXPECT_NEAR(of(sums, final_drive), traction_work * (1.0 / 0.95 - 1.0), 1e-9 * traction_work);
    EXPECT_NEAR(of(sums, brakes), 0.0, 1e-9 * traction_work);
    EXPECT_EQ(of(sums, clutch), 0.0);
}

/// Shaft 2 turns at idle_speed/max_ratio until the vehicle reaches this speed; the clutch loses torque times difference of speeds.
TEST(Trip, AStartingClutchSlipsWhereTheEngineWouldTurnBelowItsIdlingSpeed) {
    Vehicle v = car();
    v.drag_area = v.rolling_resistance = 0.0, v.efficiency = 1.0;
    const Cycle c = cycle_of({0.0, 10.0}, {0.0, 10.0});  // 1 m/s2
    const double launch = c.idle_speed / c.max_ratio, closes = launch * v.lever(), torque = 1550.0 * v.lever();
    const TripSums sums = Trip(v, c).sums(10.0);
    EXPECT_NEAR(of(sums, TripAccount::clutch), torque * 0.5 * launch * closes, 0.01 * torque * launch * closes) << "a triangle";
    EXPECT_NEAR(of(sums, TripAccount::shaft), 0.5 * 1550.0 * 100.0 + of(sums, TripAccount::clutch), 1.0);
}

TEST(Trip, BrakesTakeWhatTheEngineDoesNot) {
    Vehicle v = car();
    v.drag_area = v.rolling_resistance = 0.0;
    Cycle c = cycle_of({0.0, 2.0}, {14.0, 12.0});
    c.engine_speed = {{0.0}, {160.0}};
    Parameters p;
    const Trip trip(v, c);
    trip.command(p);
    for (std::size_t k = 0; k < p.load.torque.value.size(); ++k)
        EXPECT_NEAR(p.load.torque.value[k], -15.0 * p.control.ratio.value[k], 1e-9) << "shaft 2 feels the drag of shaft 1";
    const TripSums sums = trip.sums(2.0);
    EXPECT_EQ(of(sums, TripAccount::traction), 0.0);
    EXPECT_NEAR(-of(sums, TripAccount::shaft), 15.0 * 160.0 * 2.0, 1e-6);
    EXPECT_NEAR(of(sums, TripAccount::brakes), 0.5 * 1550.0 * (196.0 - 144.0) - 15.0 * 160.0 * 2.0 / 0.95, 1e-6);
}

TEST(Trip, TablesKeepTheEngineAtItsTargetAsFarAsTheRatioGoes) {
    Cycle c = cycle_of({0.0, 30.0}, {0.0, 30.0});
    c.engine_speed = {{0.0, 20.0}, {140.0, 180.0}};
    Parameters p;
    const Trip trip(car(), c);
    trip.command(p);
    ASSERT_EQ(static_cast<int>(p.drive.speed.time.size()), trip.points());
    EXPECT_NEAR(p.drive.speed.value.front(), c.idle_speed, 1e-9) << "it stands";
    EXPECT_EQ(p.start.ratio, p.control.ratio.value.front());
    EXPECT_NEAR(p.control.ratio.value.front(), 2.2, 1e-12);
    EXPECT_NEAR(p.drive.speed.at(10.0), 160.0, 1e-6);
    EXPECT_NEAR(p.control.ratio.at(10.0), 160.0 * 0.3 / 5.5 / 10.0, 1e-3) << "a mean over the pedal time";
    EXPECT_NEAR(p.control.ratio.at(29.0), 0.6, 1e-12);
    EXPECT_NEAR(p.drive.speed.at(29.0), 0.6 * 29.0 * 5.5 / 0.3, 1e-6) << "the ratio ends: the engine turns with the wheels";
}

TEST(Trip, AccountsCloseAndContinueFromAnyTimeOfTheCycle) {
    const Cycle whole = cycle_of({0.0, 3.0, 8.0, 20.0, 27.0, 30.0}, {0.0, 0.0, 9.0, 9.0, 0.0, 0.0});
    Cycle later = whole;
    later.begin = 6.0;
    const Trip all(car(), whole), rest(car(), later);
    for (const double t : {0.3, 4.1, 7.77, 15.0, 26.0, 30.0, 33.0}) {
        const TripSums sums = all.sums(t);
        EXPECT_NEAR(of(sums, TripAccount::shaft), parts(sums), 1e-9 * (1.0 + std::abs(parts(sums)))) << t;
        EXPECT_GE(of(sums, TripAccount::brakes), -1e-6);
    }
    const TripSums end = all.sums(30.0), begin = all.sums(6.0), gained = rest.sums(24.0);
    for (std::size_t account = 0; account < end.size(); ++account)
        EXPECT_NEAR(gained[account], end[account] - begin[account], 1e-9 * (1.0 + std::abs(end[account]))) << account;
    EXPECT_NEAR(of(end, TripAccount::kinetic), 0.0, 1.0) << "it stands again";
    EXPECT_EQ(rest.speed(0.0), whole.speed.at(6.0));
}

TEST(Trip, WithoutVehicleOrCycleIsEmpty) {
    EXPECT_EQ(Trip(Vehicle{}, cycle_of({0.0, 1.0}, {1.0, 2.0})).sums(1.0), TripSums{});
    EXPECT_EQ(Trip(car(), Cycle{}).sums(1.0), TripSums{});
    EXPECT_EQ(Trip().sums(1.0), TripSums{});
}

}  // namespace
}  // namespace cvtflow::model
