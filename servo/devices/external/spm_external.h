/* SPDX-License-Identifier: Apache-2.0 */
/* For a process that drives a device whose vendor's library is closed, and provides it to
 * spm-servo: it supplies poses and takes wrenches, over memory that the daemon shares. A header
 * without a library, C11 or C++; Linux, GCC or Clang. external_example.c is a complete process, to
 * be filled in.
 *
 * Start the daemon with --device external:name=NAME, and for a device whose motors turn the tool
 * with ,torque_cap=TORQUE: without it every torque is zero. It may start and end before or after
 * this process: spm_external_open fails while the daemon does not run, and spm_external_get_wrench
 * gives zero when the daemon is silent. SI units; frame: x to the right, y up, z towards the user.
 */
#ifndef SPM_EXTERNAL_H
#define SPM_EXTERNAL_H

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPM_EXTERNAL_MAGIC 0x4C58454D5053ULL /* "SPMEXL" */
#define SPM_EXTERNAL_VERSION 1U
/* Of fcntl; its header names them only where _GNU_SOURCE is defined. */
#define SPM_EXTERNAL_GET_SEALS 1034
#define SPM_EXTERNAL_SEAL_SHRINK 2
/** After this time without a new wrench the daemon counts as gone, and after this time without a
 * new pose the device does. In both cases there is no force. */
#define SPM_EXTERNAL_SILENCE_NS 20000000LL

/** One side's latest values. `sequence` is odd while they are written. `numbers` has the bits of
 * doubles. */
struct spm_external_values {
  uint32_t sequence;
  uint32_t word;       /* for poses the buttons, one bit each; for wrenches 0 */
  uint64_t counter;    /* increases with each write: the heartbeat */
  uint64_t numbers[7]; /* position and orientation w x y z; or force and torque, the last unused */
  uint64_t time_ns;    /* when they were written, of spm_external_now(); 0: by an older header */
  uint64_t unused[6];
};

/** What both processes see. */
struct spm_external_memory {
  uint64_t magic;
  uint32_t version;
  uint32_t bytes;
  uint64_t unused[14];
  struct spm_external_values pose;   /* written by the device's process */
  struct spm_external_values wrench; /* written by the daemon */
};

/** A device's end. */
struct spm_external {
  struct spm_external_memory* memory;
  uint64_t last_counter;
  int64_t last_ns;
};

/** Time that never goes back, ns. */
static inline int64_t spm_external_now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

/** Writes values. Only one writer is allowed. */
static inline void spm_external_put(struct spm_external_values* values, uint32_t word,
                                    const double* numbers) {
  const uint32_t sequence = __atomic_load_n(&values->sequence, __ATOMIC_RELAXED) | 1U;
  __atomic_store_n(&values->sequence, sequence, __ATOMIC_RELAXED);
  __atomic_thread_fence(__ATOMIC_RELEASE);
  for (int i = 0; i < 7; ++i) {
    uint64_t bits;
    memcpy(&bits, &numbers[i], sizeof bits);
    __atomic_store_n(&values->numbers[i], bits, __ATOMIC_RELAXED);
  }
  __atomic_store_n(&values->word, word, __ATOMIC_RELAXED);
  __atomic_store_n(&values->time_ns, (uint64_t)spm_external_now(), __ATOMIC_RELAXED);
  __atomic_store_n(&values->counter, __atomic_load_n(&values->counter, __ATOMIC_RELAXED) + 1,
                   __ATOMIC_RELAXED);
  __atomic_store_n(&values->sequence, sequence + 1, __ATOMIC_RELEASE);
}

/** Reads values. 1; or 0 if the writer was writing in each of a few tries. */
static inline int spm_external_get(struct spm_external_values* values, uint32_t* word,
                                   uint64_t* counter, double* numbers) {
  for (int tries = 0; tries < 8; ++tries) {
    const uint32_t before = __atomic_load_n(&values->sequence, __ATOMIC_ACQUIRE);
    if ((before & 1U) != 0) continue;
    for (int i = 0; i < 7; ++i) {
      const uint64_t bits = __atomic_load_n(&values->numbers[i], __ATOMIC_RELAXED);
      memcpy(&numbers[i], &bits, sizeof bits);
    }
    *word = __atomic_load_n(&values->word, __ATOMIC_RELAXED);
    *counter = __atomic_load_n(&values->counter, __ATOMIC_RELAXED);
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    if (__atomic_load_n(&values->sequence, __ATOMIC_RELAXED) == before) return 1;
  }
  return 0;
}

/** The path of the memory of a name: beside the daemon's socket, in $XDG_RUNTIME_DIR, or else in
 * /run/user/UID. 1; or 0 if there is neither, or it does not fit into `size` bytes. */
