/* The C interface from C11: every function once, errors as codes, versioned structs of other sizes. Prints what failed. With CORE_ONLY defined
   for the core library, which has no files and no threads of its own: on Windows, too. */

#include <cvtflow/cvtflow.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#ifdef CORE_ONLY
#define FULL(statement)
#define scene_read(path, scene, message) cvtflow_scene_ready(path, scene, message)
#else
#define FULL(statement) statement
#define scene_read(path, scene, message) cvtflow_scene_read(path, scene, message)
#endif

#define CHECK(condition)                                                        \
    do {                                                                        \
        if (!(condition)) {                                                     \
            fprintf(stderr, "c_program.c:%d: not so: %s\n", __LINE__, #condition); \
            ++failures;                                                         \
        }                                                                       \
    } while (0)

static cvtflow_scene* brief_scene(const char* path) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_scene* scene = NULL;
    cvtflow_scene* brief = NULL;
    const char* settings[] = {"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms", "run.step=100 ns"};
    CHECK(scene_read(path, &scene, &message) == CVTFLOW_OK);
    CHECK(strcmp(cvtflow_scene_name(scene), "tiny") == 0);
    CHECK(cvtflow_scene_with(scene, settings, 3, &brief, &message) == CVTFLOW_OK);
    CHECK(message.code == CVTFLOW_OK && message.text[0] == '\0');
    cvtflow_scene_release(scene);
    return brief;
}

static void check_errors(const cvtflow_scene* scene) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_scene* none = NULL;
    cvtflow_simulation* simulation = NULL;
    cvtflow_options options = {0};
    struct { uint32_t size; int32_t code; char text[8]; } brief = {sizeof brief, 0, ""};
    CHECK(cvtflow_scene_read("/nowhere.toml", &none, &message) == CVTFLOW_SCENE);
    CHECK(message.code == CVTFLOW_SCENE && strstr(message.text, "/nowhere.toml") != NULL);
    CHECK(cvtflow_scene_parse("[chain]\npins = 2\n", NULL, &none, (cvtflow_message*)&brief) == CVTFLOW_SCENE);
    CHECK(strcmp(brief.text, "scene.t") == 0); /* cut off where the room ends */
    memset(&message, 0, sizeof message);
    CHECK(cvtflow_scene_read(NULL, &none, &message) == CVTFLOW_ARGUMENT);
    CHECK(strcmp(message.text, "path is NULL") == 0);
    CHECK(cvtflow_scene_ready("no_such_scene_at_all", &none, NULL) == CVTFLOW_SCENE);
    CHECK(cvtflow_scene_with_detail(scene, "finest", &none, NULL) == CVTFLOW_SCENE);
    CHECK(none == NULL);
    CHECK(cvtflow_create(scene, &options, &simulation, &message) == CVTFLOW_ARGUMENT);
    options.size = sizeof options;
    options.way = 77;
    CHECK(cvtflow_create(scene, &options, &simulation, &message) == CVTFLOW_ARGUMENT);
    CHECK(strcmp(message.text, "way: there is no number 77") == 0);
    CHECK(simulation == NULL);
    CHECK(cvtflow_advance_to(NULL, 1.0, &message) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_time(NULL) == 0.0 && cvtflow_size(NULL) == 0 && cvtflow_unknowns(NULL) == NULL);
    CHECK(strcmp(cvtflow_code_name(CVTFLOW_CANCELLED), "cancelled") == 0);
    CHECK(strcmp(cvtflow_code_name(4711), "unknown") == 0);
    cvtflow_cancel(NULL);
    cvtflow_destroy(NULL);
    cvtflow_scene_release(NULL);
}

