#include "bench/peers/solvers.hpp"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

namespace cvtflow::bench {

using bench::Near;
using bench::With;

Problem::Problem(const tasks::Scene& scene, tasks::FrozenStart start, double duration, double interval)
    : variator_(scene.parameters),
      start_(std::move(start)),
      interval_(interval),
      outputs_(static_cast<int>(std::lround(duration / interval))),
      scratch_(variator_.layout()),
      observer_(variator_),
      exact_(variator_),
      blocks_(variator_.layout()) {
    make_pattern();
}

void Problem::slope(double t, const double* state, double* slope) noexcept {
    model::right_hand_side(variator_, t, state, start_.phases.data(), slope, scratch_);
    ++evaluations_;
}

template <class Visit>
void Problem::visit_entries(Visit&& visit) const {
    const model::ChainLayout& at = variator_.layout();
    const int coordinates = at.link_size(), pulleys = at.pulley_size, border = blocks_.border();
    // The place of an unknown of the border: with its rates, the control's integral behind them.
    const auto border_at = [&](int k, With with) {
        return k < pulleys ? at.pulley_begin() + (with == With::velocity ? pulleys : 0) + k : at.control_begin();
    };
    const auto block = [&](int rows, const auto& row_at, int columns, const auto& column_at, const double* values) {
        for (int i = 0; i < rows; ++i) {
            for (int k = 0; k < columns; ++k) visit(row_at(i), column_at(k), values[i * columns + k]);
        }
    };
    const auto accelerations_of_border = [&](int k) { return border_at(k, With::velocity); };
    for (int link = 0; link < at.links; ++link) {
        const auto rows = [&](int i) { return at.link_begin(link) + coordinates + i; };
        for (int i = 0; i < coordinates; ++i) visit(at.link_begin(link) + i, rows(i), 1.0);
        for (const With with : {With::position, With::velocity}) {
            const int shift = with == With::velocity ? coordinates : 0;
            for (const auto& [near, other] : {std::pair{Near::before, at.previous(link)}, {Near::same, link}, {Near::after, at.next(link)}})
                block(
                    coordinates, rows, coordinates, [&, begin = at.link_begin(other) + shift](int k) { return begin + k; },
                    blocks_.link(link, near, with));
            block(
                coordinates, rows, border, [&](int k) { return border_at(k, with); }, blocks_.columns(link, with));
            block(
                border, accelerations_of_border, coordinates, [&](int k) { return at.link_begin(link) + shift + k; },
                blocks_.rows(link, with));
        }
    }
    for (int k = 0; k < pulleys; ++k) visit(at.pulley_begin() + k, at.pulley_begin() + pulleys + k, 1.0);
    for (const With with : {With::position, With::velocity})
        block(
            border, accelerations_of_border, border, [&](int k) { return border_at(k, with); }, blocks_.corner(with));
    for (int k = 0; k < at.size(); ++k) visit(k, k, 0.0);  // I - γJ has a diagonal
}

void Problem::make_pattern() {
    std::vector<std::set<int>> columns(static_cast<std::size_t>(size()));
    visit_entries([&](int row, int column, double) { columns[static_cast<std::size_t>(column)].insert(row); });
    std::map<std::pair<int, int>, int> place;
    for (int column = 0; column < size(); ++column) {
        pattern_.begin.push_back(static_cast<int>(pattern_.row.size()));
        for (const int row : columns[static_cast<std::size_t>(column)]) {
            place[{row, column}] = static_cast<int>(pattern_.row.size());
            pattern_.row.push_back(row);
        }
    }
    pattern_.begin.push_back(static_cast<int>(pattern_.row.size()));
    visit_entries([&](int row, int column, double) { place_.push_back(place.at({row, column})); });
}

void Problem::jacobian(double t, const double* state, double* values) noexcept {
    exact_.links(state, start_.phases.data(), 0, variator_.layout().links, blocks_);
    exact_.corner(t, state, start_.phases.data(), blocks_);
    std::fill_n(values, pattern_.row.size(), 0.0);
    const int* place = place_.data();
    visit_entries([&](int, int, double value) { values[*place++] += value; });
}

bool Problem::is_rate(int unknown) const noexcept {
    const model::ChainLayout& at = variator_.layout();
    if (unknown < at.pulley_begin()) return unknown % at.link_block() >= at.link_size();
    return unknown >= at.pulley_begin() + at.pulley_size && unknown < at.control_begin();
}

std::vector<double> Problem::sizes() const {
    const int coordinates_end = variator_.layout().control_begin();
    std::vector<double> sizes(static_cast<std::size_t>(size()), 1.0);
    for (int k = 0; k < coordinates_end; ++k) sizes[static_cast<std::size_t>(k)] = is_rate(k) ? 1e-2 : 1e-6;
    return sizes;
}

void Problem::observe(double t, const double* state, Trajectory& trajectory) {
    const model::Observation& seen = observer_.observe(t, state, start_.phases.data());
    trajectory.times.push_back(t);
    trajectory.axial_force.push_back(seen.tip_axial);
    trajectory.tension.push_back(seen.tension);
}

namespace {

constexpr long most_steps = 100'000'000;
constexpr double max_seconds = 20.0;  // [s] of one run

/// Members of all solvers: a context, the state, tolerances, and a matrix with its solver.
class Common {
public:
    explicit Common(Problem& problem, double tolerance) : problem_(problem), relative_(tolerance) {
        SUNContext_Create(nullptr, &context);
        state = N_VNew_Serial(problem.size(), context);
        absolute = N_VNew_Serial(problem.size(), context);
        std::copy(problem.start().state.begin(), problem.start().state.end(), N_VGetArrayPointer(state));
        const std::vector<double> sizes = problem.sizes();
        for (std::size_t k = 0; k < sizes.size(); ++k) N_VGetArrayPointer(absolute)[k] = tolerance * sizes[k];
    }
    ~Common() {
        if (solver != nullptr) SUNLinSolFree(solver);
        if (matrix != nullptr) SUNMatDestroy(matrix);
        N_VDestroy(absolute);
        N_VDestroy(state);
        SUNContext_Free(&context);
    }
    Common(const Common&) = delete;
    Common& operator=(const Common&) = delete;

