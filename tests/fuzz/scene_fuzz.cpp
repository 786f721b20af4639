/// Any text is a scene or a SceneError; a scene that was read is written so that it is read back the same.

#include <cstdlib>

#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/fuzz/fuzz_fixture.hpp"

/// The catalogue of methods takes seconds here, once: no input's fault.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    static_cast<void>(cvtflow::tasks::method_names());
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace cvtflow::tasks;
    std::string text;
    try {
        text = write_scene(parse_scene(std::string(cvtflow::fuzz::text_of(bytes, size)), "scene.toml", StartState::ignored));
    } catch (const SceneError&) {
        return 0;
    }
    if (write_scene(parse_scene(text, "written.toml", StartState::ignored)) != text) std::abort();
    return 0;
}
