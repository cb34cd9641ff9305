// Records the wires of a simulated mouse: firmware_record_edges DIRECTORY writes the files
// recorded_*.edges, which ps2_edges_test reads.
#include <cstdio>
#include <fstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host_rig.h"

namespace {

using firmware_sim::HostRig;
using firmware_sim::MouseOptions;

bool record(const std::string& path, const MouseOptions& options) {
  HostRig rig(options);
  if (!rig.advance_until([&] { return rig.mice[0].enabled(); }, 3000)) return false;
  rig.advance_us(10'000);
  std::ofstream out(path);
  const std::vector<std::pair<int, int>> moves{{1, 0}, {-1, 127}, {200, -200}, {-256, 255}};
  out << "# recorded from the simulated mouse: " << options.clock_hz << " Hz, jitter "
      << options.jitter_ns << " ns\n# ns clock data, at each change of a line\nexpect moves";
  for (const auto& [slide, spin] : moves) out << ' ' << slide << ',' << spin;
  out << "\nexpect parity 0\nexpect framing 0 0\n";
  const std::uint64_t began_ns = rig.now_us() * 1000;
  out << "0 1 1\n";
  rig.on_wires = [&](std::uint64_t ns, bool clock, bool data) {
    out << ns - began_ns << ' ' << clock << ' ' << data << '\n';
  };
  rig.advance_us(2000);
  for (const auto& [slide, spin] : moves) {
    rig.mice[0].move(slide, spin);
    rig.advance_us(10'000);
  }
  out << rig.now_us() * 1000 - began_ns << " 1 1\n";
  return out.good();
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: firmware_record_edges DIRECTORY\n");
    return 2;
  }
  const std::string directory = arguments[1];
  for (const auto& [name, hz, jitter_ns] :
       {std::tuple{"slow", 10'000u, 0u}, std::tuple{"usual", 12'500u, 500u},
        std::tuple{"jitter", 14'000u, 3'000u}, std::tuple{"fast", 16'700u, 0u}}) {
    MouseOptions options;
    options.clock_hz = hz;
    options.jitter_ns = jitter_ns;
    const std::string path = directory + "/recorded_" + name + ".edges";
    if (!record(path, options)) {
      std::fprintf(stderr, "cannot record %s: is the directory there and writable?\n",
                   path.c_str());
      return 1;
    }
  }
  return 0;
}
