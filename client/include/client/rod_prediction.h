// The person's own rods, drawn as the hand has them now and not as the server last said: the
// simulation of a rod (foosball/rod_motion.h) follows the hand at once, and what the server reports
// differently is added smoothly.
//
// The server reports the effect of an input after a lag (network, tick, interpolation). So its rods
// are compared with the predicted ones of that long ago. The lag is estimated: the one at which
// both agreed best while the rods moved. The difference goes into an offset with kCorrectionS: a
// rod that a ball or a man blocks is drawn where it is blocked within a few frames of the server's
// report.
//
// One thread. No clock: time is handed in.
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
  // The offset closes 63% of a difference in so long [s]: 94% in five frames of a 60 Hz display.
  // Shorter, a lag that is estimated wrong by a few milliseconds shows as trembling.
  static constexpr double kCorrectionS = 0.030;
  static constexpr int kLongestLagMs = 250;  // later reports are compared with this long ago
  // Differences that a wrong lag of so much explains are no differences.
  static constexpr int kLagMarginMs = 8;

  explicit RodPrediction(foosball::Layout layout);
  // Those that the match has; the built-in ones until this is called.
  void set_characters(const foosball::Characters& characters) { characters_ = characters; }

  // As the server says that the match is tuned.
  void set_tuning(const foosball::Tuning& tuning) { tuning_ = tuning; }

  // One frame. hand: as it is sent now; server: the scene to be drawn. Rods that the hand does not
  // drive or the server does not have from a client, and all rods of a match that is paused, are as
  // the server has them.
  void update(const std::array<wire::InputRod, 8>& hand, const wire::Snapshot& server,
              std::int64_t now_us);
  // Moves the predicted rods in the scene, with their men, to where they are predicted.
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
    std::array<Pose, 512> history{};  // by tick of this prediction
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
