// SPDX-License-Identifier: Apache-2.0
#define _GNU_SOURCE
#include "tests/faults/faulty_files.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum { kMaxFiles = 1024, kMaxPath = 1024 };

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static char root[kMaxPath];
static size_t root_bytes;
static char paths[kMaxFiles][kMaxPath];  // Of open files below the root; empty for all others.
static int trace = -1;
static int64_t calls;
static int64_t failing_call;
static int failing_kind;

void faulty_files_watch(const char* directory) {
  pthread_mutex_lock(&mutex);
  root_bytes = strlen(directory);
  if (root_bytes >= kMaxPath) abort();
  memcpy(root, directory, root_bytes + 1);
  calls = 0;
  pthread_mutex_unlock(&mutex);
}

void faulty_files_fail(int64_t call, int kind) {
  pthread_mutex_lock(&mutex);
  failing_call = call;
  failing_kind = kind;
  pthread_mutex_unlock(&mutex);
}

void faulty_files_trace(const char* file) {
  trace = (int)syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (trace < 0) abort();
}

int64_t faulty_files_calls(void) {
  return calls;
}

__attribute__((constructor)) static void read_environment(void) {
  const char* directory = getenv("ENGRAM_FAULTS_ROOT");
  const char* call = getenv("ENGRAM_FAULTS_CALL");
  const char* kind = getenv("ENGRAM_FAULTS_KIND");
  const char* file = getenv("ENGRAM_FAULTS_TRACE");
  if (directory != NULL) faulty_files_watch(directory);
  if (call != NULL && kind != NULL) faulty_files_fail(atoll(call), atoi(kind));
  if (file != NULL) faulty_files_trace(file);
}

static int is_below_root(const char* path) {
  return root_bytes > 0 && strncmp(path, root, root_bytes) == 0 &&
         (path[root_bytes] == '/' || path[root_bytes] == '\0');
}

static int is_told(const char* path) {
  const char* slash = strrchr(path, '/');
  return strncmp(slash == NULL ? path : slash + 1, "told", 4) == 0;
}

static const char* path_of(int fd) {
  return fd >= 0 && fd < kMaxFiles && paths[fd][0] != '\0' ? paths[fd] : NULL;
}

static int needs_space(int change) {
  return change == kFileCreate || change == kFileWrite || change == kFileMkdir ||
         change == kFileRename || change == kFileLink;
}

// Counts a call. The error that it shall fail with, or 0; `is_half`: it takes half of the bytes.
static int count(const char* path, int change, int* is_half) {
  *is_half = 0;
  if (is_told(path)) return 0;
  const int64_t call = ++calls;
  if (failing_kind == kFaultNone || call < failing_call) return 0;
  const int is_first = call == failing_call;
  switch (failing_kind) {
    case kFaultShort:
      *is_half = is_first && change == kFileWrite;
      return 0;
    case kFaultNoSpace:
      return is_first && needs_space(change) ? ENOSPC : 0;
    case kFaultFull:
      *is_half = is_first && change == kFileWrite;
      return !*is_half && needs_space(change) ? ENOSPC : 0;
    case kFaultBroken:
      return is_first ? EIO : 0;
    default:
      return EIO;
  }
}

static void put(const void* bytes, size_t size) {
  if (syscall(SYS_write, trace, bytes, size) != (ssize_t)size) abort();
}

static void tell(int change, const char* path, const char* second, int fd, int64_t offset,
                 const void* bytes, size_t size) {
  if (trace < 0) return;
  struct stat info;
  memset(&info, 0, sizeof(info));
  if (fd >= 0) fstat(fd, &info);
  struct FileRecord record = {is_told(path) ? 0 : calls,
                              info.st_ino,
                              offset,
                              size,
                              (uint32_t)change,
                              (uint32_t)strlen(path),
                              second == NULL ? 0 : (uint32_t)strlen(second),
                              S_ISDIR(info.st_mode)};
  put(&record, sizeof(record));
  put(path, record.path_bytes);
  put(second, record.second_path_bytes);
  put(bytes, size);
}

static int fail_with(int error) {
  pthread_mutex_unlock(&mutex);
  errno = error;
  return -1;
}

static int open_at(int directory, const char* path, int flags, mode_t mode) {
  if (path[0] != '/' || !is_below_root(path))
    return (int)syscall(SYS_openat, directory, path, flags, mode);
  pthread_mutex_lock(&mutex);
  struct stat info;
  const int is_new = (flags & O_CREAT) != 0 && lstat(path, &info) != 0;
  int is_half = 0;
  const int error = is_new ? count(path, kFileCreate, &is_half) : 0;
  if (error != 0) return fail_with(error);
  const int fd = (int)syscall(SYS_openat, directory, path, flags, mode);
  const int outcome = errno;
  if (fd >= 0 && fd < kMaxFiles && strlen(path) < kMaxPath) strcpy(paths[fd], path);
  if (fd >= 0 && is_new) tell(kFileCreate, path, NULL, fd, 0, NULL, 0);
  if (fd >= 0 && !is_new && (flags & O_TRUNC) != 0) tell(kFileTruncate, path, NULL, fd, 0, NULL, 0);
  pthread_mutex_unlock(&mutex);
  errno = outcome;
  return fd;
}

static mode_t mode_of(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(arguments, mode_t) : 0;
}

#define DEFINE_OPEN(name)                          \
  int name(const char* path, int flags, ...) {     \
    va_list arguments;                             \
    va_start(arguments, flags);                    \
    const mode_t mode = mode_of(flags, arguments); \
    va_end(arguments);                             \
    return open_at(AT_FDCWD, path, flags, mode);   \
  }
