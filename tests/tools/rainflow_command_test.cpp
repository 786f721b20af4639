/// `cvtflow table RECORD --rainflow CHANNEL`.

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/rainflow.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

class RainflowOfARecord : public Program {
protected:
    RainflowOfARecord() {
        made_ =
            run_briefly({"-q", "-o", "run.h5", "--set", "record.channels=followed_pin/*", "--set", "run.output_interval=200 ns"}).status;
    }
    int made_ = -1;
};

TEST_F(RainflowOfARecord, IsThatOfItsChannel) {
    ASSERT_EQ(made_, 0);
    const engine::RunReader record((folder_ / "run.h5").string());
    const auto values = record.channel("followed_pin/half_axial_force");
    std::vector<double> history;
    for (std::size_t row = 0; row < record.rows(); ++row) history.push_back(values[2 * row + 1]);
    const auto cycles = engine::rainflow(history);
    ASSERT_FALSE(cycles.empty());
    const Outcome json = run({"table", "run.h5", "--rainflow", "followed_pin/half_axial_force[1]", "--json"});
    ASSERT_EQ(json.status, 0) << json.err;
    const auto load = nlohmann::json::parse(json.out).at("loads").at(0);
    EXPECT_EQ(load.at("unit"), "N");
    ASSERT_EQ(load.at("cycles").size(), cycles.size());
    for (std::size_t k = 0; k < cycles.size(); ++k) EXPECT_EQ(load.at("cycles").at(k).at("range"), cycles[k].range);
    double counted = 0.0;
    for (const auto& each : load.at("classes")) counted += each.at("count").get<double>();
    double all = 0.0;
    for (const auto& cycle : cycles) all += cycle.count;
    EXPECT_EQ(counted, all);
}

TEST_F(RainflowOfARecord, HasATextATableAndAWindow) {
    ASSERT_EQ(made_, 0);
    const Outcome text = run({"table", "run.h5", "--rainflow", "followed_pin/plate_tension[*]", "--classes", "4"});
    EXPECT_EQ(text.status, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("followed_pin/plate_tension[0]: rainflow counts (ASTM E1049) of 101 outputs from 0 s to 20 us\n"));
    const Outcome csv = run({"table", "run.h5", "--rainflow", "tight_tension", "--rainflow", "slip", "--csv"});
    EXPECT_THAT(csv.out, testing::StartsWith("load,unit,range,mean,cycles,from_time,to_time\ntight_tension,N,"));
    EXPECT_THAT(csv.out, HasSubstr("\nslip,1,"));
    const Outcome window = run({"table", "run.h5", "--rainflow", "tight_tension", "--from", "4.9 us", "--until", "1.01e-5"});
    EXPECT_THAT(window.out, HasSubstr("of 26 outputs from 5 us to 10 us"));
    EXPECT_THAT(run({"table", "run.h5", "--rainflow", "tight_tension", "--from", "1 s"}).out, HasSubstr("no outputs\n  no cycles\n"));
}

TEST_F(RainflowOfARecord, HasADamageEquivalentRangeAndReportsThatTheRecordIsShort) {
    ASSERT_EQ(made_, 0);
    const Outcome json = run({"table", "run.h5", "--rainflow", "tight_tension", "--exponent", "3", "--json"});
    ASSERT_EQ(json.status, 0) << json.err;
    const auto load = nlohmann::json::parse(json.out).at("loads").at(0);
    double sum = 0.0;
    for (const auto& cycle : load.at("cycles")) sum += cycle.at("count").get<double>() * std::pow(cycle.at("range").get<double>(), 3.0);
    EXPECT_NEAR(load.at("damage_equivalent").at("range").get<double>(), std::cbrt(sum), 1e-9 * std::cbrt(sum)) << "once in the record";
    EXPECT_EQ(load.at("damage_equivalent").at("reference_cycles"), 1.0);
    const Outcome text = run({"table", "run.h5", "--rainflow", "tight_tension"});
    EXPECT_THAT(text.out, HasSubstr(" kN (exponent 5, one cycle in the record)\n"));
    EXPECT_THAT(text.out, HasSubstr("of a round of the chain (")) << "20 us of 58 ms";
    EXPECT_EQ(run({"table", "run.h5", "--rainflow", "tight_tension", "--exponent", "0"}).status, 2);
}

TEST_F(RainflowOfARecord, ReportsWhatItCannotCount) {
    ASSERT_EQ(made_, 0);
    const auto expect = [&](const std::vector<std::string>& more, int status, const std::string& why) {
        const Outcome outcome = run(std::vector<std::string>{"table", "run.h5"} + more);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(why));
        EXPECT_EQ(outcome.out, "");
    };
    expect({"--rainflow", "tight_tensoin"}, 2, "the record has no such channel (did you mean \"tight_tension\"?)");
    expect({"--rainflow", "tips/normal_force[0]"}, 2, "without this channel (record it with --set record.channels=tips/normal_force)");
    expect({"--rainflow", "followed_pin/position"}, 2, "it has 3 numbers; write followed_pin/position[0] ... followed_pin/position[2]");
    expect({"--rainflow", "followed_pin/position[3]"}, 2, "elements are numbered 0 to 2");
    expect({"--rainflow", "followed_pin/position[x]"}, 2, "elements are numbered 0 to 2");
    expect({"--rainflow", "slip", "--json", "--csv"}, 2, "--csv or --json, not both");
    expect({"--rainflow", "slip", "--status", "ok"}, 2, "--column and --status apply to sweeps");
    expect({"--rainflow", "slip", "--from", "3 kg"}, 2, "--from 3 kg: not a time");
    expect({"--json"}, 2, "require --rainflow");
    EXPECT_EQ(run({"table", "none.h5", "--rainflow", "slip"}).status, 1);
}

}  // namespace
}  // namespace cvtflow::tools
