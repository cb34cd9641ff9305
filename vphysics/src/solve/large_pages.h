// An allocator for arrays of many megabytes with random access.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace vp::solve {

// Where the system has large pages, arrays of 4 MiB or more are allocated in them. With 4 KiB pages
// most accesses would need a page table lookup, and the tables themselves would not fit into the
// caches.
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t kPage = std::size_t{2} << 20;

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) {}  // NOLINT(google-explicit-constructor): as allocators must

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < 2 * kPage) return static_cast<T*>(::operator new (bytes, std::align_val_t{64}));
    const std::size_t rounded_up = (bytes + kPage - 1) / kPage * kPage;
    void* memory = ::operator new (rounded_up, std::align_val_t{kPage});
#ifdef __linux__
    (void)madvise(memory, rounded_up, MADV_HUGEPAGE);  // may fail
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    const bool large = count * sizeof(T) >= 2 * kPage;
    ::operator delete (memory, std::align_val_t{large ? kPage : 64});
  }
  template <class U>
  bool operator==(const LargePages<U>&) const {
    return true;
  }
};

template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace vp::solve
