// SPDX-License-Identifier: Apache-2.0
#include "formats/files/large_pages.hpp"

#include <sys/mman.h>

#include <cstdlib>

namespace spm {

namespace {

constexpr std::size_t large_page = std::size_t{2} << 20U;

}  // namespace

void* take_large_pages(std::size_t bytes) {
  const std::size_t whole = (bytes + large_page - 1) / large_page * large_page;
  void* memory = std::aligned_alloc(large_page, whole);
  if (memory == nullptr) throw std::bad_alloc();
  // Only a request: a kernel without such pages refuses it, and the memory can be used all the
  // same.
  static_cast<void>(::madvise(memory, whole, MADV_HUGEPAGE));
  return memory;
}

void free_large_pages(void* memory) noexcept { std::free(memory); }

}  // namespace spm
