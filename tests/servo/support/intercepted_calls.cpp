// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/intercepted_calls.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/types.h>

#include <cerrno>
#include <cstddef>

// The C library's own allocator under its internal names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace spm::test {

namespace {

thread_local bool watching = false;
thread_local InterceptedCalls calls;

void count(std::uint64_t InterceptedCalls::*what) noexcept {
  if (watching) ++(calls.*what);
}

template <class Function>
Function next(const char* name) noexcept {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void watch(bool on) noexcept { watching = on; }

InterceptedCalls intercepted_calls() noexcept { return calls; }

}  // namespace spm::test

using spm::test::count;
using spm::test::InterceptedCalls;

extern "C" {

void* malloc(std::size_t size) {
  count(&InterceptedCalls::allocations);
  return __libc_malloc(size);
}

void* calloc(std::size_t items, std::size_t size) {
  count(&InterceptedCalls::allocations);
  return __libc_calloc(items, size);
}

void* realloc(void* at, std::size_t size) {
  count(&InterceptedCalls::allocations);
  return __libc_realloc(at, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(&InterceptedCalls::allocations);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** at, std::size_t alignment, std::size_t size) {
  count(&InterceptedCalls::allocations);
  *at = __libc_memalign(alignment, size);
  return *at == nullptr ? ENOMEM : 0;
}

void free(void* at) {
  if (at != nullptr) count(&InterceptedCalls::allocations);
  __libc_free(at);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static const auto real = spm::test::next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  count(&InterceptedCalls::locks);
  return real(mutex);
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  static const auto real = spm::test::next<ssize_t (*)(int, const void*, std::size_t)>("write");
  count(&InterceptedCalls::writes);
  return real(file, bytes, size);
}
}
