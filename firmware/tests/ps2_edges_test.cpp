// The receiver and the parser on traces of clock and data (data/*.edges), sampled as on the board,
// at every phase of the sampler relative to the trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/mouse_packet.h"
#include "core/ps2_lines.h"
#include "core/ps2_receiver.h"

namespace firmware {
namespace {

using Moves = std::vector<std::pair<int, int>>;

struct Trace {
  struct Level {
    std::uint64_t ns;
    bool clock, data;
  };
  std::vector<Level> levels;
  Moves moves;
  int parity = 0, framing_min = 0, framing_max = 0;
};

Trace read_trace(const std::string& path) {
  Trace trace;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    if (line.empty() || line[0] == '#') continue;
    if (line.rfind("expect", 0) != 0) {
      Trace::Level level{};
      words >> level.ns >> level.clock >> level.data;
      trace.levels.push_back(level);
      continue;
    }
    words >> word >> word;
    if (word == "parity") words >> trace.parity;
    if (word == "framing") words >> trace.framing_min >> trace.framing_max;
    if (word != "moves") continue;
    char comma = 0;
    for (std::pair<int, int> move; words >> move.first >> comma >> move.second;)
      trace.moves.push_back(move);
  }
  return trace;
}

struct Heard {
  Moves moves;
  int parity = 0, framing = 0;
};

class Listener {
 public:
  Heard heard;

  void take(Ps2Receiver::Event event) {
    if (event == Ps2Receiver::kNone) return;
    if (event == Ps2Receiver::kFramingError) {
      ++heard.framing;
      parser_.lose();
      return;
    }
    if (event == Ps2Receiver::kParityError) ++heard.parity;
    const bool good = event == Ps2Receiver::kByte;
    if (parser_.byte(receiver.byte(), good, receiver.after_gap()) == PacketParser::kMovement) {
      heard.moves.emplace_back(parser_.movement().slide, parser_.movement().spin);
    }
  }

  Ps2Receiver receiver;

 private:
  PacketParser parser_;
};

Heard listen(const Trace& trace, std::uint64_t phase_ns) {
  constexpr int kSamplesPerSweep = 80;  // 1.6 ms, as on the board
  Ps2Lines lines;
  Listener listener;
  std::size_t at = 0;
  int samples = 0;
  for (std::uint64_t ns = phase_ns; ns < trace.levels.back().ns; ns += kSampleUs * 1000u) {
    while (at + 1 < trace.levels.size() && trace.levels[at + 1].ns <= ns) ++at;
    const auto clock = static_cast<std::uint8_t>(trace.levels[at].clock ? 0xFF : 0xFE);
    const auto data = static_cast<std::uint8_t>(trace.levels[at].data ? 0xFF : 0xFE);
    lines.count_sample();
    lines.sample(clock, data, clock, [](std::uint8_t) {});
    for (Edges edges{}; lines.pop(edges);)
      listener.take(listener.receiver.edge(edges.tick, edges.data & 1));
    if (++samples % kSamplesPerSweep == 0) listener.take(listener.receiver.sweep(lines.tick()));
  }
  return listener.heard;
}

std::vector<std::string> trace_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(EDGES_DIRECTORY)) {
    if (entry.path().extension() == ".edges") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class EdgeTrace : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Files, EdgeTrace, testing::ValuesIn(trace_files()),
                         [](const auto& chosen) { return chosen.param; });

TEST_P(EdgeTrace, IsReadTheSameAtEveryPhaseOfTheSampler) {
  const Trace trace = read_trace(std::string(EDGES_DIRECTORY) + "/" + GetParam() + ".edges");
  ASSERT_GT(trace.levels.size(), 20u);
  ASSERT_FALSE(trace.moves.empty());
  for (std::uint64_t phase_ns = 0; phase_ns < kSampleUs * 1000u; phase_ns += 500) {
    const Heard heard = listen(trace, phase_ns);
    EXPECT_EQ(heard.moves, trace.moves) << "phase " << phase_ns << " ns";
    EXPECT_EQ(heard.parity, trace.parity) << "phase " << phase_ns << " ns";
    EXPECT_GE(heard.framing, trace.framing_min) << "phase " << phase_ns << " ns";
    EXPECT_LE(heard.framing, trace.framing_max) << "phase " << phase_ns << " ns";
  }
}

TEST(EdgeTraces, AreAllThere) {
  EXPECT_GE(trace_files().size(), 16u);
}

}  // namespace
}  // namespace firmware
