/// Any text is a sweep or a SceneError.

#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/method/method.hpp"
#include "tests/fuzz/fuzz_fixture.hpp"

/// The catalogue of methods takes seconds here, once: no input's fault.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    static_cast<void>(cvtflow::tasks::method_names());
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const cvtflow::fuzz::MemoryFile file(bytes, size);
    try {
        static_cast<void>(cvtflow::tasks::read_sweep(
            file.path(), [](const std::string&) { return std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml"; }));
    } catch (const cvtflow::tasks::SceneError&) {}
    return 0;
}
