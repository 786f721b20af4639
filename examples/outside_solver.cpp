// A solver of somebody else's drives our right-hand side: CVODE of SUNDIALS, Adams formulas with functional iteration (the equations are so
// stiff that every explicit step is short, and so smooth within it that no Jacobian is needed). It shares no code with our integrators,
// which makes it an independent check of them: both start from the same state and must agree at the end.
//
//     outside_solver [SCENE [MICROSECONDS [TOLERANCE]]]
//
// Prints the difference between both, relative to the change of the state, and fails if it exceeds the tolerance (1e-6).

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <memory>
#include <string>
#include <vector>

namespace {

/// Ours and CVODE's view of one simulation.
struct System {
    cvtflow::Simulation& simulation;
    std::string error;
};

extern "C" int slope(realtype t, N_Vector x, N_Vector out, void* user) {
    auto& system = *static_cast<System*>(user);
    const std::size_t size = system.simulation.size();
    try {
        system.simulation.rhs(t, {N_VGetArrayPointer(x), size}, {N_VGetArrayPointer(out), size});
        return 0;
    } catch (const cvtflow::Error& error) {
        system.error = error.what();
        return -1;
    }
}

void require(int code, const char* what) {
    if (code >= 0) return;
    std::fprintf(stderr, "outside_solver: %s returned %d\n", what, code);
    std::exit(1);
}

struct Solution {
    std::vector<double> unknowns;
    long steps = 0, evaluations = 0;
};

/// CVODE from the simulation's present state to time `until`; the simulation itself stays where it is.
Solution solve_outside(cvtflow::Simulation& simulation, double until) {
    System system{simulation, ""};
    const std::size_t size = simulation.size();
    Solution solution{{simulation.unknowns().begin(), simulation.unknowns().end()}, 0, 0};
    SUNContext context = nullptr;
    require(SUNContext_Create(nullptr, &context), "SUNContext_Create");
    N_Vector state = N_VMake_Serial(static_cast<sunindextype>(size), solution.unknowns.data(), context);
    void* solver = CVodeCreate(CV_ADAMS, context);
    SUNNonlinearSolver iteration = SUNNonlinSol_FixedPoint(state, 0, context);
    require(CVodeInit(solver, slope, simulation.time(), state), "CVodeInit");
    require(CVodeSStolerances(solver, 1e-10, 1e-13), "CVodeSStolerances");
    require(CVodeSetUserData(solver, &system), "CVodeSetUserData");
    require(CVodeSetNonlinearSolver(solver, iteration), "CVodeSetNonlinearSolver");
    require(CVodeSetMaxNumSteps(solver, 100000000), "CVodeSetMaxNumSteps");
    require(CVodeSetStopTime(solver, until), "CVodeSetStopTime");
    realtype reached = simulation.time();
    require(CVode(solver, until, state, &reached, CV_NORMAL), system.error.empty() ? "CVode" : system.error.c_str());
    CVodeGetNumSteps(solver, &solution.steps);
    CVodeGetNumRhsEvals(solver, &solution.evaluations);
    SUNNonlinSolFree(iteration);
    CVodeFree(&solver);
    N_VDestroy(state);
    SUNContext_Free(&context);
    return solution;
}

/// ‖a - b‖ (Euclidean).
double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum);
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string name = argc > 1 ? argv[1] : "tiny";
    const double span = 1e-6 * (argc > 2 ? std::atof(argv[2]) : 50.0);
    const double tolerance = argc > 3 ? std::atof(argv[3]) : 1e-6;
    std::vector<std::string> settings{"run.method=rk4", "run.step=5 ns", "run.output_interval=1 us", "run.state_interval=1 us",
                                      "detail.friction=smoothed"};
    if (name == "tiny") settings.insert(settings.end(), {"start.settling_time=1 ms", "start.ramp_time=1 ms"});
    const cvtflow::Scene scene = cvtflow::Scene::ready(name).with(settings);

    cvtflow::Simulation simulation(scene);
    simulation.advance_to(0.0);  // settles a geometric start
    const std::vector<double> start(simulation.unknowns().begin(), simulation.unknowns().end());
    const double until = simulation.time() + span;
    const Solution theirs = solve_outside(simulation, until);
    simulation.advance_to(until);
    const std::vector<double> ours(simulation.unknowns().begin(), simulation.unknowns().end());

    const double difference = distance(theirs.unknowns, ours) / distance(ours, start);
    std::printf("%s, %zu unknowns over %.0f us\n", name.c_str(), simulation.size(), 1e6 * span);
    std::printf("  CVODE (Adams)    %8ld steps   %8ld evaluations\n", theirs.steps, theirs.evaluations);
    std::printf("  RK4, 5 ns        %8.0f steps\n", span / simulation.step_length());
    std::printf("  difference       %.3g of the change of the state (limit %.3g)\n", difference, tolerance);
    return difference <= tolerance ? 0 : 1;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "outside_solver: %s\n", error.what());
    return 1;
}