/* A caller with more room gets all of a long message. */
static void check_long_messages(void) {
    static struct { uint32_t size; int32_t code; char text[65528]; } message = {sizeof message, 0, ""};
    static char text[10000];
    cvtflow_scene* none = NULL;
    strcpy(text, "[load]\n");
    for (int k = 0; k < 60; ++k) sprintf(text + strlen(text), "key_%d = %d\n", k, k);
    CHECK(cvtflow_scene_parse(text, NULL, &none, (cvtflow_message*)&message) == CVTFLOW_SCENE);
    CHECK(strstr(message.text, "key_0") != NULL && strstr(message.text, "key_59") != NULL && strlen(message.text) > 1016);
}

static void check_knowledge(void) {
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    double value = 0.0;
    size_t size = 0;
    char* text;
    CHECK(cvtflow_describe("keys", NULL, &size, &message) == CVTFLOW_OK && size > 10000);
    text = malloc(size);
    CHECK(cvtflow_describe("keys", text, &size, NULL) == CVTFLOW_OK && strlen(text) + 1 == size && strstr(text, "\"load.torque\"") != NULL);
    --size;
    CHECK(cvtflow_describe("keys", text, &size, &message) == CVTFLOW_ARGUMENT);
    free(text);
    CHECK(cvtflow_describe("kees", NULL, &size, &message) == CVTFLOW_ARGUMENT && strstr(message.text, "did you mean \"keys\"") != NULL);
    CHECK(cvtflow_quantity("0.1 ms", "s", &value, NULL) == CVTFLOW_OK && value == 1e-4);
    CHECK(cvtflow_quantity("0.1 mm", "s", &value, &message) == CVTFLOW_ARGUMENT && strstr(message.text, "is a length") != NULL);
}

static void check_states(cvtflow_simulation* simulation) {
    size_t size = 0;
    void* bytes = NULL;
    uint64_t hash = 0;
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    cvtflow_simulation* copy = NULL;
    CHECK(cvtflow_state_get(simulation, NULL, &size, &message) == CVTFLOW_OK && size > 1000);
    bytes = malloc(size);
    size = 10;
    CHECK(cvtflow_state_get(simulation, bytes, &size, &message) == CVTFLOW_ARGUMENT && size > 1000);
    CHECK(cvtflow_state_get(simulation, bytes, &size, &message) == CVTFLOW_OK);
    CHECK(cvtflow_copy(simulation, &copy, &message) == CVTFLOW_OK);
    CHECK(cvtflow_advance_to(simulation, -2.8e-4, &message) == CVTFLOW_OK);
    hash = cvtflow_hash(simulation);
    CHECK(cvtflow_state_set(simulation, bytes, size, &message) == CVTFLOW_OK);
    CHECK(cvtflow_hash(simulation) != hash);
    CHECK(cvtflow_advance_to(simulation, -2.8e-4, &message) == CVTFLOW_OK);
    CHECK(cvtflow_hash(simulation) == hash);
    CHECK(cvtflow_advance_to(copy, -2.8e-4, &message) == CVTFLOW_OK);
    CHECK(cvtflow_hash(copy) == hash);
    ((char*)bytes)[size / 3] ^= 1;
    CHECK(cvtflow_state_set(simulation, bytes, size, &message) == CVTFLOW_STATE);
    CHECK(cvtflow_state_check(bytes, size, &message) == CVTFLOW_STATE && cvtflow_state_check(NULL, 0, &message) == CVTFLOW_STATE);
    cvtflow_destroy(copy);
    free(bytes);
}

