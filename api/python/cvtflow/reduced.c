/* A variator as a map of steady points and a shift law: ISO C99. FMI is 2 or 3; 0: the functions without a standard.
   map.h has the axes, one row of VALUES numbers for each of their points, the names and start values of all variables.

   States are the ratio i = omega_1/omega_2 (1 - slip) of the pins, with d ln i/dt = -C omega_1 (S_1 - S_1*)/S_2, and the speeds of both
   shafts. Each step keeps the energy: work of both shafts, losses and kinetic energies balance. Where shaft 2 drives, both pulleys change
   places. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "map.h"

enum { THRUST, SLIP, LOSS, SHIFT, MOVING, TIPS = MOVING, TIGHT, SLACK, LIMIT }; /* MOVING: those that a step needs */

enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double of, log;
} Logarithm;

typedef struct {
    double v[COUNT];                   /* variables by reference, time first */
    Logarithm ratio_log, force_log;    /* the last ones */
    double ratio, speed, second;       /* states: i, omega_1, omega_2 */
    double turn, slowing, loss, slope; /* d ln i/dt, d omega_2/dt, torque of the losses on shaft 1, d slip/d load */
    double middle, power, lost;        /* means over the last step: omega_1, power to shaft 2, losses */
    int known;
} Reduced;

static double logarithm(Logarithm* last, double x) {
    if (x != last->of) last->log = log(x), last->of = x;
    return last->log;
}

/* The cell of x on an axis (n points, n - 1 inverse distances) and the place in it; sets the flag where x is outside. */
static int cell(const double* axis, int n, double x, double* place, int flag, int* outside) {
    int k = 0;
    const double rounding = 1e-6 * (axis[n - 1] - axis[0]);
    if (!(x >= axis[0] - rounding && x <= axis[n - 1] + rounding)) *outside |= flag;
    x = x > axis[0] ? (x < axis[n - 1] ? x : axis[n - 1]) : axis[0];
    while (k < n - 2 && x > axis[k + 1]) ++k;
    *place = (x - axis[k]) * axis[n + k];
    return k;
}

/* Values at ln i, share of the torque limit, S_2 and speed of the driving shaft; multilinear. Returns what is outside: 1 ratio, 2 load,
   4 clamping, 8 speed. count: of values; out has one more, the slope of slip over the share */
static inline int values_at(double log_ratio, double share, double log_clamping, double speed, double* out, int count) {
    double a, b, c, d, near[8], far[8];
    const double* row[8];
    int outside = 0, corner, n;
    const int i = cell(ratio_axis, RATIOS, log_ratio, &a, 1, &outside), j = cell(load_axis, LOADS, share, &b, 2, &outside);
    const int k = cell(clamping_axis, CLAMPINGS, log_clamping, &c, 4, &outside), l = cell(speed_axis, SPEEDS, speed, &d, 8, &outside);
    for (corner = 0; corner < 8; ++corner) {
        const int s = corner & 1, t = corner >> 1 & 1, u = corner >> 2;
        const double weight = (s ? d : 1.0 - d) * (t ? c : 1.0 - c) * (u ? a : 1.0 - a);
        row[corner] = map[l + s][k + t][i + u][j];
        near[corner] = weight * (1.0 - b);
        far[corner] = weight * b;
    }
    for (n = 0; n < count; n += 2) { /* by twos: compilers make vectors of them */
        double even = 0.0, odd = 0.0;
        for (corner = 0; corner < 8; ++corner) {
            even += near[corner] * row[corner][n] + far[corner] * row[corner][VALUES + n];
            odd += near[corner] * row[corner][n + 1] + far[corner] * row[corner][VALUES + n + 1];
        }
        out[n] = even;
        out[n + 1] = odd;
    }
    for (corner = 0, out[count] = 0.0; corner < 8; ++corner)
        out[count] += (near[corner] + far[corner]) * (row[corner][VALUES + SLIP] - row[corner][SLIP]) * load_axis[LOADS + j];
    if (count == VALUES && share > out[LIMIT] + 1e-6) outside |= 2;
    return outside;
}

