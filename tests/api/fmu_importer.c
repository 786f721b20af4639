/* Steps an FMU in FMI Library, an importer that others wrote, and prints the bits of its variables after every step.

       fmu_importer FMU FOLDER STEPS LENGTH INPUT VALUE NAME...      FOLDER: empty, where it unpacks the FMU; LENGTH [s]; INPUT: a name, or
   -

   Half-way through the input becomes VALUE. There it also keeps the state as bytes, takes a step, returns to the state and compares with
   the step that follows. Statuses other than OK and what the FMU logs go to standard error, and so does what states cost. */

#include <fmilib.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static fmi2_import_t* two;
static fmi3_import_t* three;

/* CALL(do_step, (…of 2.0…), (…of 3.0…)): status of the function in the FMU's version */
#define CALL(name, of_2, of_3) checked(three ? (int)fmi3_import_##name of_3 : (int)fmi2_import_##name of_2, #name)
#define SAME(name, ...) CALL(name, (two, ##__VA_ARGS__), (three, ##__VA_ARGS__))

static void fail(const char* what) {
    fprintf(stderr, "%s\n", what);
    exit(3);
}
static int checked(int status, const char* what) {
    if (status != 0) fprintf(stderr, "%s: status %d\n", what, status);
    if (status > 1) exit(4);
    return status;
}

static void log_2(fmi2_component_environment_t environment, fmi2_string_t name, fmi2_status_t status, fmi2_string_t category,
                  fmi2_string_t text, ...) {
    va_list rest;
    (void)environment, (void)name;
    fprintf(stderr, "log: status %d, %s: ", status, category);
    va_start(rest, text);
    vfprintf(stderr, text, rest);
    va_end(rest);
    fprintf(stderr, "\n");
}
static void log_3(fmi3_instance_environment_t environment, fmi3_status_t status, fmi3_string_t category, fmi3_string_t text) {
    (void)environment;
    fprintf(stderr, "log: status %d, %s: %s\n", status, category, text);
}
/* Of terminals it knows a draft, and warns of every attribute of the standard's. */
static void log_library(jm_callbacks* callbacks, jm_string module, jm_log_level_enu_t level, jm_string text) {
    (void)callbacks;
    if (level <= jm_log_level_error) fprintf(stderr, "library: %s: %s\n", module, text);
}

static void begin(const char* folder) {
    static const fmi2_callback_functions_t callbacks = {log_2, calloc, free, NULL, NULL};
    char resources[4096];
    snprintf(resources, sizeof resources, "%s/resources/", folder);
    if (three) {
        if (fmi3_import_create_dllfmu(three, fmi3_fmu_kind_cs, NULL, log_3) != jm_status_success) fail("cannot be loaded");
        if (fmi3_import_instantiate_co_simulation(three, "one", resources, 0, 1, 0, 0, NULL, 0, NULL) != jm_status_success)
            fail("no instance");
    } else {
        if (fmi2_import_create_dllfmu(two, fmi2_fmu_kind_cs, &callbacks) != jm_status_success) fail("cannot be loaded");
        if (fmi2_import_instantiate(two, "one", fmi2_cosimulation, NULL, 0) != jm_status_success) fail("no instance");
        checked(fmi2_import_set_debug_logging(two, 1, 0, NULL), "set_debug_logging");
        checked(fmi2_import_setup_experiment(two, 0, 0.0, 0.0, 0, 0.0), "setup_experiment");
    }
    CALL(enter_initialization_mode, (two), (three, 0, 0.0, 0.0, 0, 0.0));
    SAME(exit_initialization_mode);
}

