// SPDX-License-Identifier: Apache-2.0
// A library to preload: makes the loop of spm-servo (the thread of SCHED_FIFO priority 80) compute
// without sleep for 0.3 s whenever the file that SPIN_AT names exists, which it removes. Writes
// when that began, ns of CLOCK_MONOTONIC, to the file that SPIN_BEGAN names.
#define _GNU_SOURCE  // NOLINT(bugprone-reserved-identifier): glibc asks for it
#include <dlfcn.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static const int loop_priority = 80;
static const int64_t spin_ns = 300000000;

static int64_t now_ns(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec* due, struct timespec* left) {
  static int (*real)(clockid_t, int, const struct timespec*, struct timespec*);
  if (real == NULL) *(void**)&real = dlsym(RTLD_NEXT, "clock_nanosleep");
  int policy = 0;
  struct sched_param parameters = {0};
  const char* file = getenv("SPIN_AT");
  if (file != NULL && pthread_getschedparam(pthread_self(), &policy, &parameters) == 0 &&
      parameters.sched_priority == loop_priority && unlink(file) == 0) {
    const int64_t began = now_ns();
    FILE* told = fopen(getenv("SPIN_BEGAN"), "w");
    if (told != NULL) {
      fprintf(told, "%lld\n", (long long)began);
      fclose(told);
    }
    const int64_t end = began + spin_ns;
    while (now_ns() < end) {
    }
  }
  return real(clock, flags, due, left);
}
