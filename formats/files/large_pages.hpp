// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace spm {

/// Allocates memory on pages of 2 MiB where the kernel has them, otherwise on any pages. Large
/// tables that are read without a pattern should lie on large pages. On pages of 4 KiB the time of
/// a query depends on which of them happen to share sets of the processor's cache, and differs by a
/// third from one run to the next. `bytes` is rounded up to whole pages. Throws std::bad_alloc.
[[nodiscard]] void* take_large_pages(std::size_t bytes);
void free_large_pages(void* memory) noexcept;

/// Tables of at least this size lie on large pages; smaller ones would waste most of a page.
inline constexpr std::size_t min_large_table = std::size_t{1} << 20U;

/// Allocator for containers that grow large.
template <class T>
struct LargePageAllocator {
  using value_type = T;

  LargePageAllocator() = default;
  template <class Other>
  // NOLINTNEXTLINE(google-explicit-constructor): as allocators do.
  LargePageAllocator(const LargePageAllocator<Other>&) noexcept {}

  [[nodiscard]] T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes >= min_large_table) return static_cast<T*>(take_large_pages(bytes));
    return static_cast<T*>(::operator new(bytes, std::align_val_t(alignof(T))));
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    if (count * sizeof(T) >= min_large_table) {
      free_large_pages(memory);
    } else {
      ::operator delete(memory, std::align_val_t(alignof(T)));
    }
  }
  [[nodiscard]] bool operator==(const LargePageAllocator&) const noexcept { return true; }
};

}  // namespace spm
