/* Makes a call of the system's library fail (LD_PRELOAD), to see what a program makes of it.
 *
 *     CVTFLOW_FAULT=write:3     the third call of write (or one of its relatives) fails
 *     CVTFLOW_FAULT=write:3+    the third and all later ones
 *     CVTFLOW_FAULT=threads:2   pthread_create fails while 2 threads that it made live, as under ulimit -u
 *     CVTFLOW_FAULT_COUNTS=FILE at exit, "name calls failed" of every family is added to FILE, by every process that ends
 *
 *     CVTFLOW_APPEARS=FILE      another program writes "mine" to FILE when a file NAME.part is synced first, NAME as in FILE, or the files
 *                               of FOLDER.part, FOLDER as in FILE
 *
 * Families: open, read, write, fsync, rename, mmap, malloc, pthread_create, threads, truncate, lock.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum Family { OPEN, READ, WRITE, FSYNC, RENAME, MMAP, MALLOC, CREATE, THREADS, TRUNCATE, LOCK, FAMILIES };
static const char* const names[FAMILIES] = {"open",   "read",           "write",   "fsync",    "rename", "mmap",
                                            "malloc", "pthread_create", "threads", "truncate", "lock"};
static const int reasons[FAMILIES] = {EMFILE, EIO, ENOSPC, EIO, EIO, ENOMEM, ENOMEM, EAGAIN, EAGAIN, ENOSPC, ENOLCK};

static atomic_long calls[FAMILIES], failed[FAMILIES], living;
static int family = -1, lasting, counting;
static long nth;

/* Before anything else of the program; allocates nothing. */
__attribute__((constructor)) static void read_setting(void) {
    const char* setting = getenv("CVTFLOW_FAULT");
    const char* colon = setting != NULL ? strchr(setting, ':') : NULL;
    for (int k = 0; colon != NULL && k < FAMILIES; ++k) {
        if (strlen(names[k]) == (size_t)(colon - setting) && strncmp(names[k], setting, (size_t)(colon - setting)) == 0) family = k;
    }
    if (colon != NULL) nth = strtol(colon + 1, NULL, 10);
    lasting = colon != NULL && strchr(colon, '+') != NULL;
    counting = 1;
}

/* Whether this call shall fail; errno is set then. */
static int fails(enum Family which) {
    if (!counting) return 0;
    const long number = atomic_fetch_add(&calls[which], 1) + 1;
    if ((int)which != family || !(number == nth || (lasting && number > nth))) return 0;
    atomic_fetch_add(&failed[which], 1);
    errno = reasons[which];
    return 1;
}

__attribute__((destructor)) static void write_counts(void) {
    const char* path = getenv("CVTFLOW_FAULT_COUNTS");
    if (path == NULL) return;
    const int file = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND, 0600);
    for (int k = 0; file >= 0 && k < FAMILIES; ++k) {
        char line[96];
        const int length = snprintf(line, sizeof line, "%s %ld %ld\n", names[k], atomic_load(&calls[k]), atomic_load(&failed[k]));
        if (syscall(SYS_write, file, line, length) != length) break;
    }
    if (file >= 0) syscall(SYS_close, file);
}

/* Children that were forked end this way, without destructors. Their calls are counted on from where they were forked. */
void _exit(int status) {
    write_counts();
    syscall(SYS_exit_group, status);
    __builtin_unreachable();
}

/* The function that would have been called. */
#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define CACHED(name)               \
    static __typeof__(&name) real; \
    if (real == NULL) real = REAL(name)

/* A row per function: value, name, family, value when it fails, parameters, arguments. */
#define FAILS(type, name, which, failure, parameters, arguments) \
    type name parameters {                                       \
        CACHED(name);                                            \
        return fails(which) ? failure : real arguments;          \
    }

#define OPENS(name)                                                                          \
    int name(const char* path, int flags, ...) {                                             \
        va_list rest;                                                                        \
        va_start(rest, flags);                                                               \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0; \
        va_end(rest);                                                                        \
        CACHED(name);                                                                        \
        return fails(OPEN) ? -1 : real(path, flags, mode);                                   \
    }
OPENS(open)
OPENS(open64)
FAILS(FILE*, fopen, OPEN, NULL, (const char* path, const char* mode), (path, mode))
FAILS(FILE*, fopen64, OPEN, NULL, (const char* path, const char* mode), (path, mode))

FAILS(ssize_t, read, READ, -1, (int file, void* to, size_t size), (file, to, size))
FAILS(ssize_t, pread, READ, -1, (int file, void* to, size_t size, off_t at), (file, to, size, at))
FAILS(ssize_t, pread64, READ, -1, (int file, void* to, size_t size, off64_t at), (file, to, size, at))

