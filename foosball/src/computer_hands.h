// Two hands for four rods. A hand that changes rods needs a travel time. A rod without a hand stays
// where it was left.
#pragma once

#include <array>

namespace foosball {

class ComputerHands {
 public:
  static constexpr int kNone = -1;
  static constexpr int kMax = 2;

  ComputerHands(int hands, int travel_ticks) : count_(hands), travel_(travel_ticks) {}

  // Sends hands to the lines first and second (0..3, or kNone); first has priority. A hand stays on
  // a busy line (a stroke in progress).
  void want(int first, int second, const std::array<bool, 4>& busy);
  // One tick.
  void pass_time();
  bool holds(int line) const;
  void leave(int line);  // the hand that holds it or travels to it becomes free
  void let_go();         // both hands become free, at rest

 private:
  struct Hand {
    int line = kNone;
    int arrives_in = 0;  // ticks
  };
  bool going_to(int line) const;
  void send(int line, const std::array<bool, 4>& busy, int other);

  int count_, travel_;
  std::array<Hand, kMax> hands_{};
};

}  // namespace foosball
