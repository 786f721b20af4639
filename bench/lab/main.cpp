/// cvtflow-lab: the laboratory's command line.

#include "bench/lab/command/command.hpp"

int main(int argc, char** argv) {
    return cvtflow::tools::run_program({"cvtflow-lab", "Measures methods, schedules and runtimes of cvtflow", cvtflow::bench::commands(),
                                        "  cvtflow-lab profile baseline\n"
                                        "  cvtflow-lab compare baseline rk4@50ns leapfrog-chebyshev@auto\n"
                                        "  cvtflow-lab method rk4",
                                        "cvtflow"},
                                       argc, argv);
}