FAILS(ssize_t, write, WRITE, -1, (int file, const void* from, size_t size), (file, from, size))
FAILS(ssize_t, writev, WRITE, -1, (int file, const struct iovec* from, int count), (file, from, count))
FAILS(ssize_t, pwrite, WRITE, -1, (int file, const void* from, size_t size, off_t at), (file, from, size, at))
FAILS(ssize_t, pwrite64, WRITE, -1, (int file, const void* from, size_t size, off64_t at), (file, from, size, at))
FAILS(size_t, fwrite, WRITE, 0, (const void* from, size_t size, size_t count, FILE* file), (from, size, count, file))
FAILS(int, fflush, WRITE, EOF, (FILE * file), (file))

/* Another program's file takes the name of one that is complete but for its name. */
static void let_appear(int file) {
    const char* other = getenv("CVTFLOW_APPEARS");
    char link[64], path[4096];
    if (other == NULL) return;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    const char* name = strrchr(other, '/');
    const size_t size = name != NULL ? strlen(name) : 0;
    if (length < 5 || name == NULL || strncmp(path + length - 5, ".part", 5) != 0) return;
    const int of_file = length >= (ssize_t)size + 5 && strncmp(path + length - size - 5, name, size) == 0;
    const int of_folder = length == name - other + 5 && strncmp(path, other, (size_t)(name - other)) == 0;
    if (!of_file && !of_folder) return;
    const int made = (int)syscall(SYS_openat, AT_FDCWD, other, O_WRONLY | O_CREAT | O_EXCL, 0600);
    if (made < 0) return;
    if (syscall(SYS_write, made, "mine\n", 5) != 5) abort();
    syscall(SYS_close, made);
}

int fsync(int file) {
    CACHED(fsync);
    let_appear(file);
    return fails(FSYNC) ? -1 : real(file);
}
int syncfs(int file) {
    CACHED(syncfs);
    let_appear(file);
    return fails(FSYNC) ? -1 : real(file);
}
FAILS(int, fdatasync, FSYNC, -1, (int file), (file))
FAILS(int, rename, RENAME, -1, (const char* from, const char* to), (from, to))
FAILS(int, renameat2, RENAME, -1, (int from_folder, const char* from, int to_folder, const char* to, unsigned int flags),
      (from_folder, from, to_folder, to, flags))
FAILS(int, ftruncate, TRUNCATE, -1, (int file, off_t size), (file, size))
FAILS(int, ftruncate64, TRUNCATE, -1, (int file, off64_t size), (file, size))
FAILS(int, fallocate, TRUNCATE, -1, (int file, int mode, off_t at, off_t size), (file, mode, at, size))
FAILS(int, fallocate64, TRUNCATE, -1, (int file, int mode, off64_t at, off64_t size), (file, mode, at, size))

#define CONTROLS(name)                                                    \
    int name(int file, int command, ...) {                                \
        va_list rest;                                                     \
        va_start(rest, command);                                          \
        void* argument = va_arg(rest, void*);                             \
        va_end(rest);                                                     \
        CACHED(name);                                                     \
        const int locks = command == F_OFD_SETLK || command == F_SETLK;   \
        return locks && fails(LOCK) ? -1 : real(file, command, argument); \
    }
CONTROLS(fcntl)
CONTROLS(fcntl64)

FAILS(void*, mmap, MMAP, MAP_FAILED, (void* where, size_t size, int protection, int flags, int file, off_t at),
      (where, size, protection, flags, file, at))
FAILS(void*, mmap64, MMAP, MAP_FAILED, (void* where, size_t size, int protection, int flags, int file, off64_t at),
      (where, size, protection, flags, file, at))

/* Names of glibc: dlsym allocates. */
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t size) { return fails(MALLOC) ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return fails(MALLOC) ? NULL : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return fails(MALLOC) ? NULL : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) { return fails(MALLOC) ? NULL : __libc_memalign(alignment, size); }
void* aligned_alloc(size_t alignment, size_t size) { return fails(MALLOC) ? NULL : __libc_memalign(alignment, size); }
int posix_memalign(void** where, size_t alignment, size_t size) {
    if (fails(MALLOC)) return ENOMEM;
    *where = __libc_memalign(alignment, size);
    return *where != NULL ? 0 : ENOMEM;
}

struct Start {
    void* (*body)(void*);
    void* argument;
};
static void* counted(void* start) {
    const struct Start copy = *(struct Start*)start;
    free(start);
    void* result = copy.body(copy.argument);
    atomic_fetch_sub(&living, 1);
    return result;
}
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*), void* argument) {
    CACHED(pthread_create);
    if (fails(CREATE)) return EAGAIN;
    if (family == THREADS && atomic_load(&living) >= nth) {
        atomic_fetch_add(&failed[THREADS], 1);
        return EAGAIN;
    }
    struct Start* start = __libc_malloc(sizeof *start);
    if (start == NULL) return EAGAIN;
    *start = (struct Start){body, argument};
    atomic_fetch_add(&living, 1);
    const int result = real(thread, attributes, counted, start);
    if (result != 0) atomic_fetch_sub(&living, 1);
    return result;
}
