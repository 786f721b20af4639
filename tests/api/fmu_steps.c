/* Steps an FMU's library, on Linux or Windows, and prints the bits of its variables after every step.

       fmu_steps LIBRARY RESOURCES VERSION STEPS LENGTH INPUT VALUE REFERENCE...      RESOURCES: path (3.0) or URI (2.0); LENGTH [s]

   Half-way through the input with reference INPUT becomes VALUE. On Linux the locale is that of the environment. */

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void* opened(const char* path) { return (void*)LoadLibraryA(path); }
static void* symbol(void* library, const char* name) { return (void*)GetProcAddress((HMODULE)library, name); }
#else
#include <dlfcn.h>
#include <locale.h>
static void* opened(const char* path) { return dlopen(path, RTLD_NOW); }
static void* symbol(void* library, const char* name) { return dlsym(library, name); }
#endif

typedef struct {
    void (*logger)(void*, const char*, int, const char*, const char*, ...);
    void* (*allocate)(size_t, size_t);
    void (*release)(void*);
    void (*finished)(void*, int);
    void* environment;
} Callbacks;

static void log_2(void* environment, const char* name, int status, const char* category, const char* text, ...) {
    (void)environment, (void)name, (void)text;
    fprintf(stderr, "status %d, %s\n", status, category);
}
static void log_3(void* environment, int status, const char* category, const char* text) {
    (void)environment;
    fprintf(stderr, "status %d, %s: %s\n", status, category, text);
}

static void* library;
static int version;

static void* function(const char* name) {
    char full[80];
    snprintf(full, sizeof full, "fmi%d%s", version, name);
    void* found = symbol(library, full);
    if (!found) fprintf(stderr, "no %s\n", full), exit(3);
    return found;
}
static void check(int status, const char* what) {
    if (status > 1) fprintf(stderr, "%s: status %d\n", what, status), exit(4);
}

static void* begin(const char* resources) {
    static const Callbacks callbacks = {log_2, calloc, free, NULL, NULL};
    void* c = NULL;
    if (version == 2) {
        c = ((void* (*)(const char*, int, const char*, const char*, const Callbacks*, int, int))function("Instantiate"))(
            "one", 1, "", resources, &callbacks, 0, 1);
        if (!c) exit(5);
        check(((int (*)(void*, int, double, double, int, double))function("SetupExperiment"))(c, 0, 0.0, 0.0, 0, 0.0), "setup");
        check(((int (*)(void*))function("EnterInitializationMode"))(c), "enter");
    } else {
        c = ((void* (*)(const char*, const char*, const char*, bool, bool, bool, bool, const unsigned*, size_t, void*, void*, void*))
                 function("InstantiateCoSimulation"))("one", "", resources, false, true, false, false, NULL, 0, NULL, (void*)log_3, NULL);
        if (!c) exit(5);
        check(((int (*)(void*, bool, double, double, bool, double))function("EnterInitializationMode"))(c, false, 0.0, 0.0, false, 0.0),
              "enter");
    }
    check(((int (*)(void*))function("ExitInitializationMode"))(c), "exit");
    return c;
}

static void set(void* c, unsigned reference, double value) {
    if (version == 2)
        check(((int (*)(void*, const unsigned*, size_t, const double*))function("SetReal"))(c, &reference, 1, &value), "set");
    else
        check(((int (*)(void*, const unsigned*, size_t, const double*, size_t))function("SetFloat64"))(c, &reference, 1, &value, 1), "set");
}
static double get(void* c, unsigned reference) {
    double value = 0.0;
    if (version == 2)
        check(((int (*)(void*, const unsigned*, size_t, double*))function("GetReal"))(c, &reference, 1, &value), "get");
    else
        check(((int (*)(void*, const unsigned*, size_t, double*, size_t))function("GetFloat64"))(c, &reference, 1, &value, 1), "get");
    return value;
}
static void step(void* c, double time, double length) {
    if (version == 2) {
        check(((int (*)(void*, double, double, int))function("DoStep"))(c, time, length, 1), "step");
    } else {
        bool event, terminate, early;
        double reached;
        check(((int (*)(void*, double, double, bool, bool*, bool*, bool*, double*))function("DoStep"))(c, time, length, true, &event,
                                                                                                    &terminate, &early, &reached),
              "step");
    }
}

int main(int count, char** words) {
    if (count < 9) return 2;
#ifndef _WIN32
    setlocale(LC_ALL, "");
#endif
    library = opened(words[1]);
    if (!library) return fprintf(stderr, "%s: cannot be loaded\n", words[1]), 3;
    version = atoi(words[3]);
    void* c = begin(words[2]);
    const int steps = atoi(words[4]);
    const double length = atof(words[5]);
    double time = 0.0;
    for (int number = 0; number <= steps; ++number) {
        for (int word = 8; word < count; ++word) {
            const double value = get(c, (unsigned)atoi(words[word]));
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            printf("%d %s %016" PRIx64 "\n", number, words[word], bits);
        }
        if (number == steps / 2) set(c, (unsigned)atoi(words[6]), atof(words[7]));
        if (number < steps) step(c, time, length);
        time += length;
    }
    check(((int (*)(void*))function("Terminate"))(c), "terminate");
    ((void (*)(void*))function("FreeInstance"))(c);
    return 0;
}