/* 2 mu S r/cos(beta) of the driven pulley. */
static double torque_limit(double log_ratio, double clamping) {
    double place;
    int none = 0;
    const int k = cell(ratio_axis, RATIOS, log_ratio, &place, 0, &none);
    return clamping * ((1.0 - place) * limit_per_force[k] + place * limit_per_force[k + 1]);
}

/* d ln i/dt at the present state and inputs. all: 1: outputs as well; 2: those of energy for this instant, not for the last step. */
static void evaluate(Reduced* m, int all) {
    double* v = m->v;
    double out[VALUES + 1], law, ln, place;
    const double i = m->ratio, speed = m->speed, turns = (1.0 - v[SLIP_OUT]) / i, second = speed * turns;
    const double load = v[TORQUE_2] + v[INERTIA_2] * m->slowing;
    const int back = load < 0.0; /* shaft 2 drives */
    double first = v[SHIFT_MODE] == 0.0 ? v[CLAMPING_1] : m->known < 0 ? v[CLAMPING_2] : v[APPLIED], limit;
    double driven = back ? first : v[CLAMPING_2], torque = back ? -load * turns - m->loss : load;
    int outside;
    if (!(driven > 1.0)) driven = 1.0;
    if (!(torque > 0.0)) torque = 0.0;
    ln = logarithm(&m->ratio_log, i) + v[SLIP_OUT] * (1.0 + v[SLIP_OUT] * (0.5 + v[SLIP_OUT] / 3.0)); /* of speeds: ln i - ln(1 - slip) */
    if (back) ln = -ln;
    limit = torque_limit(ln, driven);
    place = logarithm(&m->force_log, driven);
    outside = all ? values_at(ln, torque / limit, place, back ? second : speed, out, VALUES)
                  : values_at(ln, torque / limit, place, back ? second : speed, out, MOVING);
    law = out[SHIFT] * (back ? second : speed);
    if (v[SHIFT_MODE] != 0.0) { /* the clamping force of shaft 1 that moves the ratio toward its target */
        m->turn = log(v[RATIO_TARGET] * (1.0 - v[SLIP_OUT]) / i) / v[TIME_CONSTANT];
        first = back ? v[CLAMPING_2] / (out[THRUST] + m->turn / law) : driven * (out[THRUST] - m->turn / law);
        first = first >= 0.0 ? (first < v[CLAMPING_LIMIT] ? first : v[CLAMPING_LIMIT]) : back ? v[CLAMPING_LIMIT] : 0.0;
        if (back) driven = first > 1.0 ? first : 1.0;
    }
    m->turn = back ? law * (v[CLAMPING_2] / driven - out[THRUST]) : -law * (first / driven - out[THRUST]);
    v[APPLIED] = first;
    m->loss = out[LOSS] * driven * (back ? turns : 1.0); /* on shaft 1 */
    m->slope = out[all ? VALUES : MOVING] / limit * (back ? turns : 1.0);
    if (!(m->slope > 0.0)) m->slope = 0.0;
    v[SLIP_OUT] = back ? -out[SLIP] / (1.0 - out[SLIP]) : out[SLIP];
    if (!all) return;
    if (all == 2) m->middle = speed, m->power = load * m->second, m->lost = m->loss * speed;
    v[RATIO] = speed / m->second;
    v[SHAFT_1_SPEED] = speed;
    v[SHAFT_2_SPEED] = m->second;
    v[LOSSES] = m->lost;
    v[TIP_LOSSES] = out[TIPS] * driven * (back ? second : speed);
    v[TIGHT_TENSION] = out[TIGHT] * driven;
    v[SLACK_TENSION] = out[SLACK] * driven;
    v[CLAMPING_BALANCE] = back ? v[CLAMPING_2] / out[THRUST] : v[CLAMPING_2] * out[THRUST];
    v[LIMIT_2] = (back ? i : 1.0) * out[LIMIT] * limit;
    v[DRIVE_TORQUE] = (m->power + m->lost) / m->middle;
    v[EFFICIENCY] = m->power > 0.0 ? m->power / (m->power + m->lost) : m->power < -m->lost ? (m->power + m->lost) / m->power : 0.0;
    v[OUTSIDE] = outside;
    m->known = 1;
}