#define DEFINE_OPENAT(name)                                   \
  int name(int directory, const char* path, int flags, ...) { \
    va_list arguments;                                        \
    va_start(arguments, flags);                               \
    const mode_t mode = mode_of(flags, arguments);            \
    va_end(arguments);                                        \
    return open_at(directory, path, flags, mode);             \
  }
#define DEFINE_CHECKED_OPEN(name)             \
  int name(const char* path, int flags) {     \
    return open_at(AT_FDCWD, path, flags, 0); \
  }

// The names that glibc's headers declare for the same function in different builds.
DEFINE_OPEN(open)
DEFINE_OPEN(open64)
DEFINE_OPENAT(openat)
DEFINE_OPENAT(openat64)
int __open_2(const char* path, int flags);
int __open64_2(const char* path, int flags);
DEFINE_CHECKED_OPEN(__open_2)
DEFINE_CHECKED_OPEN(__open64_2)

// Writes at `offset`, or at the file's own place where it is negative.
static ssize_t write_at(int fd, const void* bytes, size_t size, int64_t offset) {
  if (path_of(fd) == NULL)
    return offset < 0 ? syscall(SYS_write, fd, bytes, size)
                      : syscall(SYS_pwrite64, fd, bytes, size, offset);
  pthread_mutex_lock(&mutex);
  int is_half = 0;
  const int error = count(paths[fd], kFileWrite, &is_half);
  if (error != 0) return fail_with(error);
  if (is_half && size > 1) size /= 2;
  const ssize_t written = offset < 0 ? syscall(SYS_write, fd, bytes, size)
                                     : syscall(SYS_pwrite64, fd, bytes, size, offset);
  const int outcome = errno;
  if (written > 0) {
    const int64_t at = offset < 0 ? lseek(fd, 0, SEEK_CUR) - written : offset;
    tell(kFileWrite, paths[fd], NULL, fd, at, bytes, (size_t)written);
  }
  pthread_mutex_unlock(&mutex);
  errno = outcome;
  return written;
}

ssize_t write(int fd, const void* bytes, size_t size) {
  return write_at(fd, bytes, size, -1);
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
  return write_at(fd, bytes, size, offset);
}
ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t offset) {
  return write_at(fd, bytes, size, offset);
}

// One part after the other: a vector may be written in part anyway.
ssize_t writev(int fd, const struct iovec* parts, int number) {
  if (path_of(fd) == NULL) return syscall(SYS_writev, fd, parts, number);
  ssize_t total = 0;
  for (int i = 0; i < number; ++i) {
    const ssize_t written = write_at(fd, parts[i].iov_base, parts[i].iov_len, -1);
    if (written < 0) return total > 0 ? total : -1;
    total += written;
    if ((size_t)written < parts[i].iov_len) break;
  }
  return total;
}

static int change_open(int fd, long number, int change, int64_t size) {
  if (path_of(fd) == NULL) return (int)syscall(number, fd, size);
  pthread_mutex_lock(&mutex);
  int is_half = 0;
  const int error = count(paths[fd], change, &is_half);
  if (error != 0) return fail_with(error);
  const int result = (int)syscall(number, fd, size);
  const int outcome = errno;
  if (result == 0) tell(change, paths[fd], NULL, fd, size, NULL, 0);
  pthread_mutex_unlock(&mutex);
  errno = outcome;
  return result;
}

int fsync(int fd) {
  return change_open(fd, SYS_fsync, kFileSync, 0);
}
int fdatasync(int fd) {
  return change_open(fd, SYS_fdatasync, kFileSync, 0);
}
int syncfs(int fd) {
  return change_open(fd, SYS_syncfs, kFileSyncSystem, 0);
}
int ftruncate(int fd, off_t size) {
  return change_open(fd, SYS_ftruncate, kFileTruncate, size);
}
int ftruncate64(int fd, off64_t size) {
  return change_open(fd, SYS_ftruncate, kFileTruncate, size);
}

static int change_names(int change, const char* path, const char* second, mode_t mode) {
  const int is_watched = is_below_root(path) || (second != NULL && is_below_root(second));
  if (is_watched) pthread_mutex_lock(&mutex);
  int is_half = 0;
  const int error = is_watched ? count(path, change, &is_half) : 0;
  if (error != 0) return fail_with(error);
  int result = 0;
  if (change == kFileRename)
    result = (int)syscall(SYS_rename, path, second);
  else if (change == kFileLink)
    result = (int)syscall(SYS_link, path, second);
  else if (change == kFileUnlink)
    result = (int)syscall(SYS_unlink, path);
  else
    result = (int)syscall(SYS_mkdir, path, mode);
  const int outcome = errno;
  if (is_watched && result == 0) tell(change, path, second, -1, 0, NULL, 0);
  if (is_watched) pthread_mutex_unlock(&mutex);
  errno = outcome;
  return result;
}

int rename(const char* from, const char* to) {
  return change_names(kFileRename, from, to, 0);
}
int link(const char* from, const char* to) {
  return change_names(kFileLink, from, to, 0);
}
int unlink(const char* path) {
  return change_names(kFileUnlink, path, NULL, 0);
}
int mkdir(const char* path, mode_t mode) {
  return change_names(kFileMkdir, path, NULL, mode);
}

int close(int fd) {
  if (path_of(fd) != NULL) {
    pthread_mutex_lock(&mutex);
    paths[fd][0] = '\0';
    pthread_mutex_unlock(&mutex);
  }
  return (int)syscall(SYS_close, fd);
}
