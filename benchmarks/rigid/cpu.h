// What this process has used so far. Under emscripten, where clock_gettime knows no processor time,
// what node says of its process.
#pragma once

#include <cstdio>
#include <ctime>
#ifdef __EMSCRIPTEN__
#include <emscripten.h>
#endif

namespace rigid {

// Of this thread [us].
inline double cpu_us() {
#ifdef __EMSCRIPTEN__
  return EM_ASM_DOUBLE({
    const used = process.cpuUsage();
    return used.user + used.system;
  });
#else
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
#endif
}

// The most that was resident at once. Not by getrusage, which begins at what the parent had.
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