static double above_one(double speed) { return speed > 1.0 ? speed : 1.0; } /* a shaft that stands is outside the map */

/* The new speeds x and y solve y = x (1 - slip)/i, with slip linear in the load L = torque_2 + J_2 (y - b)/h, and, where it is not given,
   J_1 (x - a)/h = torque_1 - T; the chain's torque T follows from T (a + x) = L (b + y) + loss. */
static void advance_one(Reduced* m, double h) {
    double* v = m->v;
    const double a = m->speed, b = m->second, first = v[INERTIA_1] / h, inertia = v[INERTIA_2] / h;
    double x = a, y, load, stiff, free, turns, slope;
    int k;
    if (v[DRIVE_MODE] == 0.0) x = m->speed = above_one(v[SPEED_1]);
    if (m->known <= 0) evaluate(m, 0);
    m->ratio *= 1.0 + h * m->turn * (1.0 + 0.5 * h * m->turn); /* exp(), with two terms */
    m->ratio = m->ratio > ratio_ends[0] ? (m->ratio < ratio_ends[1] ? m->ratio : ratio_ends[1]) : ratio_ends[0];
    stiff = m->slope * inertia;
    free = 1.0 - v[SLIP_OUT] + m->slope * v[INERTIA_2] * m->slowing + stiff * b;
    for (k = 0;; ++k) { /* Newton's method */
        y = x * free / (m->ratio + x * stiff);
        load = v[TORQUE_2] + inertia * (y - b);
        turns = (b + y) / (a + x);
        if (v[DRIVE_MODE] == 0.0 || k == 3) break;
        slope = ((inertia * (b + y) + load) * m->ratio / (m->ratio + x * stiff) * y / x - load * turns) / (a + x);
        x = above_one(x - (first * (x - a) + load * turns + m->loss - v[TORQUE_1]) / (first + slope));
    }
    m->speed = x;
    m->second = y;
    m->slowing = (y - b) / h;
    m->middle = 0.5 * (a + x);
    m->power = 0.5 * load * (b + y);
    m->lost = m->loss * m->middle;
    m->known = 0;
}

/* In steps of 1 ms at most. */
static int advance(Reduced* m, double length) {
    const double count = ceil(length / 1e-3 - 1e-6);
    long k, steps;
    if (!(length >= 0.0 && length < 1e6)) return ERROR;
    if (length == 0.0) return OK;
    steps = count > 1.0 ? (long)count : 1;
    for (k = 0; k < steps; ++k) advance_one(m, length / (double)steps);
    evaluate(m, 1);
    m->v[TIME] += length;
    return OK;
}

static void begin(Reduced* m) {
    memcpy(m->v, start_values, sizeof start_values);
    m->ratio = m->v[RATIO_START];
    m->speed = m->v[SPEED_1];
    m->second = m->speed / m->ratio;
    m->turn = m->slowing = m->loss = 0.0;
    m->known = -1;
    m->ratio_log.of = m->force_log.of = 0.0;
}

/* State from the start values; three times, since slip and losses are inputs of themselves. */
static void initialise(Reduced* m) {
    int k;
    m->speed = above_one(m->v[SPEED_1]);
    m->second = m->speed / m->v[RATIO_START];
    m->slowing = 0.0;
    for (k = 0; k < 3; ++k) {
        m->ratio = m->v[RATIO_START] * (1.0 - m->v[SLIP_OUT]);
        evaluate(m, 2);
    }
}

