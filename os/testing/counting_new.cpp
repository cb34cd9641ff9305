#include "counting_new.h"

#include <cstdlib>
#include <new>

namespace {
thread_local long taken = 0;
}

long os::testing::allocations() {
  return taken;
}

// Not inlined: g++ 12 would otherwise report malloc and free as a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++taken;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
