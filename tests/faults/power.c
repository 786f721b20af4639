/* Writes down what a program does to its files (LD_PRELOAD), so that a test can say what a power cut would leave of them.
 *
 *     CVTFLOW_POWER_LOG=FILE    every change is appended to FILE, by every process, in the order in which it happened
 *
 * A line of text each, and for writes the bytes behind it (tests/tools/power_cut_test.cpp reads it):
 *
 *     create INODE PATH         a new empty file has a name           mkdir INODE PATH
 *     size INODE BYTES          cut or lengthened                     remove - PATH
 *     write INODE AT BYTES      …and the bytes                        rename - FROM\tTO
 *     sync INODE                file or folder                    syncfs INODE      everything
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) \
    static __typeof__(&name) real; \
    if (real == NULL) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
static int log_file = -1;

__attribute__((constructor)) static void open_log(void) {
    const char* path = getenv("CVTFLOW_POWER_LOG");
    if (path != NULL) log_file = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
}

/* A change and its line, with no other change of this process in between; other processes' lines do not mix with it. */
static void note(const char* line, const void* bytes, size_t count) {
    struct iovec parts[2] = {{(void*)(size_t)line, strlen(line)}, {(void*)(size_t)bytes, count}};
    if (log_file >= 0 && syscall(SYS_writev, log_file, parts, count > 0 ? 2 : 1) < 0) abort(); /* a test without its log is none */
}

static void note_descriptor(const char* what, int file, long long number, long long count, const void* bytes) {
    struct stat of;
    if (log_file < 0 || fstat(file, &of) != 0 || !(S_ISREG(of.st_mode) || S_ISDIR(of.st_mode))) return;
    char line[160];
    snprintf(line, sizeof line, "%s %llu %lld %lld\n", what, (unsigned long long)of.st_ino, number, count);
    note(line, bytes, bytes != NULL ? (size_t)count : 0);
}

/* PATH as seen from the root; a folder's links are followed, a name's are not. */
static void absolute(int folder, const char* path, char* whole) {
    char base[PATH_MAX] = "";
    char link[64];
    if (path[0] != '/' && folder == AT_FDCWD && getcwd(base, sizeof base) == NULL) base[0] = 0;
    if (path[0] != '/' && folder != AT_FDCWD) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
        const ssize_t length = readlink(link, base, sizeof base - 1);
        base[length > 0 ? length : 0] = 0;
    }
    snprintf(whole, 2 * PATH_MAX, "%s%s%s", base, base[0] != 0 ? "/" : "", path);
}

static void note_name(const char* what, unsigned long long inode, const char* path, const char* to) {
    char line[4 * PATH_MAX + 64];
    snprintf(line, sizeof line, "%s %llu %s%s%s\n", what, inode, path, to[0] != 0 ? "\t" : "", to);
    note(line, NULL, 0);
}

static int open_noted(int (*real)(const char*, int, ...), const char* path, int flags, mode_t mode) {
    if (log_file < 0 || (flags & (O_CREAT | O_TRUNC)) == 0) return real(path, flags, mode);
    pthread_mutex_lock(&gate);
    struct stat before;
    const int was = stat(path, &before) == 0;
    const int file = real(path, flags, mode);
    const int error = errno;
    struct stat now;
    if (file >= 0 && fstat(file, &now) == 0 && S_ISREG(now.st_mode)) {
        char whole[2 * PATH_MAX];
        absolute(AT_FDCWD, path, whole);
        if (!was) note_name("create", now.st_ino, whole, "");
        if (was && (flags & O_TRUNC) != 0) note_descriptor("size", file, 0, 0, NULL);
    }
    pthread_mutex_unlock(&gate);
    errno = error;
    return file;
}

#define OPENS(name) \
    int name(const char* path, int flags, ...) { \
        va_list rest; \
        va_start(rest, flags); \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0; \
        va_end(rest); \
        REAL(name); \
        return open_noted(real, path, flags, mode); \
    }
OPENS(open)
OPENS(open64)

#define STREAMS(name) \
    FILE* name(const char* path, const char* mode) { \
        REAL(name); \
        struct stat before; \
        const int was = stat(path, &before) == 0; \
        FILE* file = real(path, mode); \
        if (file != NULL && log_file >= 0 && mode[0] != 'r') { \
            char whole[2 * PATH_MAX]; \
            struct stat now; \
            absolute(AT_FDCWD, path, whole); \
            if (!was && fstat(fileno(file), &now) == 0) note_name("create", now.st_ino, whole, ""); \
            if (was && mode[0] == 'w') note_descriptor("size", fileno(file), 0, 0, NULL); \
        } \
        return file; \
    }
