/* C interface of cvtflow: opaque handles, error codes, no exception and no C++ type crosses it.
 *
 * This is the library: the C++ interface is made of inline functions over it (simulation.hpp), the Python package calls it by ctypes.
 *
 * Stability (version.hpp): a program built against 0.x runs with every 0.x.y, whose library is named
 * libcvtflow.so.0.x; one built against 1.x with every later 1.y. Within that, functions are never removed or changed, only added (symbol
 * version CVTFLOW_1). Structs that grow begin with their size in bytes, set by the caller (CVTFLOW_INIT does it): the library touches no
 * member beyond it.
 *
 * Errors. Functions that can fail return a code, CVTFLOW_OK = 0, and fill the message, the last argument, which may be NULL. Nothing else
 * is changed by a call that fails, except that cvtflow_advance_to and cvtflow_step leave the simulation at the last accepted step.
 *
 * Texts and bytes. Functions that give a text, or bytes, take (buffer, &size): size is the room in the buffer on entry, and what is needed
 * on return, the 0 behind a text included. A buffer NULL asks for the size; CVTFLOW_ARGUMENT if the room is too small.
 *
 * Threads. A scene may be used from all threads. A simulation is used by one thread at a time; a call while another one is under way
 * returns CVTFLOW_BUSY. cvtflow_cancel may be called from every thread and from signal handlers. No thread is started before the first
 * step. Callbacks run on the thread that called cvtflow_advance_to, between steps. A callback that steps the calling simulation or sets its
 * state gets CVTFLOW_BUSY. A callback may destroy that simulation: no further callback is called, the call that runs the callback returns
 * CVTFLOW_CANCELLED after at most one step, and the simulation is freed when that call returns. See simulation.hpp for details.
 */
#ifndef CVTFLOW_CVTFLOW_H
#define CVTFLOW_CVTFLOW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if !defined(_WIN32)
#define CVTFLOW_API __attribute__((visibility("default")))
#elif defined(CVTFLOW_BUILDING) /* cvtflow.dll itself */
#define CVTFLOW_API __declspec(dllexport)
#elif defined(CVTFLOW_STATIC) /* linked into the host */
#define CVTFLOW_API
#else
#define CVTFLOW_API __declspec(dllimport)
#endif

typedef enum cvtflow_code {
    CVTFLOW_OK = 0,
    CVTFLOW_ARGUMENT = 1,     /* value out of range, wrong length, unknown name, NULL */
    CVTFLOW_SCENE = 2,        /* the scene cannot be read or has problems */
    CVTFLOW_START_STATE = 3,  /* the scene's state file */
    CVTFLOW_STATE = 4,        /* a saved state of another scene or version, or damaged */
    CVTFLOW_BUSY = 5,         /* stepped by another thread, or called from a callback of it */
    CVTFLOW_FORKED = 6,       /* ran on threads before this process was forked off */
    CVTFLOW_CANCELLED = 7,    /* the simulation can go on */
    CVTFLOW_MEMORY = 8,
    CVTFLOW_INTERNAL = 9,     /* a defect of cvtflow */
    CVTFLOW_CALLBACK = 10,    /* a callback returned other than 0 */
    CVTFLOW_RECORD = 11,      /* a record, table or folder cannot be read or written */
    CVTFLOW_NON_FINITE = 20,  /* from here on: why a simulation cannot go on */
    CVTFLOW_PENETRATION = 21,
    CVTFLOW_LEFT_SHEAVE = 22,
    CVTFLOW_MAX_STEPS = 23,
    CVTFLOW_MAX_WALL = 24,
    CVTFLOW_BLOW_UP = 25,
    CVTFLOW_OTHER_FAULT = 39
} cvtflow_code;

typedef struct cvtflow_scene cvtflow_scene;
typedef struct cvtflow_simulation cvtflow_simulation;

/* What went wrong, in words: a string that ends in 0, cut off if it does not fit. A scene with many wrong keys has a line for each: a caller
 * that shows all of them passes a larger struct that begins as this one, with its size. */
typedef struct cvtflow_message {
    uint32_t size; /* of the caller's struct, which may be longer or shorter than this one; 0: of this one */
    int32_t code;
    char text[1016];
} cvtflow_message;

/* Who does the work; see threads.hpp. */
typedef enum cvtflow_way {
    CVTFLOW_CALLER = 0,        /* the calling thread alone */
    CVTFLOW_CURRENT_ARENA = 1, /* the oneTBB arena in which the call is made */
    CVTFLOW_PRIVATE_ARENA = 2  /* an arena of the simulation */
} cvtflow_way;

