#include "engine/executor/serial.hpp"

namespace cvtflow::engine {

void Serial::execute(Run& run, int first) { run_serially(run, first); }

}  // namespace cvtflow::engine
