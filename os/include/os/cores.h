// The number of processor cores that this process may use.
#pragma once

#include <string>

namespace os {

// Cores in the affinity mask of the calling thread, or fewer if the control group has a quota; at
// least 1.
int usable_cores();

// The quota [cores] in the text of a cgroup-v2 file "cpu.max", such as "150000 100000" or "max
// 100000"; 0: none.
double quota_of(const std::string& cpu_max);

}  // namespace os