static inline int spm_external_path(const char* name, char* path, size_t size) {
  const char* given = getenv("XDG_RUNTIME_DIR");
  const unsigned user = (unsigned)geteuid();
  char usual[32];
  struct stat status;
  int length = 0;
  snprintf(usual, sizeof usual, "/run/user/%u", user);
  if (given && given[0] == '/') {
    length = snprintf(path, size, "%s/spm-servo/external-%s", given, name);
  } else if (stat(usual, &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == user) {
    length = snprintf(path, size, "%s/spm-servo/external-%s", usual, name);
  }
  return length > 0 && (size_t)length < size;
}

/** Opens the daemon's memory, at a path by spm_external_path. Its folder must be no link, and this
 * user's alone; what lies there must lead to the memory of one of this user's processes, which
 * cannot be shrunk. The descriptor; or -1 with errno, which is EPERM where something is not so. */
static inline int spm_external_open_file(const char* path) {
  char folder[512], target[64];
  unsigned process, descriptor;
  int end = 0;
  struct stat status;
  const char* slash = strrchr(path, '/');
  if (!slash || (size_t)(slash - path) >= sizeof folder) return errno = ENOENT, -1;
  memcpy(folder, path, (size_t)(slash - path));
  folder[slash - path] = 0;
  const int within = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (within < 0) return -1;
  const int is_ours = fstat(within, &status) == 0 && status.st_uid == geteuid() &&
                      (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  const ssize_t length = readlinkat(within, slash + 1, target, sizeof target - 1);
  const int problem = length < 0 && errno == ENOENT ? ENOENT : EPERM;
  close(within);
  if (!is_ours || length < 0) return errno = is_ours ? problem : EPERM, -1;
  target[length] = 0;
  if (sscanf(target, "/proc/%u/fd/%u%n", &process, &descriptor, &end) != 2 || target[end] != 0) {
    return errno = EPERM, -1;
  }
  const int file = open(target, O_RDWR | O_CLOEXEC);
  if (file < 0) return -1;
  const int seals = fcntl(file, SPM_EXTERNAL_GET_SEALS);
  if (fstat(file, &status) != 0 || status.st_uid != geteuid() || seals < 0 ||
      (seals & SPM_EXTERNAL_SEAL_SHRINK) == 0) {
    close(file);
    return errno = EPERM, -1;
  }
  return file;
}

/** Maps the daemon's memory. 0; or -1 with a sentence in `message`. 1024 bytes are enough for it.
 */
static inline int spm_external_open(struct spm_external* device, const char* name, char* message,
                                    size_t message_size) {
  char path[512];
  memset(device, 0, sizeof *device);
  if (!spm_external_path(name, path, sizeof path)) {
    snprintf(message, message_size,
             "the name '%s' is too long, or there is no folder for it; take a shorter one, or set "
             "XDG_RUNTIME_DIR to a folder of yours with mode 700",
             name);
    return -1;
  }
  const int file = spm_external_open_file(path);
  if (file < 0 && errno == EPERM) {
    snprintf(
        message, message_size,
        "%s: is not to be trusted, since its folder is not this user's alone or what lies there "
        "was not made by spm-servo; set XDG_RUNTIME_DIR to a folder of yours with mode 700",
        path);
    return -1;
  }
  if (file < 0) {
    snprintf(message, message_size,
             "%s: %s; start spm-servo run --device external:name=%s, as the same user", path,
             strerror(errno), name);
    return -1;
  }
  struct stat status;
  void* memory = MAP_FAILED;
  if (fstat(file, &status) == 0 && (size_t)status.st_size == sizeof(struct spm_external_memory)) {
    memory =
        // NOLINTNEXTLINE(modernize-use-nullptr): this is C
        mmap(NULL, sizeof(struct spm_external_memory), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  }
  close(file);
  struct spm_external_memory* shared = (struct spm_external_memory*)memory;
  if (memory == MAP_FAILED || shared->magic != SPM_EXTERNAL_MAGIC ||
      shared->version != SPM_EXTERNAL_VERSION) {
    if (memory != MAP_FAILED) munmap(memory, sizeof(struct spm_external_memory));
    snprintf(message, message_size,
             "%s: is of another version of spm-servo; build this process with its spm_external.h",
             path);
    return -1;
  }
  device->memory = shared;
  return 0;
}

/** Sends the daemon a pose: position m, orientation w x y z, buttons one bit each. Call it once a
 * tick. */
static inline void spm_external_put_pose(struct spm_external* device, const double position[3],
                                         const double orientation[4], uint32_t buttons) {
  double numbers[7];
  memcpy(numbers, position, 3 * sizeof(double));
  memcpy(numbers + 3, orientation, 4 * sizeof(double));
  spm_external_put(&device->memory->pose, buttons, numbers);
}

/** Gets the wrench to apply, N and N m. 1; or 0, and zero, if the daemon is silent: then open
 * again. Call it once a tick. */
static inline int spm_external_get_wrench(struct spm_external* device, double force[3],
                                          double torque[3]) {
  double numbers[7];
  uint32_t word;
  uint64_t counter;
  const int64_t now = spm_external_now();
  const int got = spm_external_get(&device->memory->wrench, &word, &counter, numbers);
  if (device->last_ns == 0) device->last_ns = now;
  if (got && counter != device->last_counter) {
    device->last_counter = counter;
    device->last_ns = now;
  }
  const int is_alive = now - device->last_ns <= SPM_EXTERNAL_SILENCE_NS;
  for (int axis = 0; axis < 3; ++axis) {
    /* Kept from the last tick if this one could not be read: a wrench acts until the next one. */
    if (got || !is_alive) {
      force[axis] = is_alive ? numbers[axis] : 0;
      torque[axis] = is_alive ? numbers[3 + axis] : 0;
    }
  }
  return is_alive;
}

/** Unmaps the memory. */
static inline void spm_external_close(struct spm_external* device) {
  if (device->memory) munmap(device->memory, sizeof(struct spm_external_memory));
  device->memory = NULL;  // NOLINT(modernize-use-nullptr): this is C
}

#ifdef __cplusplus
}
#endif

#endif
