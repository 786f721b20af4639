/* Makes a call of the system's library fail (LD_PRELOAD), to see what a program makes of it.
 *
 *     CVTFLOW_FAULT=write:3     the third call of write (or one of its relatives) fails, of open, read, write, fsync, rename or fork
 *     CVTFLOW_APPEARS=FILE      another program writes "mine" to FILE when a file NAME.part is synced first, NAME as in FILE, or the files
 *                               of FOLDER.part, FOLDER as in FILE
 *     CVTFLOW_CLOCK=5           from its fifth reading on, the clock is an hour behind
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

/* Whether this call shall fail; errno is set then. */
static int fails(const char* family, int reason) {
    static atomic_long calls;
    const char* setting = getenv("CVTFLOW_FAULT");
    const size_t length = strlen(family);
    if (setting == NULL || strncmp(setting, family, length) != 0 || setting[length] != ':') return 0;
    if (atomic_fetch_add(&calls, 1) + 1 != strtol(setting + length + 1, NULL, 10)) return 0;
    errno = reason;
    return 1;
}

/* The function that would have been called. */
#define CACHED(name)               \
    static __typeof__(&name) real; \
    if (real == NULL) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

/* A row per function: value, name, family with its reason, value when it fails, parameters, arguments. */
#define FAILS(type, name, which, failure, parameters, arguments) \
    type name parameters {                                       \
        CACHED(name);                                            \
        return fails(which) ? failure : real arguments;          \
    }
#define OPEN "open", EMFILE
#define READ "read", EIO
#define WRITE "write", ENOSPC
#define FSYNC "fsync", EIO
#define RENAME "rename", EIO
#define FORK "fork", EAGAIN

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
FAILS(pid_t, fork, FORK, -1, (void), ())

int clock_gettime(clockid_t clock, struct timespec* now) {
    static atomic_long readings;
    CACHED(clock_gettime);
    const int result = real(clock, now);
    const char* first = clock == CLOCK_REALTIME ? getenv("CVTFLOW_CLOCK") : NULL;
    if (first != NULL && atomic_fetch_add(&readings, 1) + 1 >= strtol(first, NULL, 10)) now->tv_sec -= 3600;
    return result;
}
