#include "match_run.h"

#include <sys/socket.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <stdexcept>

#include "cabinet/device_haptics.h"
#include "hands.h"
#include "mark_watch.h"
#include "os/file_descriptor.h"
#include "pulse_watch.h"
#include "server/server.h"

namespace cabinet_bench {
namespace {

constexpr std::int64_t kSettleMs = 50;  // of frames, before a hand moves

void require(bool held, const char* what) {
  if (!held) throw std::runtime_error(what);
}

// The cable between the controller and the server. A packet is delayed by the time that the PC
// needs to notice it.
class Cable {
 public:
  Cable(Controller& controller, std::uint32_t seed) : controller_(controller), random_(seed) {
    const bool reports = controller.framing() == cabinet::DeviceFraming::report;
    int ends[2];
    require(::socketpair(AF_UNIX, (reports ? SOCK_SEQPACKET : SOCK_STREAM) | SOCK_CLOEXEC, 0,
                         ends) == 0,
            "no socket pair");
    device_ = os::FileDescriptor(ends[0]);
    host_ = os::FileDescriptor(ends[1]);
  }
  int host_end() { return host_.release(); }
  std::int64_t arrived_us() const { return arrived_us_; }

  // Delivers the packets that have arrived by now to the server.
  void carry() {
    for (Packet& packet : controller_.take_packets()) {
      packet.time_us += std::uniform_int_distribution<int>(100, 300)(random_);
      under_way_.push_back(std::move(packet));
    }
    while (!under_way_.empty() && under_way_.front().time_us <= controller_.now_us()) {
      const Packet& packet = under_way_.front();
      require(::send(device_.get(), packet.bytes.data(), packet.bytes.size(), MSG_DONTWAIT) ==
                  static_cast<ssize_t>(packet.bytes.size()),
              "a packet was not taken");
      arrived_us_ = packet.time_us;
      under_way_.pop_front();
    }
  }
  // Delivers the server's data to the controller, packet by packet; a serial line concatenates
  // packets.
  template <class Each>
  void carry_back(const Each& each) {
    std::uint8_t bytes[4096];
    for (;;) {
      const ssize_t got = ::recv(device_.get(), bytes, sizeof bytes, MSG_DONTWAIT);
      if (got <= 0) return;
      const std::span<const std::uint8_t> all(bytes, static_cast<std::size_t>(got));
      if (controller_.framing() == cabinet::DeviceFraming::report) {
        each(all);
        continue;
      }
      for (auto at = all.begin(); at != all.end();) {
        const auto end = std::find(at, all.end(), std::uint8_t{0});
        require(end != all.end(), "a packet was cut");
        each(std::span(at, end + 1));
        at = end + 1;
      }
    }
  }

 private:
  Controller& controller_;
  std::mt19937 random_;
  os::FileDescriptor device_, host_;
  std::deque<Packet> under_way_;
  std::int64_t arrived_us_ = 0;
};

class MatchRun {
 public:
  MatchRun(Controller& controller, Table& table, const cabinet::Calibration& calibration,
           const MatchOptions& options)
      : controller_(controller),
        table_(table),
        options_(options),
        cable_(controller, 5),
        hands_(options, table.poses()) {
    controller.take_packets();  // drops earlier packets
    server::ServerOptions wanted;
    wanted.match.layout = kLayout;
    wanted.match.seed = options.seed;
    wanted.cabinet = true;
    wanted.session = 0xCAB;
    wanted.random = [token = std::uint64_t{1}]() mutable { return token++; };
    auto made = server::Server::create(std::move(wanted));
    require(made.has_value(), "the server does not start");
    server_ = std::move(*made);
    plug_in(calibration);
  }

  MatchResult run() {
    const std::int64_t ms = std::llround(options_.max_seconds * 1e3);
    for (std::int64_t i = 0; i < kSettleMs; ++i) tick(false);
    for (std::int64_t i = 0; i < ms && !over(); ++i) tick(true);
    finish();
    return std::move(result_);
  }

 private:
  void plug_in(const cabinet::Calibration& calibration) {
    cabinet::DeviceOptions options;
    options.framing = controller_.framing();
    options.calibration = calibration;
    const foosball::TableSpec& spec = foosball::table_spec(kLayout);
    for (std::size_t rod = 0; rod < spec.rods.size(); ++rod) {
      options.slide_limit[rod] = spec.rods[rod].slide_limit;
    }
    options.arrived_us = [this] { return cable_.arrived_us(); };
    auto source = std::make_unique<cabinet::DeviceSource>(
        options, [this] { return std::exchange(host_end_, -1); });
    host_end_ = cable_.host_end();
    source_ = source.get();
    auto motors = std::make_unique<cabinet::CabinetHaptics>();
    motors->add(*source);
    server_->add_device(std::move(source));
    server_->set_cabinet_haptics(std::move(motors));
  }

  bool over() const { return server_->match().view().screen == foosball::Screen::end; }

