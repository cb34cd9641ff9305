// Processor time and memory that this process has used so far.
#pragma once

#include <cstdio>
#include <ctime>
#ifdef __wasi__
#include <wasi/api.h>
#endif

namespace rigid {

// Processor time of this thread [us]. In WebAssembly that of node's process: WASI has no thread
// clock.
inline double cpu_us() {
#ifdef __wasi__
  __wasi_timestamp_t ns = 0;
  (void)__wasi_clock_time_get(__WASI_CLOCKID_PROCESS_CPUTIME_ID, 1, &ns);
  return 1e-3 * static_cast<double>(ns);
#else
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
#endif
}

// Peak resident memory [MB]. Does not use getrusage, which starts at the parent's value.
inline double peak_mb() {
  std::FILE* status = std::fopen("/proc/self/status", "r");
  if (!status) return 0.0;
  char line[256];
  double kilobytes = 0.0;
  while (std::fgets(line, sizeof(line), status)) {
    if (std::sscanf(line, "VmHWM: %lf", &kilobytes) == 1) break;
  }
  std::fclose(status);
  return kilobytes / 1024.0;
}

}  // namespace rigid