static Reduced* create(void) {
    Reduced* made = (Reduced*)malloc(sizeof *made);
    if (made) begin(made);
    return made;
}

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static int get(Reduced* m, const unsigned* r, size_t n, double* values) {
    size_t k;
    if (m->known <= 0) evaluate(m, 2);
    for (k = 0; k < n; ++k) {
        if (r[k] >= COUNT) return ERROR;
        values[k] = m->v[r[k]];
    }
    return OK;
}

static int set(Reduced* m, const unsigned* r, size_t n, const double* values) {
    size_t k;
    for (k = 0; k < n; ++k) {
        if (r[k] >= SETTABLE || !(fabs(values[k]) < 1e30)) return ERROR;
        m->v[r[k]] = values[k];
    }
    if (m->known > 0) m->known = 0;
    return OK;
}

#if FMI == 0
EXPORT Reduced* reduced_create(void) { return create(); }
EXPORT void reduced_free(Reduced* m) { free(m); }
EXPORT void reduced_initialise(Reduced* m) { initialise(m); }
EXPORT int reduced_get(Reduced* m, const unsigned* r, size_t n, double* values) { return get(m, r, n, values); }
EXPORT int reduced_set(Reduced* m, const unsigned* r, size_t n, const double* values) { return set(m, r, n, values); }
EXPORT int reduced_advance(Reduced* m, double length) { return advance(m, length); }
EXPORT int reduced_values_at(double log_ratio, double share, double log_clamping, double speed, double* out) {
    return values_at(log_ratio, share, log_clamping, speed, out, VALUES);
}
#elif FMI == 2
#define NAME(name) fmi2##name
#define fmi2GetFMUState fmi2GetFMUstate
#define fmi2SetFMUState fmi2SetFMUstate
#define fmi2FreeFMUState fmi2FreeFMUstate
typedef const char* Text;
EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void) { return "2.0"; }
EXPORT void* fmi2Instantiate(Text name, int type, Text id, Text place, const void* callbacks, int visible, int logging) {
    (void)name, (void)place, (void)callbacks, (void)visible, (void)logging;
    return type == 1 && id && strcmp(id, IDENTITY) == 0 ? create() : NULL;
}
EXPORT int fmi2SetupExperiment(void* m, int has, double tolerance, double start, int ends, double stop) {
    (void)has, (void)tolerance, (void)ends, (void)stop;
    ((Reduced*)m)->v[TIME] = start;
    return OK;
}
EXPORT int fmi2EnterInitializationMode(void* m) { return m ? OK : ERROR; }
EXPORT int fmi2GetReal(void* m, const unsigned* r, size_t n, double* values) { return get(m, r, n, values); }
EXPORT int fmi2SetReal(void* m, const unsigned* r, size_t n, const double* values) { return set(m, r, n, values); }
EXPORT int fmi2DoStep(void* m, double at, double length, int kept) {
    (void)at, (void)kept;
    return advance(m, length);
}
#else
#define NAME(name) fmi3##name
#include <stdbool.h>
typedef const char* Text;
EXPORT Text fmi3GetVersion(void) { return "3.0"; }
EXPORT void* fmi3InstantiateCoSimulation(Text name, Text id, Text place, bool visible, bool logging, bool events, bool early,
                                         const unsigned* r, size_t n, void* environment, void* log, void* update) {
    (void)name, (void)place, (void)visible, (void)logging, (void)early, (void)r, (void)n, (void)environment, (void)log, (void)update;
    return !events && id && strcmp(id, IDENTITY) == 0 ? create() : NULL;
}
EXPORT int fmi3EnterInitializationMode(void* m, bool has, double tolerance, double start, bool ends, double stop) {
    (void)has, (void)tolerance, (void)ends, (void)stop;
    ((Reduced*)m)->v[TIME] = start;
    return OK;
}
EXPORT int fmi3GetFloat64(void* m, const unsigned* r, size_t n, double* values, size_t count) {
    return count == n ? get(m, r, n, values) : ERROR;
}
EXPORT int fmi3SetFloat64(void* m, const unsigned* r, size_t n, const double* values, size_t count) {
    return count == n ? set(m, r, n, values) : ERROR;
}
EXPORT int fmi3DoStep(void* m, double at, double length, bool kept, bool* event, bool* ends, bool* early, double* last) {
    const int made = advance(m, length);
    (void)at, (void)kept;
    *event = *ends = *early = false;
    *last = ((Reduced*)m)->v[TIME];
    return made;
}
EXPORT void* fmi3InstantiateModelExchange(void) { return NULL; }
EXPORT void* fmi3InstantiateScheduledExecution(void) { return NULL; }
#endif

