// Counts allocations, for tests that a warm loop does not allocate. Linking counting_new replaces
// the program's operator new. That would hide leaks and overruns from the address sanitizer, so
// such tests are separate programs.
#pragma once

namespace os::testing {

// Number of allocations of this thread. Other threads may allocate.
long allocations();

}  // namespace os::testing