  void tick(bool played) {
    const PerRod<Pose> to = played ? hands_.move(server_->match().view()) : table_.poses();
    table_.move(to);
    if (played) marks_.moved(table_);
    table_.pass(controller_);
    if (played) note_rods();
    for (const MotorWrite& write : controller_.take_motor_writes()) pulses_.written(write);
    cable_.carry();
    server_->tick(controller_.now_us());
    server_->wait_sent();
    if (played) note_input();
    pulses_.passed(controller_.now_us());
    cable_.carry_back([this](std::span<const std::uint8_t> packet) {
      pulses_.commanded(packet, controller_.framing(), controller_.now_us());
      controller_.command(packet);
    });
    for (const foosball::Event& event : server_->match().events()) {
      if (event.kind == foosball::EventKind::man_hit) ++result_.pulses.hits;
    }
  }
  // The previous tick has moved the rods to the hands' present poses.
  void note_rods() {
    const foosball::MatchView& view = server_->match().view();
    for (std::size_t rod = 0; rod < view.rods.size(); ++rod) {
      result_.rod.add({view.rods[rod].slide, view.rods[rod].angle}, table_.poses()[rod]);
      const foosball::RodState& hand = hands_.rod(rod);
      result_.free.add({free_[rod].slide, free_[rod].angle}, table_.poses()[rod]);
      result_.ideal.add({ideal_[rod].slide, ideal_[rod].angle}, table_.poses()[rod]);
      ideal_[rod] = step_rod(view, rod, ideal_[rod],
                             {hand.slide, hand.angle, hand.slide_rate, hand.angle_rate, true});
      result_.fastest_slide = std::max(result_.fastest_slide, std::abs(hand.slide_rate));
      result_.fastest_angle = std::max(result_.fastest_angle, std::abs(hand.angle_rate));
    }
  }
  void note_input() {
    for (std::size_t rod = 0; rod < table_.poses().size(); ++rod) {
      const cabinet::RodInput& input = source_->rods()[rod];
      result_.input.add({input.slide, input.angle}, table_.poses()[rod]);
      free_[rod] = step_rod(server_->match().view(), rod, free_[rod],
                            {input.slide, input.angle, input.slide_rate, input.angle_rate, true});
    }
    result_.seconds += foosball::kTick;
  }
  void finish() {
    const foosball::MatchView& view = server_->match().view();
    result_.score = view.score;
    result_.over = over();
    const cabinet::SourceCounters& counted = source_->counters();
    result_.frames = counted.frames;
    result_.lost = counted.lost;
    result_.bad = counted.bad;
    result_.overflows = counted.overflows;
    result_.impossible = counted.impossible;
    result_.line_errors = counted.line_errors;
    const std::uint64_t hits = result_.pulses.hits;
    result_.pulses = pulses_.counts();
    result_.pulses.hits = hits;
    result_.marks = marks_.counts();
    result_.disagreements = std::accumulate(counted.index_disagreements.begin(),
                                            counted.index_disagreements.end(), std::uint64_t{0});
  }

  Controller& controller_;
  Table& table_;
  MatchOptions options_;
  Cable cable_;
  int host_end_ = -1;
  Hands hands_;
  std::array<foosball::RodState, foosball::kRods> free_{}, ideal_{};
  std::unique_ptr<server::Server> server_;
  const cabinet::DeviceSource* source_ = nullptr;
  PulseWatch pulses_;
  MarkWatch marks_;
  MatchResult result_;
};

}  // namespace

void Errors::add(const Pose& is, const Pose& should) {
  slide.push_back(static_cast<float>(std::abs(is.slide - should.slide)));
  angle.push_back(static_cast<float>(std::abs(is.angle - should.angle)));
}

Errors Errors::last(std::size_t ticks) const {
  const auto n = static_cast<std::ptrdiff_t>(std::min(ticks * cabinet::kRods, slide.size()));
  return {{slide.end() - n, slide.end()}, {angle.end() - n, angle.end()}};
}

Spread spread(std::vector<float> absolute) {
  Spread s;
  if (absolute.empty()) return s;
  std::ranges::sort(absolute);
  double squares = 0;
  for (const float value : absolute) {
    squares += static_cast<double>(value) * static_cast<double>(value);
  }
  s.rms = std::sqrt(squares / static_cast<double>(absolute.size()));
  s.p99 = static_cast<double>(absolute[(absolute.size() - 1) * 99 / 100]);
  s.max = static_cast<double>(absolute.back());
  return s;
}

double share_within(const Errors& errors, double slide, double angle) {
  std::size_t within = 0;
  for (std::size_t i = 0; i < errors.slide.size(); ++i) {
    within += static_cast<double>(errors.slide[i]) <= slide &&
              static_cast<double>(errors.angle[i]) <= angle;
  }
  return errors.slide.empty()
             ? 0.0
             : static_cast<double>(within) / static_cast<double>(errors.slide.size());
}

MatchResult play_match(Controller& controller, Table& table,
                       const cabinet::Calibration& calibration, const MatchOptions& options) {
  return MatchRun(controller, table, calibration, options).run();
}

}  // namespace cabinet_bench