#if FMI != 0
EXPORT void NAME(FreeInstance)(void* m) { free(m); }
EXPORT int NAME(ExitInitializationMode)(void* m) { return initialise(m), OK; }
EXPORT int NAME(Terminate)(void* m) { return m ? OK : ERROR; }
EXPORT int NAME(SetDebugLogging)(void* m) { return (void)m, OK; }
EXPORT int NAME(Reset)(void* m) { return begin(m), OK; }
EXPORT int NAME(GetFMUState)(void* m, void** state) {
    if (!*state) *state = malloc(sizeof(Reduced));
    return *state ? (memcpy(*state, m, sizeof(Reduced)), OK) : ERROR;
}
EXPORT int NAME(SetFMUState)(void* m, void* state) { return state ? (memcpy(m, state, sizeof(Reduced)), OK) : ERROR; }
EXPORT int NAME(FreeFMUState)(void* m, void** state) { return (void)m, free(*state), *state = NULL, OK; }
/* No variable has another type, and no function of the rest is offered. */
#define NONE(name) \
    EXPORT int NAME(name)(void* m) { return (void)m, ERROR; }
#define TYPE(name) NONE(Get##name) NONE(Set##name)
/* clang-format off */
#if FMI == 2
TYPE(Integer) TYPE(Boolean) TYPE(String) NONE(GetDirectionalDerivative) NONE(SetRealInputDerivatives)
NONE(GetRealOutputDerivatives) NONE(SerializedFMUstateSize) NONE(SerializeFMUstate) NONE(DeSerializeFMUstate) NONE(CancelStep)
NONE(GetStatus) NONE(GetRealStatus) NONE(GetIntegerStatus) NONE(GetBooleanStatus) NONE(GetStringStatus)
#else
TYPE(Float32) TYPE(Int8) TYPE(UInt8) TYPE(Int16) TYPE(UInt16) TYPE(Int32) TYPE(UInt32) TYPE(Int64) TYPE(UInt64) TYPE(Boolean)
TYPE(String) TYPE(Binary) TYPE(Clock) TYPE(IntervalDecimal) TYPE(IntervalFraction) TYPE(ShiftDecimal) TYPE(ShiftFraction)
NONE(SerializedFMUStateSize) NONE(SerializeFMUState) NONE(DeserializeFMUState) NONE(GetDirectionalDerivative)
NONE(GetAdjointDerivative) NONE(GetOutputDerivatives) NONE(GetNumberOfVariableDependencies) NONE(GetVariableDependencies)
NONE(EnterConfigurationMode) NONE(ExitConfigurationMode) NONE(EvaluateDiscreteStates) NONE(UpdateDiscreteStates)
NONE(EnterEventMode) NONE(EnterStepMode) NONE(ActivateModelPartition) NONE(EnterContinuousTimeMode)
NONE(CompletedIntegratorStep) NONE(SetTime) NONE(SetContinuousStates) NONE(GetContinuousStateDerivatives)
NONE(GetEventIndicators) NONE(GetContinuousStates) NONE(GetNominalsOfContinuousStates) NONE(GetNumberOfEventIndicators)
NONE(GetNumberOfContinuousStates)
#endif
#endif
