/// Any text is an axis of cases or a list of problems.

#include <cstdlib>

#include "tasks/batch/sweep/axis.hpp"
#include "tests/fuzz/fuzz_fixture.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const cvtflow::fuzz::MemoryFile file(bytes, size);
    std::vector<cvtflow::tasks::Problem> problems;
    const cvtflow::tasks::Axis axis = cvtflow::tasks::read_csv_axis(file.path(), {}, {}, problems);
    if (problems.empty() == axis.keys.empty()) std::abort();  // either, or
    return 0;
}
