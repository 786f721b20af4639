#include "engine/executor/reference/serial.hpp"

namespace cvtflow::engine {

void Serial::execute(Run& run, int first) {
    for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) run.tasks(run.graph().topological(cycle), 0);
}

}  // namespace cvtflow::engine
