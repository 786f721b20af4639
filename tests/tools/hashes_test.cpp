/// Bits that must not depend on the processor.

#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

class Hashes : public Program {
protected:
    [[nodiscard]] static std::string hash_in(const std::string& text) {
        const auto at = text.find("state hash");
        return at == std::string::npos ? "none" : text.substr(text.find_first_not_of(' ', at + 10), 16);
    }
};

/// glibc chooses sin, pow and others by the processor; here one without fused operations is played.
TEST_F(Hashes, AreTheSameForEveryVariantOfTheCLibrary) {
    const std::vector<std::string> plain{"GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable"};
    const std::vector<std::vector<std::string>> variants{
        {"--method", "rk4"},
        {"--method", "leapfrog-chebyshev"},
        {"--method", "leapfrog-sweep"},
        {"--method", "dumka3"},
        {"--method", "rkc"},
        {"--method", "rock2-s10"},
        {"--method", "fitted-l100-w1"},
        {"--method", "trapezoidal-analytic", "--set", "joint.law=palmgren"},
        {"--method", "rk4", "--set", "joint.law=palmgren"},
        {"--method", "dopri54", "--tolerance", "1"},
        {"--set", "clamping.driven=5.7 N^0.5*kN^0.5"},
    };
    for (const std::vector<std::string>& more : variants) {
        std::vector<std::string> arguments{"run",     "tiny",
                                           "-o",      "none",
                                           "--until", "20 us",
                                           "--set",   "start.settling_time=20us",
                                           "--set",   "start.ramp_time=10us",
                                           "--set",   "run.schedule=serial"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome one = run(arguments), other = run(arguments, plain);
        EXPECT_NE(hash_in(one.out), "none") << one.err;
        EXPECT_EQ(hash_in(other.out), hash_in(one.out)) << testing::PrintToString(more);
    }
}

}  // namespace
}  // namespace cvtflow::tools
