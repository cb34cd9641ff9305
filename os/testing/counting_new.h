// For tests that a warm loop takes no memory. Linking counting_new replaces the program's operator
// new; it would hide leaks and overruns from the address sanitizer, so such tests are programs of
// their own.
#pragma once

namespace os::testing {

// How often this thread has taken memory. Other threads may allocate.
long allocations();

}  // namespace os::testing
