#include "os/cores.h"

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace os {
namespace {

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// The file of the process's own control group (its line in /proc begins with "0::"), otherwise of
// the root group; empty if there is none.
std::string read_cpu_max() {
  const std::string own = first_line("/proc/self/cgroup");
  const std::string path = own.starts_with("0::") ? own.substr(3) : "";
  const std::string line = first_line("/sys/fs/cgroup" + path + "/cpu.max");
  return line.empty() ? first_line("/sys/fs/cgroup/cpu.max") : line;
}

}  // namespace

double quota_of(const std::string& cpu_max) {
  double quota = 0.0, period = 0.0;
  if (std::sscanf(cpu_max.c_str(), "%lf %lf", &quota, &period) != 2) return 0.0;
  return quota > 0.0 && period > 0.0 ? quota / period : 0.0;
}

int usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  const int allowed = ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  static const double quota = quota_of(read_cpu_max());
  const int granted = quota > 0.0 ? std::max(1, static_cast<int>(quota)) : allowed;
  return std::max(1, std::min(allowed, granted));
}

}  // namespace os
