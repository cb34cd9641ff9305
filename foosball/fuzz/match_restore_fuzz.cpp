// Fuzzes Match::restore with untrusted bytes. The first input byte selects a saved match. The rest
// are changes of it: offset (2 bytes, little-endian), size minus one (3 bits of a byte), bytes. An
// accepted match must play on, and its new snapshot must restore to the same match. A checksum
// protects the world's bytes; vphysics_restore_fuzz covers them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "foosball/match.h"

namespace {

using namespace foosball;

struct SavedMatch {
  MatchDesc desc;
  std::vector<std::byte> bytes;
};

// Each layout in three modes with the ball in play; the third with a time-out.
std::vector<SavedMatch> saved_matches() {
  std::vector<SavedMatch> saved;
  for (const Layout layout : {Layout::tournament, Layout::paper}) {
    for (const Mode mode : {Mode::match, Mode::training, Mode::ladder}) {
      SavedMatch s;
      s.desc.layout = layout;
      s.desc.mode = mode;
      s.desc.seed = 2;
      Match match = *Match::create(s.desc);
      const std::array<Command, 3> start{
          {{Command::Kind::push, 0}, {Command::Kind::push, 0}, {Command::Kind::push, 1}}};
      TickInput input;
      input.commands = start;
      match.step(input);
      input.commands = {};
      for (int tick = 0; tick < 1500; ++tick) match.step(input);
      const Command time_out{Command::Kind::time_out, 0};
      if (mode == Mode::ladder) input.commands = std::span(&time_out, 1);
      match.step(input);
      match.snapshot(s.bytes);
      saved.push_back(std::move(s));
    }
  }
  return saved;
}

void change(std::vector<std::byte>& bytes, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHead = 3;
  for (std::size_t at = 0; at + kHead < size;) {
    const std::size_t place = data[at] + 256u * data[at + 1];
    const std::size_t wanted = (data[at + 2] & 7u) + 1u;
    at += kHead;
    const std::size_t count = std::min(wanted, size - at);
    if (place + count <= bytes.size()) std::memcpy(&bytes[place], data + at, count);
    at += count;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<SavedMatch> saved = saved_matches();
  if (size < 1) return 0;
  const SavedMatch& chosen = saved[data[0] % saved.size()];
  std::vector<std::byte> bytes = chosen.bytes;
  change(bytes, data + 1, size - 1);
  Match match = *Match::create(chosen.desc);
  if (!match.restore(bytes)) return 0;
  TickInput input;
  const std::array<Command, 2> commands{{{Command::Kind::push, 0}, {Command::Kind::push, 1}}};
  for (int tick = 0; tick < 20; ++tick) {
    input.commands = tick == 10 ? std::span<const Command>(commands) : std::span<const Command>();
    match.step(input);
    const vp::Vec3 ball = match.view().ball_position;
    if (!std::isfinite(ball.x) || !std::isfinite(ball.y) || !std::isfinite(ball.z)) std::abort();
  }
  std::vector<std::byte> again;
  match.snapshot(again);
  Match other = *Match::create(chosen.desc);
  if (!other.restore(again) || other.state_hash() != match.state_hash()) std::abort();
  return 0;
}
