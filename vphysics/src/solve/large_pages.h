// Memory for arrays of many megabytes that are read in no order.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace vp::solve {

// Where the system has large pages an array of more than some megabytes is put into such: with
// those of 4 KiB the processor would look up most of its accesses in tables, which themselves
// leave its caches.
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
    (void)madvise(memory, rounded_up, MADV_HUGEPAGE);  // may be refused
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
