#include "calibration.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "fiber.h"
#include "frames.h"
#include "session.h"
#include "simulated_person.h"

namespace cabinet_bench {
namespace {

constexpr double kPutBackSeconds = 0.5;
constexpr int kMaxSetUpMs = 5000;  // for the sensors, before the people begin

cabinet::GuideOptions guide_options(int rod) {
  const auto& spec =
      foosball::table_spec(foosball::Layout::tournament).rods[static_cast<std::size_t>(rod)];
  return {.reach = spec.slide_limit,
          .push_side = foosball::push_sign(spec.team),
          .forward_sign = -foosball::attack_sign(spec.team)};
}

calibrate::SessionOptions session_options(int rod, double counts_per_mm) {
  calibrate::SessionOptions options;
  options.rods = {rod};
  options.start = cabinet::nominal_calibration(counts_per_mm);
  return options;
}

// A rod of the table whose person receives the controller's counts.
class RodOnTable final : public cabinet_test::SimulatedRod {
 public:
  RodOnTable(std::uint32_t seed, std::function<void()> wait_for_ms)
      : SimulatedRod({}, seed), wait_for_ms_(std::move(wait_for_ms)) {}
  void step(double to_slide, double to_angle) override {
    slide = to_slide;
    angle = to_angle;
    wait_for_ms_();
  }

 private:
  std::function<void()> wait_for_ms_;
};

// One rod, its person and the program that guides the person.
struct Place {
  Place(int rod, const std::function<void()>& wait_for_ms)
      : options(guide_options(rod)),
        guide(options),
        session(session_options(rod, 8)),
        hand(static_cast<std::uint32_t>(50 + rod), wait_for_ms),
        person(guide, hand, options) {
    person.on_start = [this] { session.confirm(); };
  }
  cabinet::GuideOptions options;
  cabinet::CalibrationGuide guide;  // as the person reads it on the screen
  calibrate::Session session;
  RodOnTable hand;
  cabinet_test::Person person;
};

class Workshop {
 public:
  Workshop(Controller& controller, Table& table)
      : controller_(controller), table_(table), frames_(controller.framing()) {
    for (std::size_t rod = 0; rod < places_.size(); ++rod) {
      places_[rod].emplace(static_cast<int>(rod), [this, rod] { persons_[rod]->give_way(); });
      persons_[rod].emplace([this, rod] { work(*places_[rod]); });
    }
  }

  CalibrationResult run() {
    for (int ms = 0; ms < kMaxSetUpMs && !all_answer(); ++ms) pass_ms();
    const std::int64_t began_us = controller_.now_us();
    while (all_move_on()) pass_ms();
    table_.forget_turns();
    return result(static_cast<double>(controller_.now_us() - began_us) * 1e-6);
  }

 private:
  static void work(Place& place) {
    place.person.follow();
    const double turns = std::round(place.hand.angle / (2 * M_PI));
    const double down = turns * 2 * M_PI + place.hand.draw(place.person.angle_error);
    place.hand.move(0, down, kPutBackSeconds);
  }
  // Advances each person by a millisecond; false: all are done.
  bool all_move_on() {
    bool anybody = false;
    for (auto& person : persons_) {
      if (!person->done()) person->resume();
      anybody = anybody || !person->done();
    }
    return anybody;
  }
  bool all_answer() const { return last_ && last_->present == 0xFF; }
  void pass_ms() {
    PerRod<Pose> poses;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = {places_[i]->hand.slide, places_[i]->hand.angle};
    }
    table_.move(poses);
    table_.pass(controller_);
    for (const Packet& packet : controller_.take_packets()) {
      frames_.take(packet.bytes, [this](const wire::DeviceFrame& frame) { receive(frame); });
    }
  }
  void receive(const wire::DeviceFrame& frame) {
    const auto counts = [](std::uint16_t from, std::uint16_t to) {
      return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
    };
    for (std::size_t i = 0; i < places_.size(); ++i) {
      places_[i]->session.update(frame);
      if (!last_) continue;
      places_[i]->hand.increments.push_back(
          {counts(last_->slide[i], frame.slide[i]), counts(last_->spin[i], frame.spin[i]),
           static_cast<float>(frame.time_us - last_->time_us) * 1e-6f});
    }
    last_ = frame;
  }
  CalibrationResult result(double seconds) const {
    CalibrationResult result;
    result.seconds = seconds;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const calibrate::Session& session = places_[i]->session;
      result.calibration.rods[i] = session.calibration().rods[i];
      if (!session.fit()) {
        result.problem += "rod " + std::to_string(i + 1) + ": " + session.problem() + " (step " +
                          std::to_string(session.guide().step()) + "); ";
        continue;
      }
      if (result.calibration.rods[i].index) ++result.marks;
      result.slide_rms = std::max(result.slide_rms, session.fit()->slide_rms);
      result.angle_rms = std::max(result.angle_rms, session.fit()->angle_rms);
    }
    return result;
  }

  Controller& controller_;
  Table& table_;
  Frames frames_;
  PerRod<std::optional<Place>> places_;
  std::optional<wire::DeviceFrame> last_;
  PerRod<std::optional<Fiber>> persons_;
};

}  // namespace

CalibrationResult calibrate(Controller& controller, Table& table) {
  return Workshop(controller, table).run();
}

}  // namespace cabinet_bench
