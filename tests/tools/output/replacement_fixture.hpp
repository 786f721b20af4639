#pragma once
/// Files of every kind, to be put where commands write.

#include <filesystem>
#include <map>
#include <string>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {

/// Options of a run and of settling that take a moment.
inline const Words brief_run{
    "-q", "--until", "40 us", "--step", "50 ns", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"};
inline const Words brief_settle{"settle", "tiny", "-q", "--time", "20us", "--set", "start.ramp_time=10us"};

class Replacement : public Sweeps {
protected:
    /// Makes own.h5 and foreign.h5 (records of tiny and of another scene), state.h5, k.h5 with its checkpoint, first/ (a finished sweep),
    /// cut/ (the shards of another, which is sweep.toml and, with records, recorded.toml), scene.toml, numbers.csv, notes.txt.
    Replacement();

    /// Original of which each of the fourteen kinds is a copy; empty: it is made.
    static const std::map<std::string, std::string>& kinds();
    /// Puts a file of a kind at the target, or at its .part. @return its path
    std::filesystem::path put(const std::string& kind, const std::string& target) const;
    /// Everything below the test's folder: its type and a hash of its contents, by name.
    [[nodiscard]] std::map<std::string, std::string> files() const;
    /// Nothing of what was there is missing or changed.
    void expect_kept(const std::map<std::string, std::string>& before, const std::string& what) const;
    /// Removes what was not there.
    void forget_new(const std::map<std::string, std::string>& before) const;
};

}  // namespace cvtflow::tools
