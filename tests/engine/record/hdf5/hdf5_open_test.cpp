#include "engine/record/hdf5/hdf5_open.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <new>
#include <thread>
#include <vector>

#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine::hdf5 {
namespace {

std::string result(const std::function<void()>& inspection) {
    try {
        inspect_in_child(inspection);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "survived";
}

/// In a child, since trials cannot be disabled again. @return results of all inspections, in one line
std::string results(const std::string& file, const std::vector<std::function<void()>>& inspections, bool second_thread = false) {
    EXPECT_EQ(wait_for(start_child([&] {
                  try_files_first();
                  std::jthread other([&](const std::stop_token& stop) {
                      while (second_thread && !stop.stop_requested()) usleep(1000);
                  });
                  if (!second_thread) other.join();
                  std::ofstream out(file);
                  for (const auto& inspection : inspections) out << result(inspection) << "; ";
                  out.flush();
              })),
              0);
    return read_text_file(file);
}

using Hdf5TrialTest = RecordTest;

TEST_F(Hdf5TrialTest, ReportsTheEndOfTheChild) {
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_EQ(
        results(path("out"), {[] {}, [] { throw std::runtime_error("for the parent to say"); }, [] { std::raise(SIGSEGV); },
                              [] {
                                  while (getpid() != 0) {}
                              },
                              [] { throw std::bad_alloc(); }}),
        "survived; survived; HDF5 crashes on it; HDF5 needs more than 1 s of processor time for it; HDF5 needs more than 1 GiB for it; ");
    EXPECT_GE(std::chrono::steady_clock::now() - begun, std::chrono::milliseconds(990));  // of processor time
}

/// As on a network drive, or after a laptop was suspended.
TEST_F(Hdf5TrialTest, WaitsForStorageThatStalls) {
    EXPECT_EQ(results(path("out"), {[] { usleep(5'500'000); }}), "survived; ");
}

TEST_F(Hdf5TrialTest, IsNotHeldBesideOtherThreads) {
    EXPECT_EQ(results(path("out"), {[] { std::raise(SIGSEGV); }}, true), "survived; ");
}

TEST_F(Hdf5TrialTest, IsNotHeldUnlessAProgramAskedForIt) {
    EXPECT_EQ(result([] { std::raise(SIGSEGV); }), "survived");
}

}  // namespace
}  // namespace cvtflow::engine::hdf5
