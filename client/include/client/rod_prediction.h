// Client-side prediction of the person's own rods. The simulation of a rod (foosball/rod_motion.h)
// follows the person's input at once. Differences from the server's reports are corrected smoothly.
//
// The server reports the effect of an input after a lag (network, tick, interpolation). So its rods
// are compared with the predicted rods of that time ago. The lag is estimated as the one at which
// both agreed best while the rods moved. The difference goes into an offset with the time constant
// kCorrectionS: a rod that a ball or a man blocks is drawn where it is blocked within a few frames
// of the server's report.
//
// One thread. The time is an argument; there is no clock here.
#pragma once

#include <array>
#include <cstdint>

#include "foosball/rod_motion.h"
#include "foosball/table.h"
#include "wire/input_datagram.h"
#include "wire/snapshot.h"

namespace client {

class RodPrediction {
 public:
  // Time constant [s] in which the offset closes 63% of a difference: 94% in five frames of a 60 Hz
  // display. With a shorter one, an error of a few milliseconds in the lag shows as jitter.
  static constexpr double kCorrectionS = 0.030;
  static constexpr int kLongestLagMs = 250;  // maximum of the estimated lag
  // Differences that an error of this size in the lag explains are ignored.
  static constexpr int kLagMarginMs = 8;

  explicit RodPrediction(foosball::Layout layout);
  // Sets the match's characters; the built-in ones until this is called.
  void set_characters(const foosball::Characters& characters) { characters_ = characters; }

  // Sets the match's tuning, as the server sent it.
  void set_tuning(const foosball::Tuning& tuning) { tuning_ = tuning; }

  // Processes one frame. hand: the input as it is sent now; server: the scene to be drawn. A rod is
  // shown as the server reports it if the input does not drive it or if the server does not receive
  // it from a client. The same holds for all rods while the match is paused.
  void update(const std::array<wire::InputRod, 8>& hand, const wire::Snapshot& server,
              std::int64_t now_us);
  // Moves the predicted rods and their men in the scene to their predicted poses.
  void apply(wire::Snapshot& scene) const;

  int lag_ms() const { return lag_ms_; }

 private:
  struct Pose {
    double slide = 0.0, angle = 0.0;
  };
  struct Rod {
    int index = 0;
    bool predicted = false;
    foosball::RodState state{};
    Pose offset;
    std::array<Pose, 512> history{};  // by tick of the prediction
  };
  void restart(Rod& rod, const wire::RodSnapshot& server);
  void advance(Rod& rod, const wire::InputRod& hand, const foosball::CharacterBody& body,
               std::int64_t ticks);
  const Pose& past(const Rod& rod, int ms_ago) const;
  void score_lags(const wire::Snapshot& server);
  void correct(Rod& rod, const wire::RodSnapshot& server, double seconds);

  const foosball::TableSpec& table_;
  foosball::Characters characters_ = foosball::built_in_characters();
  foosball::Tuning tuning_;
  std::array<Rod, foosball::kRods> rods_;
  std::int64_t tick_ = 0, clock_us_ = 0, updated_us_ = 0;
  bool started_ = false;
  int lag_ms_ = 0;
  std::array<float, kLongestLagMs + 1> disagreement_{};
};

}  // namespace client
