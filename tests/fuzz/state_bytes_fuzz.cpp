/// Any bytes are a state or an Error, also if mark and checksum are right; an integration accepts or refuses a state of this size. The
/// input is the part between mark and checksum.

#include <cvtflow/error.hpp>

#include "api/host/state_bytes.hpp"
#include "engine/base/hash.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/fuzz/fuzz_fixture.hpp"

namespace {

using namespace cvtflow;

tasks::Scene scene() {
    tasks::Scene tiny = tasks::read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    tiny.run.schedule = "serial";
    tiny.run.max_steps = 3;
    return tiny;
}

void resume(const tasks::IntegrationState& from) {
    static tasks::Simulation simulation(scene());
    const engine::Cancellation never;
    tasks::SilentObserver silent;
    try {
        simulation.restore(from);
        static_cast<void>(simulation.advance({.until = from.time + 1e-6, .steps = 3}, silent, never));
    } catch (const tasks::SimulationError&) {
    } catch (const std::invalid_argument&) {  // what the method remembers is none
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    std::vector<std::byte> framed;
    for (const char letter : std::string_view("CVTFLOW6")) framed.push_back(static_cast<std::byte>(letter));
    const auto* begin = reinterpret_cast<const std::byte*>(bytes);
    framed.insert(framed.end(), begin, begin + size);
    const std::uint64_t sum = engine::Checksum().add(std::span<const std::byte>(framed)).value();
    const auto* tail = reinterpret_cast<const std::byte*>(&sum);
    framed.insert(framed.end(), tail, tail + sizeof sum);
    try {
        resume(api::read_state_bytes(framed).integration);
    } catch (const Error&) {}
    return 0;
}
