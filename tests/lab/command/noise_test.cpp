#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench/study/noise/noise.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::HasSubstr;
using testing::StartsWith;

class NoiseCommand : public Program {};

const std::vector<std::string> brief_noise{"noise",        "tiny",
                                           "--detail",     "rigid",
                                           "--random",     "2",
                                           "--candidates", "2",
                                           "--checked",    "1",
                                           "--moves",      "30",
                                           "--set",        "start.settling_time=2 ms",
                                           "--set",        "start.ramp_time=1 ms"};

TEST_F(NoiseCommand, WritesSequencesSpectraAndAScene) {
    const Outcome outcome = run(brief_noise + std::vector<std::string>{"-o", "n"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("--set chain.pitch=[0.00"));
    EXPECT_THAT(read("n/sequences.csv"), StartsWith("sequence,level,status,expected_dB,force_tonality_dB,"));
    EXPECT_THAT(read("n/spectrum.csv"), HasSubstr("uniform"));
    EXPECT_THAT(read("n/noise.svg"), HasSubstr("Torque of the chain on the shafts"));
    const nlohmann::json json = nlohmann::json::parse(read("n/noise.json"));
    std::size_t checked = 0;
    for (const auto& each : json.at("simulations")) {
        const auto steps = each.at("steps").get<std::vector<int>>();
        EXPECT_EQ(steps.size(), 24u);
        EXPECT_EQ(std::accumulate(steps.begin(), steps.end(), 0), 0) << "as long as the uniform chain";
        if (each.at("name") == "uniform") ++checked;
    }
    EXPECT_EQ(checked, 2u) << "uniform at rigid and in the check";
    const tasks::Scene quiet = tasks::read_scene(folder_ / "n/quiet.toml");
    EXPECT_NEAR(model::chain_length(quiet.parameters.chain), 24 * 8.12e-3, 1e-9);
    EXPECT_EQ(
        run({"run", "n/quiet.toml", "--set", "start.settling_time=0.2 ms", "--set", "start.ramp_time=0.1 ms", "--until", "50 us"}).status,
        0);
}

TEST_F(NoiseCommand, RepeatsItself) {
    ASSERT_EQ(run(brief_noise + std::vector<std::string>{"--csv", "-o", "one"}).status, 0);
    ASSERT_EQ(run(brief_noise + std::vector<std::string>{"--csv", "-o", "two", "--threads", "2"}).status, 0);
    EXPECT_EQ(read("one/sequences.csv"), read("two/sequences.csv"));
    ASSERT_EQ(run(brief_noise + std::vector<std::string>{"--csv", "-o", "two", "--seed", "2"}).status, 0);
    EXPECT_NE(read("one/sequences.csv"), read("two/sequences.csv"));
}

TEST_F(NoiseCommand, RefusesMachinesItCannotMix) {
    EXPECT_THAT(run({"noise", "free_ring"}).err, HasSubstr("free_ring has no pulleys"));
    const Outcome odd = run({"noise", "tiny", "--set", "chain.pins=25"});
    EXPECT_NE(odd.status, 0);
    EXPECT_THAT(odd.err, HasSubstr("even number of pins"));
    const Outcome narrow = run({"noise", "tiny", "--random", "1", "--set", "half.width=6 mm", "--spread", "0.3"});
    EXPECT_EQ(narrow.status, 2);
    EXPECT_THAT(narrow.err, HasSubstr("chain.pitch"));
}

/// The strongest line of a uniform chain is the passing of its pins, and the chain turns at its speed over its length.
TEST(MeasuredNoise, AUniformChainSoundsWherePinsPass) {
    tasks::Scene scene = tasks::read_scene(tasks::find_scene("tiny"));
    tasks::set_values(scene, std::vector<std::string>{"run.method=auto"});
    tasks::apply_detail(scene, "rigid");
    scene.state_file.clear();
    const NoiseSpectrum spectrum = measure_noise(scene, 2, engine::Cancellation());
    ASSERT_TRUE(spectrum.usable()) << spectrum.fault;
    const auto strongest = std::max_element(spectrum.torque.begin() + 12, spectrum.torque.end()) - spectrum.torque.begin();
    EXPECT_EQ(strongest % 24, 0);
    // The radius at ratio 1; pins sink between elastic sheaves by some tenths of a millimetre.
    const double speed = scene.parameters.drive.speed.at(0.0) * 16.06e-3;
    EXPECT_NEAR(spectrum.round, speed / (24 * 8.12e-3), 0.03 * spectrum.round);
}

/// Known of chains with mixed pitches: random sequences of two lengths lower the passing of pins by about 8 dB. The closed form does so in
/// the mean of many sequences whose pitches differ by 9.5 % from their mean; the mean of 2,000 scatters by 0.1 dB. The torque of the
/// simulated chain follows the closed form, by the same sequences, within 1 dB: an impulse depends on the pitches beside it, too.
TEST(MeasuredNoise, RandomPitchesLowerThePassingOfPinsAsImpulsesDo) {
    tasks::Scene scene = tasks::read_scene(tasks::find_scene("baseline"));
    tasks::apply_detail(scene, "rigid");
    tasks::set_values(scene, std::vector<std::string>{"start.state=", "start.settling_time=20 ms", "run.method=auto"});
    const PitchSearch search(84, 2, 0.08, 16.7);
    double many = 0.0, few = 0.0, simulated = 0.0;
    for (int k = 1; k <= 2000; ++k) {
        std::mt19937_64 urn(static_cast<std::uint64_t>(k));
        many += impulse_powers(search.random(urn), 0.095, 84)[84] / 2000.0;
    }
    EXPECT_NEAR(10.0 * std::log10(many), -8.0, 0.5);
    double uniform = 0.0;
    for (int k = 0; k <= 6; ++k) {
        std::mt19937_64 urn(static_cast<std::uint64_t>(k));
        const PitchSequence sequence = k == 0 ? PitchSequence(84, 0) : search.random(urn);
        scene.parameters.chain.pitch = pitches_of(sequence, 8.12e-3, 0.08);
        const NoiseSpectrum spectrum = measure_noise(scene, 1, engine::Cancellation());
        ASSERT_TRUE(spectrum.usable()) << spectrum.fault;
        if (k == 0) {
            uniform = spectrum.torque[84];
            continue;
        }
        few += impulse_powers(sequence, 0.08, 84)[84];
        simulated += spectrum.torque[84] / uniform;
    }
    EXPECT_NEAR(10.0 * std::log10(simulated), 10.0 * std::log10(few), 1.0) << "sums over six sequences";
}

}  // namespace
}  // namespace cvtflow::bench
