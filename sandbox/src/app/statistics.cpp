#include "app/statistics.h"

#include <cinttypes>
#include <cstdio>

namespace sandbox {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char out[1024];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

}  // namespace

Statistics statistics_of(const Simulation& simulation) {
  Statistics f;
  f.scene = simulation.scene().name;
  f.rate = simulation.rate();
  f.seconds = simulation.time();
  f.steps = simulation.steps();
  f.step = simulation.times().statistics();
  f.standing = scenes::measure(simulation.scene(), simulation.scene_poses(), f.seconds);
  f.hash = simulation.world().state_hash();
  return f;
}

std::string sentence(const Statistics& f) {
  const scenes::Standing& s = f.standing;
  std::string out = text(
      "%s at %d Hz: %.3f s in %zu steps of %.1f us of processor time (median; p99 %.1f, max %.1f), "
      "%d of %d "
      "bodies in place, penetration %.2f mm, drift %.2f mm, hash %016" PRIx64,
      f.scene.c_str(), f.rate, f.seconds, f.steps, f.step.median, f.step.p99, f.step.max,
      s.in_place, s.of, 1e3 * s.penetration, 1e3 * s.drift, f.hash);
  if (f.frames > 0) out += text("; %d frames, %.1f a second", f.frames, f.frames_per_second);
  return out;
}

std::string json(const Statistics& f) {
  const scenes::Standing& s = f.standing;
  return text(
      "{\n  \"scene\": \"%s\",\n  \"rate\": %d,\n  \"seconds\": %.4f,\n  \"steps\": %zu,\n"
      "  \"step_median_us\": %.2f,\n  \"step_p99_us\": %.2f,\n  \"step_max_us\": %.2f,\n"
      "  \"bodies\": %d,\n  \"in_place\": %d,\n  \"penetration_mm\": %.4f,\n"
      "  \"drift_mm\": %.4f,\n  \"hash\": \"%016" PRIx64
      "\",\n  \"frames\": %d,\n  \"frames_per_second\": %.1f\n}\n",
      f.scene.c_str(), f.rate, f.seconds, f.steps, f.step.median, f.step.p99, f.step.max, s.of,
      s.in_place, 1e3 * s.penetration, 1e3 * s.drift, f.hash, f.frames, f.frames_per_second);
}

}  // namespace sandbox
