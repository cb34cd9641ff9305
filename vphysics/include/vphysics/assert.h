// VP_ASSERT(condition) checks a precondition at the call that breaks it. It is on if VP_ASSERTIONS
// is defined or NDEBUG is not: in Debug and RelWithDebInfo of this project's build. The handler can
// be replaced, for instance by one that counts failures in a test. The default handler aborts.
#pragma once

namespace vp {

using AssertHandler = void (*)(const char* condition, const char* file, int line);

// Replaces the handler and returns the previous one. Null restores the default. Not thread safe:
// set it before the first world is created. If the handler returns, the call continues.
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
