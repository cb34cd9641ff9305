#include "vphysics/assert.h"

#include <cstdlib>

namespace vp {
namespace {

// The engine prints nothing: a debugger stops here with all three in the frame.
void stop(const char*, const char*, int) {
  std::abort();
}

AssertHandler g_handler = stop;

}  // namespace

AssertHandler set_assert_handler(AssertHandler handler) {
  const AssertHandler before = g_handler;
  g_handler = handler ? handler : stop;
  return before;
}

void detail::assertion_failed(const char* condition, const char* file, int line) {
  g_handler(condition, file, line);
}

}  // namespace vp
