// Two hands on four rods: a hand lets go of one rod and grips another only after the time that the
// way takes. A rod without a hand stays where it was left.
#pragma once

#include <array>

namespace foosball {

class ComputerHands {
 public:
  static constexpr int kNone = -1;
  static constexpr int kMost = 2;

  ComputerHands(int hands, int travel_ticks) : count_(hands), travel_(travel_ticks) {}

  // Brings hands to the lines first and second (0..3, or kNone), first before second. A hand whose
  // line is busy, a stroke under way, stays.
  void want(int first, int second, const std::array<bool, 4>& busy);
  // One tick.
  void pass_time();
  bool holds(int line) const;
  void leave(int line);  // whoever held it or was on the way to it is nowhere
  void let_go();         // both hands at rest, nowhere

 private:
  struct Hand {
    int line = kNone;
    int arrives_in = 0;  // ticks
  };
  bool going_to(int line) const;
  void send(int line, const std::array<bool, 4>& busy, int other);

  int count_, travel_;
  std::array<Hand, kMost> hands_{};
};

}  // namespace foosball