STREAMS(fopen)
STREAMS(fopen64)

static off64_t place(int file) {
    struct stat of;
    if ((fcntl(file, F_GETFL) & O_APPEND) != 0 && fstat(file, &of) == 0) return of.st_size;
    return lseek64(file, 0, SEEK_CUR);
}

/* CALL is made and, if it went well, NOTED; both under the gate, so that the log has the order of the changes. */
#define LOGGED(type, call, noted) \
    pthread_mutex_lock(&gate); \
    const type result = call; \
    const int error = errno; \
    if (log_file >= 0 && result >= 0) noted; \
    pthread_mutex_unlock(&gate); \
    errno = error; \
    return result

/* A row per function that a line of the log describes: value, name, parameters, arguments, line. */
#define LOGS(type, name, parameters, arguments, noted) \
    type name parameters { \
        REAL(name); \
        LOGGED(type, real arguments, noted); \
    }

ssize_t write(int file, const void* from, size_t size) {
    REAL(write);
    const off64_t at = log_file >= 0 ? place(file) : 0;
    LOGGED(ssize_t, real(file, from, size), note_descriptor("write", file, at, result, from));
}
ssize_t writev(int file, const struct iovec* from, int count) {
    REAL(writev);
    off64_t at = log_file >= 0 ? place(file) : 0;
    pthread_mutex_lock(&gate);
    const ssize_t result = real(file, from, count);
    const int error = errno;
    ssize_t left = result;
    for (int k = 0; log_file >= 0 && k < count && left > 0; ++k) {
        const ssize_t some = left < (ssize_t)from[k].iov_len ? left : (ssize_t)from[k].iov_len;
        note_descriptor("write", file, at, some, from[k].iov_base);
        at += some;
        left -= some;
    }
    pthread_mutex_unlock(&gate);
    errno = error;
    return result;
}
LOGS(ssize_t, pwrite, (int file, const void* from, size_t size, off_t at), (file, from, size, at),
     note_descriptor("write", file, at, result, from))
LOGS(ssize_t, pwrite64, (int file, const void* from, size_t size, off64_t at), (file, from, size, at),
     note_descriptor("write", file, at, result, from))
LOGS(int, ftruncate, (int file, off_t size), (file, size), note_descriptor("size", file, size, 0, NULL))
LOGS(int, ftruncate64, (int file, off64_t size), (file, size), note_descriptor("size", file, size, 0, NULL))
LOGS(int, fsync, (int file), (file), note_descriptor("sync", file, 0, 0, NULL))
LOGS(int, syncfs, (int file), (file), note_descriptor("syncfs", file, 0, 0, NULL))
LOGS(int, fdatasync, (int file), (file), note_descriptor("sync", file, 0, 0, NULL))

static void note_path(const char* what, int folder, const char* path, unsigned long long inode) {
    char whole[2 * PATH_MAX];
    absolute(folder, path, whole);
    note_name(what, inode, whole, "");
}
static void note_rename(const char* from, const char* to) {
    char before[2 * PATH_MAX], after[2 * PATH_MAX];
    absolute(AT_FDCWD, from, before);
    absolute(AT_FDCWD, to, after);
    note_name("rename", 0, before, after);
}
static void note_folder(const char* path) {
    struct stat of;
    if (stat(path, &of) == 0) note_path("mkdir", AT_FDCWD, path, of.st_ino);
}

LOGS(int, rename, (const char* from, const char* to), (from, to), note_rename(from, to))
LOGS(int, renameat2, (int from_folder, const char* from, int to_folder, const char* to, unsigned int flags),
     (from_folder, from, to_folder, to, flags), note_rename(from, to))
LOGS(int, unlink, (const char* path), (path), note_path("remove", AT_FDCWD, path, 0))
LOGS(int, remove, (const char* path), (path), note_path("remove", AT_FDCWD, path, 0))
LOGS(int, rmdir, (const char* path), (path), note_path("remove", AT_FDCWD, path, 0))
LOGS(int, unlinkat, (int folder, const char* path, int flags), (folder, path, flags), note_path("remove", folder, path, 0))
LOGS(int, mkdir, (const char* path, mode_t mode), (path, mode), note_folder(path))