typedef struct cvtflow_options {
    uint32_t size;
    int32_t way;      /* cvtflow_way */
    int32_t threads;  /* of the current or private arena, the caller included; 0: all that the process may use (private only) */
    int32_t segments; /* tasks per step; 0: one per thread */
} cvtflow_options;

typedef enum cvtflow_input {
    CVTFLOW_CLAMPING_DRIVING = 0, /* S_1 [N], not with hydraulics.mode = "pressure" */
    CVTFLOW_CLAMPING_DRIVEN = 1,  /* S_2 [N], likewise */
    CVTFLOW_LOAD_TORQUE = 2,      /* [N m], load.mode = "torque" */
    CVTFLOW_DRIVE_TORQUE = 3,     /* [N m], drive.mode = "torque" */
    CVTFLOW_DRIVE_SPEED = 4,      /* [rad/s], of shaft 1, drive.mode = "speed", or of the far end, "coupling" */
    CVTFLOW_RATIO = 5,            /* [1], control.enabled */
    CVTFLOW_LOAD_SPEED = 6,       /* [rad/s], of shaft 2, load.mode = "speed", or of the far end, "coupling" */
    CVTFLOW_LOAD_ANGLE = 7,       /* [rad], turned by the far end since t = 0, load.mode = "coupling" */
    CVTFLOW_DRIVE_ANGLE = 8,      /* [rad], turned by the far end since t = 0, drive.mode = "coupling" */
    CVTFLOW_PRESSURE_DRIVING = 9, /* [Pa], hydraulics.mode = "pressure" */
    CVTFLOW_PRESSURE_DRIVEN = 10  /* [Pa], hydraulics.mode = "pressure" */
} cvtflow_input;

typedef struct cvtflow_counters {
    uint32_t size;
    uint32_t reserved;
    int64_t steps, evaluations, transitions, truncated, suppressed;
} cvtflow_counters;

/* Energy balance, and whether results are reliable, since the start (after settling, since t = 0). */
typedef struct cvtflow_energy {
    uint32_t size;
    int32_t reliable;  /* 0: results are wrong, take a shorter step or run.step = "auto" */
    double residual;   /* change of the stored energy - work of the inputs + losses [J] */
    double dissipated; /* [J] */
    double error_ratio; /* |residual| over what an honest integration may leave; above 1 unreliable */
} cvtflow_energy;

/* Strings live as long as the library is loaded. */
typedef struct cvtflow_channel_info {
    uint32_t size;
    uint32_t reserved;
    const char* name;
    const char* unit;
    const char* description;
    size_t width;
} cvtflow_channel_info;

typedef struct cvtflow_transition {
    uint32_t size;
    int32_t pin, tip, from, to; /* phases: 0 free, 1 touching, 2 sticking, 3 slipping */
    uint32_t reserved;
    double time; /* [s] */
} cvtflow_transition;

/* An initialiser of a versioned struct: cvtflow_options options = CVTFLOW_INIT(cvtflow_options); */
#ifdef __cplusplus
#define CVTFLOW_INIT(type) ([] { type made{}; made.size = sizeof(type); return made; }())
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define CVTFLOW_INIT(type) {.size = sizeof(type)}
#else
#define CVTFLOW_INIT(type) {sizeof(type)} /* C89 knows no names here; size is the first member of them all */
#endif

/* Other than 0 ends cvtflow_advance_to with CVTFLOW_CALLBACK. */
typedef int (*cvtflow_output_function)(cvtflow_simulation* simulation, void* user);
/* A line about what a user should know; lives until the function returns. */
typedef void (*cvtflow_log_function)(const char* line, void* user);
typedef int (*cvtflow_transition_function)(cvtflow_simulation* simulation, const cvtflow_transition* transition, void* user);

CVTFLOW_API const char* cvtflow_version(void);              /* "0.4.0" */
CVTFLOW_API const char* cvtflow_code_name(int32_t code);    /* "cancelled"; "unknown" for a number that is no code */
/* What the library knows, as JSON in UTF-8: what is "build" (version, commit, its date), "codes", "exit_statuses" (of the program), "keys" (of scenes, with unit, range, default,
 * source), "channels", "inputs", "notes" (on unusual results), "units", "scenes" (ready ones), "levels" (of detail), "methods"; NULL: an object
 * of all of them. Numbers are in SI units. */
CVTFLOW_API cvtflow_code cvtflow_describe(const char* what, char* text, size_t* size, cvtflow_message* message);
/* A quantity with its unit, in SI: ("0.1 ms", "s") is 1e-4. unit is the SI unit that is expected, "1" for a plain number; CVTFLOW_ARGUMENT for
 * another dimension. */
