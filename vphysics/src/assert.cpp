#include "vphysics/assert.h"

#include <cstdio>
#include <cstdlib>

namespace vp {
namespace {

void write_and_abort(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: VP_ASSERT(%s) failed\n", file, line, condition);
  std::abort();
}

AssertHandler g_handler = write_and_abort;

}  // namespace

AssertHandler set_assert_handler(AssertHandler handler) {
  const AssertHandler before = g_handler;
  g_handler = handler ? handler : write_and_abort;
  return before;
}

void detail::assertion_failed(const char* condition, const char* file, int line) {
  g_handler(condition, file, line);
}

}  // namespace vp
