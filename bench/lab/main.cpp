/// cvtflow-lab: the laboratory's command line.

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "bench/staged/staged_assembly.hpp"

int main(int argc, char** argv) {
    cvtflow::bench::add_further_executors();
    cvtflow::bench::add_laboratory_methods();
    cvtflow::bench::add_staged_assembly();
    return cvtflow::tools::run_program({"cvtflow-lab", "Measures methods, schedules and runtimes of cvtflow", cvtflow::bench::commands(),
                                        "  cvtflow-lab profile baseline\n"
                                        "  cvtflow-lab compare baseline rk4@50ns leapfrog-chebyshev@auto\n"
                                        "  cvtflow-lab method rk4",
                                        "cvtflow"},
                                       argc, argv);
}