CVTFLOW_API cvtflow_code cvtflow_quantity(const char* text, const char* unit, double* value, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_shutdown(void);            /* ends worker threads; CVTFLOW_BUSY if others keep them alive */

/* Scenes: immutable, counted. */
CVTFLOW_API cvtflow_code cvtflow_scene_read(const char* path, cvtflow_scene** scene, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_scene_parse(const char* text, const char* name, cvtflow_scene** scene, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_scene_ready(const char* name, cvtflow_scene** scene, cvtflow_message* message);
/* A new scene with settings "key=value". */
CVTFLOW_API cvtflow_code cvtflow_scene_with(const cvtflow_scene* scene, const char* const* settings, size_t count, cvtflow_scene** changed,
                                            cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_scene_with_detail(const cvtflow_scene* scene, const char* preset, cvtflow_scene** changed,
                                                   cvtflow_message* message);
CVTFLOW_API const char* cvtflow_scene_name(const cvtflow_scene* scene); /* lives as long as the scene */
/* The scene as TOML with every key; and the value of one key, as TOML. */
CVTFLOW_API cvtflow_code cvtflow_scene_text(const cvtflow_scene* scene, char* text, size_t* size, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_scene_value(const cvtflow_scene* scene, const char* key, char* text, size_t* size,
                                             cvtflow_message* message);
CVTFLOW_API void cvtflow_scene_release(cvtflow_scene* scene);           /* NULL is allowed; simulations keep what they need */

/* Simulations. options may be NULL: the caller alone. */
CVTFLOW_API cvtflow_code cvtflow_create(const cvtflow_scene* scene, const cvtflow_options* options, cvtflow_simulation** simulation,
                                        cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_copy(const cvtflow_simulation* from, cvtflow_simulation** copy, cvtflow_message* message);
CVTFLOW_API void cvtflow_destroy(cvtflow_simulation* simulation); /* NULL is allowed */

/* The method of its steps, never "auto"; lives as long as the simulation. */
CVTFLOW_API const char* cvtflow_method(const cvtflow_simulation* simulation);
CVTFLOW_API double cvtflow_time(const cvtflow_simulation* simulation);        /* [s] */
CVTFLOW_API double cvtflow_step_length(const cvtflow_simulation* simulation); /* [s] */
/* Takes whole steps until the time [s] is reached. A time that lies more than a step back is CVTFLOW_ARGUMENT. */
CVTFLOW_API cvtflow_code cvtflow_advance_to(cvtflow_simulation* simulation, double time, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_step(cvtflow_simulation* simulation, cvtflow_message* message);
CVTFLOW_API void cvtflow_cancel(cvtflow_simulation* simulation);
CVTFLOW_API cvtflow_code cvtflow_largest_stable_step(cvtflow_simulation* simulation, double* step, cvtflow_message* message);

/* Full integration state as bytes. */
CVTFLOW_API cvtflow_code cvtflow_state_get(const cvtflow_simulation* simulation, void* bytes, size_t* size, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_state_set(cvtflow_simulation* simulation, const void* bytes, size_t size, cvtflow_message* message);
/* CVTFLOW_STATE for bytes that are damaged or of another version. */
CVTFLOW_API cvtflow_code cvtflow_state_check(const void* bytes, size_t size, cvtflow_message* message);
CVTFLOW_API uint64_t cvtflow_hash(const cvtflow_simulation* simulation);

/* value may be set between steps and from callbacks. */
CVTFLOW_API cvtflow_code cvtflow_input_set(cvtflow_simulation* simulation, int32_t input, double value, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_input_get(const cvtflow_simulation* simulation, int32_t input, double* value, cvtflow_message* message);

/* Unknowns and right-hand side. */
CVTFLOW_API size_t cvtflow_size(const cvtflow_simulation* simulation);
CVTFLOW_API const double* cvtflow_unknowns(const cvtflow_simulation* simulation); /* [size], valid until the next step */
CVTFLOW_API cvtflow_code cvtflow_rhs(cvtflow_simulation* simulation, double time, const double* x, double* out, size_t size,
                                     cvtflow_message* message);

/* Channels: what there is to see, by number or name. */
CVTFLOW_API size_t cvtflow_channel_count(const cvtflow_simulation* simulation);
CVTFLOW_API cvtflow_code cvtflow_channel_describe(const cvtflow_simulation* simulation, size_t channel, cvtflow_channel_info* info,
                                                  cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_channel_find(const cvtflow_simulation* simulation, const char* name, size_t* channel,
                                              cvtflow_message* message);
/* The values of a channel now: *values has *width numbers, in the unit of the channel. The address stays the same as long as the simulation
 * lives; the numbers there change with the next call for this channel only. The first call after a step observes the whole state, some tens
 * of microseconds. width may be NULL. */
CVTFLOW_API cvtflow_code cvtflow_channel_values(cvtflow_simulation* simulation, size_t channel, const double** values, size_t* width,
                                                cvtflow_message* message);

CVTFLOW_API cvtflow_code cvtflow_counters_get(const cvtflow_simulation* simulation, cvtflow_counters* counters);

/* Calls function(line, user) for every notice: differences to the state file's scene, keys without effect, an energy balance that does
 * not close, threads that were unavailable. */
CVTFLOW_API cvtflow_code cvtflow_notices(const cvtflow_simulation* simulation, cvtflow_log_function function, void* user,
                                         cvtflow_message* message);
/* From now on function(line, user) is called after every cvtflow_advance_to and cvtflow_step on the calling thread with every notice that is
 * new, and with what made the call fail. NULL removes it. */
CVTFLOW_API cvtflow_code cvtflow_on_log(cvtflow_simulation* simulation, cvtflow_log_function function, void* user, cvtflow_message* message);

CVTFLOW_API cvtflow_code cvtflow_energy_get(const cvtflow_simulation* simulation, cvtflow_energy* energy);

/* One function of each kind per simulation; NULL removes it. on_output: after the first step at or after every multiple of interval [s]. */
CVTFLOW_API cvtflow_code cvtflow_on_output(cvtflow_simulation* simulation, double interval, cvtflow_output_function function, void* user,
                                           cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_on_transition(cvtflow_simulation* simulation, cvtflow_transition_function function, void* user,
                                               cvtflow_message* message);
/* Transitions without a callback: those since the last call, in their order. They are collected from the first call on, until one with count
 * NULL. *count is the room at transitions on entry and their number on return; transitions NULL asks for it, and CVTFLOW_ARGUMENT for too
 * little room leaves them. The caller sets the size of the first. */
CVTFLOW_API cvtflow_code cvtflow_transitions(cvtflow_simulation* simulation, cvtflow_transition* transitions, size_t* count,
                                             cvtflow_message* message);

/* Records the simulation from now on in an HDF5 file: channels, states and transitions at the scene's run.output_interval, as `cvtflow run`
 * does, but no settling. replace other than 0 replaces a file, or rows of a run that was killed. CVTFLOW_RECORD for files, CVTFLOW_STATE if it
 * is being recorded already. finish completes the file; complete 0 marks it as cancelled, -1 leaves what has been recorded in the .part file, as
 * does a simulation that is destroyed before. Not in the core library. */
CVTFLOW_API cvtflow_code cvtflow_record_begin(cvtflow_simulation* simulation, const char* path, int32_t replace, cvtflow_message* message);
CVTFLOW_API cvtflow_code cvtflow_record_finish(cvtflow_simulation* simulation, int32_t complete, cvtflow_message* message);
/* CVTFLOW_RECORD for a file that has changed since it was finished, by the checksum of all its bytes. Not in the core library. */
CVTFLOW_API cvtflow_code cvtflow_record_check(const char* path, cvtflow_message* message);

/* Inputs: what they are, by number from 0 on; CVTFLOW_ARGUMENT behind the last one. Strings live as long as the library is loaded; width is 1. */
CVTFLOW_API cvtflow_code cvtflow_input_describe(int32_t input, cvtflow_channel_info* info, cvtflow_message* message);

/* Progress of a sweep; numbers of cases. */
typedef struct cvtflow_progress {
    uint32_t size;
    uint32_t reserved;
    int64_t cases;  /* all */
    int64_t before; /* done in earlier sessions */
    int64_t done;   /* done now */
    int64_t failed; /* done now with another status than ok */
    double wall;    /* [s] */
} cvtflow_progress;
/* Other than 0 ends the sweep. */
typedef int (*cvtflow_progress_function)(const cvtflow_progress* progress, void* user);

/* Runs the cases of a sweep file that have no row in the folder yet, and waits for them, as `cvtflow batch` does. One with [accuracy] is
 * refused (CVTFLOW_ARGUMENT): `cvtflow batch` runs it. folder NULL: checks the file, and calls the function once. threads 0: as many as
 * the process may use. keep_going other than 0 runs all cases, also where the first dozen fail alike. The function, if not NULL, is called
 * from one thread at a time, of the library: before the first case, after each, and every 50 ms while cases step. CVTFLOW_CANCELLED if it
 * ends the sweep, whose running cases then run again later; CVTFLOW_SCENE for the file; CVTFLOW_RECORD for folders and tables;
 * CVTFLOW_STATE for results of another sweep, program version or start state, or where the first dozen cases all fail alike. Not in the
 * core library. */
CVTFLOW_API cvtflow_code cvtflow_sweep_run(const char* file, const char* folder, int32_t threads, int32_t keep_going,
                                           cvtflow_progress_function function, void* user, cvtflow_message* message);

#ifdef __cplusplus
}
#endif

#endif