/* Bits of a variable; of a Boolean one 0 or 1. */
static uint64_t get(const char* name) {
    double value = 0.0;
    uint64_t bits;
    if (three) {
        fmi3_import_variable_t* variable = fmi3_import_get_variable_by_name(three, name);
        if (!variable) fail(name);
        const fmi3_value_reference_t reference = fmi3_import_get_variable_vr(variable);
        if (fmi3_import_get_variable_base_type(variable) == fmi3_base_type_bool) {
            fmi3_boolean_t flag = 0;
            checked(fmi3_import_get_boolean(three, &reference, 1, &flag, 1), "get_boolean");
            return flag;
        }
        checked(fmi3_import_get_float64(three, &reference, 1, &value, 1), "get_float64");
    } else {
        fmi2_import_variable_t* variable = fmi2_import_get_variable_by_name(two, name);
        if (!variable) fail(name);
        const fmi2_value_reference_t reference = fmi2_import_get_variable_vr(variable);
        if (fmi2_import_get_variable_base_type(variable) == fmi2_base_type_bool) {
            fmi2_boolean_t flag = 0;
            checked(fmi2_import_get_boolean(two, &reference, 1, &flag), "get_boolean");
            return (uint64_t)flag;
        }
        checked(fmi2_import_get_real(two, &reference, 1, &value), "get_real");
    }
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void set(const char* name, double value) {
    if (three) {
        const fmi3_value_reference_t reference = fmi3_import_get_variable_vr(fmi3_import_get_variable_by_name(three, name));
        checked(fmi3_import_set_float64(three, &reference, 1, &value, 1), "set_float64");
    } else {
        const fmi2_value_reference_t reference = fmi2_import_get_variable_vr(fmi2_import_get_variable_by_name(two, name));
        checked(fmi2_import_set_real(two, &reference, 1, &value), "set_real");
    }
}

static void step(double time, double length) {
    fmi3_boolean_t event, terminate, early;
    double reached;
    CALL(do_step, (two, time, length, 0), (three, time, length, 0, &event, &terminate, &early, &reached));
}

static double now(void) { /* [us] */
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

/* The present state, by way of its bytes; prints the mean cost of each call. */
static void* kept_state(void) {
    enum { rounds = 200 };
    void *state = NULL, *copy = NULL;
    size_t size = 0;
    double times[5] = {now(), 0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < rounds; ++k) SAME(get_fmu_state, &state);
    times[1] = now();
    for (int k = 0; k < rounds; ++k) SAME(set_fmu_state, state);
    times[2] = now();
    SAME(serialized_fmu_state_size, state, &size);
    unsigned char* bytes = malloc(size);
    for (int k = 0; k < rounds; ++k) CALL(serialize_fmu_state, (two, state, (char*)bytes, size), (three, state, bytes, size));
    times[3] = now();
    for (int k = 0; k < rounds; ++k) {
        if (copy) SAME(free_fmu_state, &copy);
        CALL(de_serialize_fmu_state, (two, (char*)bytes, size, &copy), (three, bytes, size, &copy));
    }
    times[4] = now();
    SAME(free_fmu_state, &state);
    free(bytes);
    fprintf(stderr, "states of %zu bytes: get %.1f us, set %.1f us, serialise %.1f us, deserialise %.1f us\n", size,
            (times[1] - times[0]) / rounds, (times[2] - times[1]) / rounds, (times[3] - times[2]) / rounds, (times[4] - times[3]) / rounds);
    return copy;
}

int main(int count, char** words) {
    if (count < 8) return 2;
    jm_callbacks callbacks = {malloc, calloc, realloc, free, log_library, jm_log_level_error, NULL, ""};
    fmi_import_context_t* context = fmi_import_allocate_context(&callbacks);
    const fmi_version_enu_t version = fmi_import_get_fmi_version(context, words[1], words[2]);
    if (version == fmi_version_3_0_enu) three = fmi3_import_parse_xml(context, words[2], NULL);
    if (version == fmi_version_2_0_enu) two = fmi2_import_parse_xml(context, words[2], NULL);
    if (!two && !three) fail("no description of version 2.0 or 3.0");
    begin(words[2]);
    const int steps = atoi(words[3]), names = count - 7;
    const double length = atof(words[4]);
    uint64_t* after = calloc((size_t)names, sizeof *after);
    for (int number = 0; number <= steps; ++number) {
        const double time = number * length;
        for (int k = 0; k < names; ++k) {
            const uint64_t bits = get(words[7 + k]);
            printf("%d %s %016" PRIx64 "\n", number, words[7 + k], bits);
            if (number == steps / 2 + 1 && bits != after[k]) fail("a state that was kept continues otherwise");
        }
        if (number == steps / 2) {
            if (strcmp(words[5], "-") != 0) set(words[5], atof(words[6]));
            void* state = kept_state();
            step(time, length);
            for (int k = 0; k < names; ++k) after[k] = get(words[7 + k]);
            SAME(set_fmu_state, state);
            SAME(free_fmu_state, &state);
        }
        if (number < steps) step(time, length);
    }
    free(after);
    SAME(terminate);
    if (three) {
        fmi3_import_free_instance(three), fmi3_import_destroy_dllfmu(three), fmi3_import_free(three);
    } else {
        fmi2_import_free_instance(two), fmi2_import_destroy_dllfmu(two), fmi2_import_free(two);
    }
    fmi_import_free_context(context);
    return 0;
}
