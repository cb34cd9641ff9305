// VP_ASSERT(condition): a caller's mistake, caught where it is made. On unless NDEBUG is defined
// and VP_ASSERTIONS is not (Debug and RelWithDebInfo of this project's build). What happens then
// can be replaced: a test counts, an editor shows; the default aborts.
#pragma once

namespace vp {

using AssertHandler = void (*)(const char* condition, const char* file, int line);

// Replaces the handler and returns the one before; null restores the default. Not thread safe: set
// it before the first world is made. A handler that returns lets the call go on.
AssertHandler set_assert_handler(AssertHandler handler);

namespace detail {
void assertion_failed(const char* condition, const char* file, int line);
}

}  // namespace vp

#if defined(VP_ASSERTIONS) || !defined(NDEBUG)
#define VP_ASSERT(condition) \
  ((condition) ? void(0) : ::vp::detail::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define VP_ASSERT(condition) void(0)
#endif