static void check_channels(cvtflow_simulation* simulation) {
    cvtflow_channel_info info = CVTFLOW_INIT(cvtflow_channel_info);
    struct { uint32_t size, reserved; const char* name; } too_small = {sizeof too_small, 0, NULL};
    const double* values = NULL;
    size_t channel = 0, width = 0;
    CHECK(cvtflow_channel_count(simulation) > 40);
    CHECK(cvtflow_channel_find(simulation, "links/tension", &channel, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_channel_describe(simulation, channel, &info, NULL) == CVTFLOW_OK);
    CHECK(strcmp(info.name, "links/tension") == 0 && strcmp(info.unit, "N") == 0 && info.width == 24);
    CHECK(cvtflow_channel_describe(simulation, channel, (cvtflow_channel_info*)&too_small, NULL) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_channel_values(simulation, channel, &values, &width, NULL) == CVTFLOW_OK && width == 24 && isfinite(values[23]));
    CHECK(cvtflow_channel_find(simulation, "tension", &channel, NULL) == CVTFLOW_ARGUMENT);
}

static void check_equations(cvtflow_simulation* simulation) {
    const size_t size = cvtflow_size(simulation);
    double* out = malloc(size * sizeof *out);
    double value = 0.0, step = 0.0;
    size_t k = 0;
    CHECK(cvtflow_rhs(simulation, cvtflow_time(simulation), cvtflow_unknowns(simulation), out, size, NULL) == CVTFLOW_OK);
    for (k = 0; k < size; ++k) CHECK(isfinite(out[k]));
    CHECK(cvtflow_rhs(simulation, 0.0, cvtflow_unknowns(simulation), out, size - 1, NULL) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_input_set(simulation, CVTFLOW_LOAD_TORQUE, 7.5, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_input_get(simulation, CVTFLOW_LOAD_TORQUE, &value, NULL) == CVTFLOW_OK && value == 7.5);
    CHECK(cvtflow_input_set(simulation, CVTFLOW_RATIO, 1.0, NULL) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_largest_stable_step(simulation, &step, NULL) == CVTFLOW_OK && step > 1e-9 && step < 1e-5);
    CHECK(fabs(cvtflow_step_length(simulation) - 1e-7) < 1e-20);
    CHECK(strcmp(cvtflow_method(simulation), "rk4") == 0 && strcmp(cvtflow_method(NULL), "") == 0);
    free(out);
}

struct calls {
    int outputs;
    long transitions;
};

static int on_output(cvtflow_simulation* simulation, void* user) {
    struct calls* calls = user;
    CHECK(cvtflow_step(simulation, NULL) == CVTFLOW_BUSY);
    return ++calls->outputs == 3; /* enough */
}

static int on_transition(cvtflow_simulation* simulation, const cvtflow_transition* transition, void* user) {
    (void)simulation;
    CHECK(transition->size == sizeof *transition && transition->from != transition->to);
    ++((struct calls*)user)->transitions;
    return 0;
}

static void check_callbacks(cvtflow_simulation* simulation) {
    struct calls calls = {0, 0};
    cvtflow_counters counters = CVTFLOW_INIT(cvtflow_counters);
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    CHECK(cvtflow_on_output(simulation, 1e-5, on_output, &calls, &message) == CVTFLOW_OK);
    CHECK(cvtflow_on_transition(simulation, on_transition, &calls, &message) == CVTFLOW_OK);
    CHECK(cvtflow_advance_to(simulation, 1.0, &message) == CVTFLOW_CALLBACK);
    CHECK(calls.outputs == 3);
    CHECK(cvtflow_counters_get(simulation, &counters) == CVTFLOW_OK && counters.steps > 100);
    cvtflow_energy energy = CVTFLOW_INIT(cvtflow_energy);
    CHECK(cvtflow_energy_get(simulation, &energy) == CVTFLOW_OK && energy.reliable == 1 && energy.error_ratio <= 1.0);
    CHECK(cvtflow_on_output(simulation, 1.0, NULL, NULL, &message) == CVTFLOW_OK);
    CHECK(cvtflow_on_transition(simulation, NULL, NULL, &message) == CVTFLOW_OK);
    cvtflow_cancel(simulation);
    CHECK(cvtflow_step(simulation, &message) == CVTFLOW_CANCELLED);
    CHECK(cvtflow_step(simulation, &message) == CVTFLOW_OK);
}

/* Transitions that are pulled are those of the counter; a channel's address stays. */
static void check_pulling(const cvtflow_scene* scene) {
    cvtflow_simulation* simulation = NULL;
    cvtflow_counters counters = CVTFLOW_INIT(cvtflow_counters);
    struct { cvtflow_transition now; double more; } *rows;
    const double *before = NULL, *after = NULL;
    size_t count = 7, room = 1, channel = 0;
    CHECK(cvtflow_create(scene, NULL, &simulation, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_transitions(simulation, NULL, &count, NULL) == CVTFLOW_OK && count == 0);
    CHECK(cvtflow_channel_find(simulation, "links/tension", &channel, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_channel_values(simulation, channel, &before, NULL, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_advance_to(simulation, -2.5e-4, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_channel_values(simulation, channel, &after, NULL, NULL) == CVTFLOW_OK && after == before);
    CHECK(cvtflow_counters_get(simulation, &counters) == CVTFLOW_OK && counters.transitions > 2);
    CHECK(cvtflow_transitions(simulation, NULL, &count, NULL) == CVTFLOW_OK && count == (size_t)counters.transitions);
    rows = calloc(count, sizeof *rows); /* longer structs than the library's */
    rows[0].now.size = sizeof *rows;
    CHECK(cvtflow_transitions(simulation, &rows[0].now, &room, NULL) == CVTFLOW_ARGUMENT && room == count);
    CHECK(cvtflow_transitions(simulation, &rows[0].now, &count, NULL) == CVTFLOW_OK);
    for (size_t k = 0; k < count; ++k) CHECK(rows[k].now.from != rows[k].now.to && (k == 0 || rows[k].now.time >= rows[k - 1].now.time));
    CHECK(cvtflow_transitions(simulation, NULL, &count, NULL) == CVTFLOW_OK && count == 0);
    CHECK(cvtflow_transitions(simulation, NULL, NULL, NULL) == CVTFLOW_OK);
    free(rows);
    cvtflow_destroy(simulation);
}

#ifndef CORE_ONLY
static int end_after_two(const cvtflow_progress* progress, void* user) {
    CHECK(progress->size == sizeof *progress && progress->cases == 3);
    *(int64_t*)user = progress->done;
    return progress->done >= 2;
}

/* A record and a sweep, in the working folder. */
static void check_files(const cvtflow_scene* scene) {
    cvtflow_simulation* simulation = NULL;
    cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
    int64_t done = -1;
    FILE* file = fopen("c_program_sweep.toml", "w");
    CHECK(cvtflow_create(scene, NULL, &simulation, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_record_begin(simulation, "c_program.h5", 1, &message) == CVTFLOW_OK);
    CHECK(cvtflow_record_begin(simulation, "c_program_2.h5", 1, &message) == CVTFLOW_STATE);
    CHECK(cvtflow_advance_to(simulation, 1e-5, &message) == CVTFLOW_OK);
    CHECK(cvtflow_record_finish(simulation, 1, &message) == CVTFLOW_OK);
    CHECK(cvtflow_record_finish(simulation, 1, &message) == CVTFLOW_STATE);
    CHECK(cvtflow_record_begin(simulation, "c_program.h5", 0, &message) == CVTFLOW_RECORD); /* it is there */
    cvtflow_destroy(simulation);
    CHECK(file != NULL);
    fputs("[sweep]\nscene = \"tiny\"\n[set]\n\"run.until\" = 2e-5\n\"start.settling_time\" = 2e-5\n\"start.ramp_time\" = 1e-5\n"
          "[[axes]]\nkey = \"load.torque\"\nvalues = [6, 7, 8]\n[outputs]\nscalars = [\"slip mean\"]\n", file);
    fclose(file);
    CHECK(cvtflow_sweep_run("/nowhere.toml", NULL, 1, 0, NULL, NULL, &message) == CVTFLOW_SCENE);
    CHECK(cvtflow_sweep_run("c_program_sweep.toml", NULL, 1, 0, end_after_two, &done, &message) == CVTFLOW_OK && done == 0);
    CHECK(cvtflow_sweep_run("c_program_sweep.toml", "c_program_sweep", 1, 1, end_after_two, &done, &message) == CVTFLOW_CANCELLED);
    CHECK(done == 2);
    CHECK(cvtflow_sweep_run("c_program_sweep.toml", "c_program_sweep", 1, 0, NULL, NULL, &message) == CVTFLOW_OK);
}
#endif

static void check_texts(const cvtflow_scene* scene) {
    size_t size = 0, small = 3;
    char value[16], *text;
    CHECK(cvtflow_scene_text(scene, NULL, &size, NULL) == CVTFLOW_OK && size > 1000);
    text = malloc(size);
    CHECK(cvtflow_scene_text(scene, text, &size, NULL) == CVTFLOW_OK && strlen(text) + 1 == size && strstr(text, "[chain]") != NULL);
    free(text);
    CHECK(cvtflow_scene_value(scene, "run.step", value, &small, NULL) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_scene_value(scene, "run.step", value, &small, NULL) == CVTFLOW_OK && strcmp(value, "1e-7") == 0);
    CHECK(cvtflow_scene_value(scene, "run.stop", NULL, &small, NULL) == CVTFLOW_ARGUMENT);
}

static void check_inputs(void) {
    cvtflow_channel_info info = CVTFLOW_INIT(cvtflow_channel_info);
    int32_t number = 0;
    while (cvtflow_input_describe(number, &info, NULL) == CVTFLOW_OK) ++number;
    CHECK(number == CVTFLOW_PRESSURE_DRIVEN + 1);
    CHECK(cvtflow_input_describe(CVTFLOW_LOAD_TORQUE, &info, NULL) == CVTFLOW_OK);
    CHECK(strcmp(info.name, "load_torque") == 0 && strcmp(info.unit, "N*m") == 0 && info.width == 1);
}

static void keep_line(const char* line, void* user) {
    snprintf(user, 200, "%s", line);
}

static void check_log(cvtflow_simulation* simulation) {
    char line[200] = "";
    CHECK(cvtflow_notices(simulation, NULL, NULL, NULL) == CVTFLOW_ARGUMENT);
    CHECK(cvtflow_notices(simulation, keep_line, line, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_on_log(simulation, keep_line, line, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_advance_to(simulation, -1.0, NULL) == CVTFLOW_ARGUMENT); /* back in time */
    CHECK(strstr(line, "to go back, set a state") != NULL);
    CHECK(cvtflow_on_log(simulation, NULL, NULL, NULL) == CVTFLOW_OK);
    line[0] = 0;
    CHECK(cvtflow_advance_to(simulation, -1.0, NULL) == CVTFLOW_ARGUMENT && line[0] == 0);
}

/* The level of detail whose method keeps its state itself: stepped, copied, saved and restored. */
static void check_rigid_pins(const cvtflow_scene* scene) {
    const char* settings[] = {"run.method=auto", "run.step=1 us"};
    cvtflow_scene* level = NULL;
    cvtflow_scene* rigid = NULL;
    cvtflow_simulation* simulation = NULL;
    cvtflow_options options = CVTFLOW_INIT(cvtflow_options);
    const double* values = NULL;
    size_t channel = 0, width = 0;
    FULL(options.way = CVTFLOW_PRIVATE_ARENA; options.threads = 2;)
    CHECK(cvtflow_scene_with_detail(scene, "rigid", &level, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_scene_with(level, settings, 2, &rigid, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_create(rigid, &options, &simulation, NULL) == CVTFLOW_OK);
    CHECK(strcmp(cvtflow_method(simulation), "leapfrog-rigid") == 0);
    CHECK(cvtflow_advance_to(simulation, -2.9e-4, NULL) == CVTFLOW_OK);
    check_states(simulation);
    CHECK(cvtflow_channel_find(simulation, "tight_tension", &channel, NULL) == CVTFLOW_OK);
    CHECK(cvtflow_advance_to(simulation, 0.0, NULL) == CVTFLOW_OK); /* its clamping is there; it began with a pull of 14 N */
    CHECK(cvtflow_channel_values(simulation, channel, &values, &width, NULL) == CVTFLOW_OK && width == 1 && values[0] > 100.0);
    cvtflow_destroy(simulation);
    cvtflow_scene_release(rigid);
    cvtflow_scene_release(level);
}

static int calls_after_destroy = 0;

static int destroy_at_output(cvtflow_simulation* simulation, void* user) {
    (void)user;
    ++calls_after_destroy;
    cvtflow_destroy(simulation);
    cvtflow_destroy(simulation); /* again, as long as the callback runs */
    return 0;
}
static int destroy_at_transition(cvtflow_simulation* simulation, const cvtflow_transition* transition, void* user) {
    (void)transition;
    return destroy_at_output(simulation, user);
}
static void destroy_at_log(const char* line, void* user) {
    (void)line;
    ++calls_after_destroy;
    cvtflow_destroy((cvtflow_simulation*)user);
}

/* A simulation destroyed by a callback that it runs: that call ends cancelled, and nothing is called any more. */
static void check_destruction(const cvtflow_scene* scene) {
    for (int way = 0; way < 3; ++way) {
        cvtflow_simulation* simulation = NULL;
        cvtflow_message message = CVTFLOW_INIT(cvtflow_message);
        CHECK(cvtflow_create(scene, NULL, &simulation, NULL) == CVTFLOW_OK);
        calls_after_destroy = 0;
        if (way == 0) CHECK(cvtflow_on_output(simulation, 1e-5, destroy_at_output, NULL, NULL) == CVTFLOW_OK);
        if (way == 1) CHECK(cvtflow_on_transition(simulation, destroy_at_transition, NULL, NULL) == CVTFLOW_OK);
        CHECK(cvtflow_on_log(simulation, destroy_at_log, simulation, NULL) == CVTFLOW_OK);
        if (way == 2) {
            CHECK(cvtflow_advance_to(simulation, NAN, &message) == CVTFLOW_ARGUMENT); /* logged */
        } else {
            CHECK(cvtflow_advance_to(simulation, 0.0, &message) == CVTFLOW_CANCELLED);
            CHECK(strstr(message.text, "destroyed") != NULL);
        }
        CHECK(calls_after_destroy == 1);
    }
}

int main(int argc, char** argv) {
    cvtflow_scene* scene = argc > 1 ? brief_scene(argv[1]) : NULL;
    cvtflow_simulation* simulation = NULL;
    cvtflow_options options = CVTFLOW_INIT(cvtflow_options);
    if (scene == NULL) return 2;
    check_errors(scene);
    check_texts(scene);
    check_long_messages();
    check_knowledge();
    check_pulling(scene);
    FULL(check_files(scene);)
    check_inputs();
    check_rigid_pins(scene);
    check_destruction(scene);
    FULL(options.way = CVTFLOW_PRIVATE_ARENA; options.threads = 2;)
    CHECK(cvtflow_create(scene, &options, &simulation, NULL) == CVTFLOW_OK);
    cvtflow_scene_release(scene); /* the simulation keeps what it needs */
    CHECK(cvtflow_advance_to(simulation, -2.9e-4, NULL) == CVTFLOW_OK);
    check_states(simulation);
    check_channels(simulation);
    check_equations(simulation);
    check_callbacks(simulation);
    check_log(simulation);
    cvtflow_destroy(simulation);
    FULL(CHECK(cvtflow_shutdown() == CVTFLOW_OK);)
    printf("cvtflow %s: %s\n", cvtflow_version(), failures == 0 ? "all as promised" : "something is not as promised");
    return failures == 0 ? 0 : 1;
}