    void make_matrix() {
        matrix =
            SUNSparseMatrix(problem_.size(), problem_.size(), static_cast<sunindextype>(problem_.pattern().row.size()), CSC_MAT, context);
        solver = SUNLinSol_KLU(state, matrix, context);
    }
    [[nodiscard]] double relative() const noexcept { return relative_; }
    [[nodiscard]] Problem& problem() noexcept { return problem_; }

    SUNContext context = nullptr;
    N_Vector state = nullptr, absolute = nullptr;
    SUNMatrix matrix = nullptr;
    SUNLinearSolver solver = nullptr;

private:
    Problem& problem_;
    double relative_;
};

void require(int code, const char* what) {
    if (code < 0) throw std::runtime_error(std::string(what) + " returned " + std::to_string(code));
}

int slope(realtype t, N_Vector y, N_Vector out, void* user) {
    static_cast<Problem*>(user)->slope(t, N_VGetArrayPointer(y), N_VGetArrayPointer(out));
    return 0;
}

int dense_jacobian(realtype t, N_Vector y, N_Vector /*slope*/, SUNMatrix out, void* user, N_Vector, N_Vector, N_Vector) {
    Problem& problem = *static_cast<Problem*>(user);
    const SparsePattern& pattern = problem.pattern();
    std::copy(pattern.begin.begin(), pattern.begin.end(), SUNSparseMatrix_IndexPointers(out));
    std::copy(pattern.row.begin(), pattern.row.end(), SUNSparseMatrix_IndexValues(out));
    problem.jacobian(t, N_VGetArrayPointer(y), SUNSparseMatrix_Data(out));
    return 0;
}

/// Steps from output to output. @param advance (time requested) → error code
template <class Advance>
PeerRun go_through(Common& common, const Advance& advance) {
    Problem& problem = common.problem();
    problem.forget_evaluations();
    PeerRun run;
    const double begin = problem.start().time;
    for (int output = 1; output <= problem.outputs() && run.fault.empty(); ++output) {
        const double until = begin + output * problem.interval();
        const auto before = std::chrono::steady_clock::now();
        const int code = advance(until);
        run.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
        if (code < 0) run.fault = "returned " + std::to_string(code) + " before output " + std::to_string(output);
        if (run.seconds > max_seconds) run.fault = "takes too long";
        problem.observe(until, N_VGetArrayPointer(common.state), run.trajectory);
    }
    run.evaluations = problem.evaluations();
    return run;
}

PeerRun run_cvode(Problem& problem, double tolerance) {
    Common common(problem, tolerance);
    common.make_matrix();
    void* memory = CVodeCreate(CV_BDF, common.context);
    require(CVodeInit(memory, slope, problem.start().time, common.state), "CVodeInit");
    require(CVodeSVtolerances(memory, common.relative(), common.absolute), "CVodeSVtolerances");
    require(CVodeSetUserData(memory, &problem), "CVodeSetUserData");
    require(CVodeSetMaxNumSteps(memory, most_steps), "CVodeSetMaxNumSteps");
    require(CVodeSetLinearSolver(memory, common.solver, common.matrix), "CVodeSetLinearSolver");
    require(CVodeSetJacFn(memory, dense_jacobian), "CVodeSetJacFn");
    PeerRun run = go_through(common, [&](double until) {
        realtype reached = 0.0;
        CVodeSetStopTime(memory, until);
        return CVode(memory, until, common.state, &reached, CV_NORMAL);
    });
    CVodeGetNumSteps(memory, &run.steps);
    CVodeGetNumJacEvals(memory, &run.jacobians);
    CVodeFree(&memory);
    return run;
}

PeerRun run_explicit(Problem& problem, double tolerance) {
    Common common(problem, tolerance);
    void* memory = ERKStepCreate(slope, problem.start().time, common.state, common.context);
    require(ERKStepSetOrder(memory, 4), "ERKStepSetOrder");
    require(ERKStepSVtolerances(memory, common.relative(), common.absolute), "ERKStepSVtolerances");
    require(ERKStepSetUserData(memory, &problem), "ERKStepSetUserData");
    require(ERKStepSetMaxNumSteps(memory, most_steps), "ERKStepSetMaxNumSteps");
    PeerRun run = go_through(common, [&](double until) {
        realtype reached = 0.0;
        ERKStepSetStopTime(memory, until);
        return ERKStepEvolve(memory, until, common.state, &reached, ARK_NORMAL);
    });
    ERKStepGetNumSteps(memory, &run.steps);
    ERKStepFree(&memory);
    return run;
}

/// Additive: positions, whose slope is the velocity, explicitly; accelerations, in which everything stiff is, implicitly.
struct Halves {
    static int take(realtype t, N_Vector y, N_Vector out, void* user, bool rates) {
        Problem& problem = *static_cast<Problem*>(user);
        double* const slopes = N_VGetArrayPointer(out);
        problem.slope(t, N_VGetArrayPointer(y), slopes);
        for (int k = 0; k < problem.size(); ++k) slopes[k] = problem.is_rate(k) == rates ? slopes[k] : 0.0;
        return 0;
    }
    static int explicit_part(realtype t, N_Vector y, N_Vector out, void* user) { return take(t, y, out, user, false); }
    static int implicit_part(realtype t, N_Vector y, N_Vector out, void* user) { return take(t, y, out, user, true); }
    static int implicit_jacobian(realtype t, N_Vector y, N_Vector f, SUNMatrix out, void* user, N_Vector a, N_Vector b, N_Vector c) {
        dense_jacobian(t, y, f, out, user, a, b, c);
        Problem& problem = *static_cast<Problem*>(user);
        const SparsePattern& pattern = problem.pattern();
        for (std::size_t k = 0; k < pattern.row.size(); ++k) {
            if (!problem.is_rate(pattern.row[k])) SUNSparseMatrix_Data(out)[k] = 0.0;
        }
        return 0;
    }
};

PeerRun run_additive(Problem& problem, double tolerance) {
    Common common(problem, tolerance);
    common.make_matrix();
    void* memory = ARKStepCreate(Halves::explicit_part, Halves::implicit_part, problem.start().time, common.state, common.context);
    require(ARKStepSetOrder(memory, 4), "ARKStepSetOrder");
    require(ARKStepSVtolerances(memory, common.relative(), common.absolute), "ARKStepSVtolerances");
    require(ARKStepSetUserData(memory, &problem), "ARKStepSetUserData");
    require(ARKStepSetMaxNumSteps(memory, most_steps), "ARKStepSetMaxNumSteps");
    require(ARKStepSetLinearSolver(memory, common.solver, common.matrix), "ARKStepSetLinearSolver");
    require(ARKStepSetJacFn(memory, Halves::implicit_jacobian), "ARKStepSetJacFn");
    PeerRun run = go_through(common, [&](double until) {
        realtype reached = 0.0;
        ARKStepSetStopTime(memory, until);
        return ARKStepEvolve(memory, until, common.state, &reached, ARK_NORMAL);
    });
    ARKStepGetNumSteps(memory, &run.steps);
    ARKStepGetNumJacEvals(memory, &run.jacobians);
    ARKStepFree(&memory);
    return run;
}

}  // namespace

const std::vector<Peer>& peers() {
    static const std::vector<Peer> all{
        {"cvode-bdf", "CVODE: BDF, Newton with the exact Jacobian, KLU", run_cvode},
        {"arkode-explicit", "ARKODE: explicit Runge-Kutta of order 4", run_explicit},
        {"arkode-additive", "ARKODE: additive Runge-Kutta of order 4, accelerations implicit with the exact Jacobian, KLU", run_additive},
    };
    return all;
}

std::string sundials_version() {
    char text[32] = "";
    return SUNDIALSGetVersion(text, sizeof text) == 0 ? text : "unknown";
}

}  // namespace cvtflow::bench
