/// cvtflow: the command line.

#include "tools/program/command/command.hpp"

int main(int argc, char** argv) {
    using namespace cvtflow::tools;
    return run_program({"cvtflow", "Dynamics of chain-driven continuously variable transmissions", commands(),
                        "  cvtflow list scenes\n"
                        "  cvtflow run baseline\n"
                        "  cvtflow info results/baseline.h5",
                        "cvtflow-lab"},
                       argc, argv);
}
