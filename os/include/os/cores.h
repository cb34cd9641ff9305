// How many cores' time this process may use.
#pragma once

#include <string>

namespace os {

// Those that the calling thread may run on, or fewer where the control group has a quota: at
// least 1.
int usable_cores();

// The quota in cores' time that a cgroup-v2 file "cpu.max" states, such as "150000 100000" or
// "max 100000"; 0: none.
double quota_of(const std::string& cpu_max);

}  // namespace os
