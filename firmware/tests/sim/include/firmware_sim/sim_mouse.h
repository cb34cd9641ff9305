// Simulates a PS/2 mouse on its two wires. It generates the clock, answers commands, and in stream
// mode sends a packet every report period while there is movement. It only sees the levels of the
// wires, and the time passed to it.
//
// The wires are open drain: a line is low when either side pulls it low.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace firmware_sim {

struct MouseOptions {
  std::uint32_t clock_hz = 12'500;   // 10,000 to 16,700 in the standard
  std::uint32_t jitter_ns = 0;       // max deviation of each clock phase, in both directions
  std::uint32_t byte_gap_us = 120;   // between the bytes of a packet
  std::uint32_t reply_us = 300;      // from the end of a command to its answer
  std::uint32_t self_test_ms = 400;  // from power-on or reset to AA 00
  // Movement beyond nine bits waits for the next packet; otherwise it is lost and the overflow flag
  // set.
  bool splits_overflow = true;
  bool forgets_cut_packets = false;  // a command after a packet's first byte discards its counts
  bool counts_disabled = false;      // answers EB with movement even if not enabled
  std::uint64_t seed = 1;
};

class SimMouse {
 public:
  // Powered on at time 0.
  explicit SimMouse(const MouseOptions& options = {});

  // ---- motion
  // Moves by integer counts, reported from the next report on. Lost while the mouse is not enabled.
  void move(int slide_counts, int spin_counts);
  struct Counts {
    int slide = 0, spin = 0;
  };
  // A hand that moves continuously: when a report is due, it returns the motion since the last
  // call. It stays over unplugging; motion while the mouse is not enabled is lost.
  void follow(std::function<Counts(std::uint64_t now_ns)> hand) { hand_ = std::move(hand); }
  // Before power-on or while unplugged.
  void set_options(const MouseOptions& options);
  void unplug();
  void replug();  // power-on, self-test, then waits to be set up

  // ---- faults, one occurrence each
  void skip_clock(int bit);  // a packet byte lacks the clock pulse of this bit (0..10)
  void flip_parity();        // a packet byte has a parity error
  void drop_stop();          // a packet byte has stop bit 0
  void lose_byte();          // the second byte of a packet is not sent
  // In this bit (0..10) of a packet byte, the clock stays low longer by this much, or is pulled low
  // once more while it is high.
  void stretch_clock(int bit, std::uint32_t longer_us);
  void glitch_clock(int bit, std::uint32_t width_ns);
  void misread_command();              // the next command is answered with FE
  void lose_announcement();            // the next AA 00 is not sent
  void spike(std::uint64_t width_ns);  // pulls the clock low as soon as the mouse is idle

  // ---- observations
  bool plugged() const { return phase_ != Phase::unplugged; }
  bool enabled() const { return enabled_; }
  int rate() const { return rate_; }
  int counts_per_mm() const { return 1 << resolution_; }
  std::uint64_t packets_sent() const { return packets_sent_; }
  // When the last bit of the last movement packet was sent [us]; 0: none yet.
  std::uint64_t last_packet_us() const { return last_packet_ns_ / 1000; }
  // Nothing is pending or being sent.
  bool settled() const;
  // Commands as received, with their arguments.
  const std::vector<std::uint8_t>& commands() const { return commands_; }
  // Counts sent, saturated ones as they were sent.
  std::int64_t slide_sent() const { return slide_sent_; }
  std::int64_t spin_sent() const { return spin_sent_; }
  // Pending counts, including those of an incomplete packet.
  Counts unsent() const;
  std::uint64_t overflows_sent() const { return overflows_sent_; }

  // ---- wires
  bool clock_low() const { return clock_low_ || spiking_; }
  bool data_low() const { return data_low_; }
  std::uint64_t next_event_ns() const;
  // Handles events due at now_ns, given the lines that the host pulls low. Call at next_event_ns().
  void step(std::uint64_t now_ns, bool host_clock_low, bool host_data_low);

 private:
  enum class Phase {
    unplugged,
    self_test,
    idle,
    send_data,  // data changes while the clock is high
    send_fall,
    send_rise,
    send_glitch,  // the clock falls once more
    take_fall,    // the host sends: reads data as the clock rises
    take_rise,
    ack_fall,
    ack_rise,
    ack_end,
  };
  enum class Fault { none, skip_clock, flip_parity, drop_stop, lose_byte, stretch, glitch };
  struct Chunk {  // sent as a unit, again from its start if the host interrupts it
    std::vector<std::uint8_t> bytes;
    bool movement = false;
    int slide = 0, spin = 0;
    bool overflow = false;
  };

  bool faulty_bit(Fault fault) const { return byte_fault_ == fault && bit_at_ == fault_bit_; }
  void feel(std::uint64_t now_ns);
  void at_idle(std::uint64_t now_ns, bool host_clock_low, bool host_data_low);
  void start_byte(std::uint64_t now_ns);
  void end_byte(std::uint64_t now_ns);
  void abort(std::uint64_t now_ns);
  void end_command_byte(std::uint64_t now_ns);
  void obey(std::uint8_t value, std::uint64_t now_ns);
  void answer(std::vector<std::uint8_t> bytes, std::uint64_t now_ns);
  void set_defaults();
  Chunk take_movement();
  void after(std::uint64_t now_ns, std::uint64_t delay_ns, Phase phase);
  std::uint64_t period_fraction(int quarters);
  bool spikes_due(std::uint64_t now_ns);

  MouseOptions options_;
  std::mt19937_64 random_;
  Phase phase_ = Phase::self_test;
  std::uint64_t due_ns_ = 0;
  std::uint64_t now_ns_ = 0;
  bool clock_low_ = false, data_low_ = false;

  std::deque<Chunk> outgoing_;
  std::size_t byte_at_ = 0;
  bool cut_after_byte_ = false;  // the host interrupted the packet after a complete byte of it
  int bit_at_ = 0;
  std::uint16_t frame_ = 0;
  Chunk last_sent_;
  Fault fault_ = Fault::none, byte_fault_ = Fault::none;
  int fault_bit_ = 0;
  std::uint32_t fault_ns_ = 0;
  std::optional<std::uint64_t> spike_width_ns_;
  std::uint64_t spike_end_ns_ = 0;
  bool spiking_ = false;

  std::uint16_t taken_ = 0;
  int taken_bits_ = 0;
  std::uint8_t argument_of_ = 0;
  std::vector<std::uint8_t> commands_;
  bool reset_after_answer_ = false;
  bool misreads_ = false, announcement_lost_ = false;

  bool enabled_ = false;
  bool remote_ = false;
  int rate_ = 100;
  int resolution_ = 2;
  std::int64_t pending_slide_ = 0, pending_spin_ = 0;
  std::uint64_t next_report_ns_ = 0;
  std::uint64_t packets_sent_ = 0, overflows_sent_ = 0, last_packet_ns_ = 0;
  std::int64_t slide_sent_ = 0, spin_sent_ = 0;
  std::function<Counts(std::uint64_t now_ns)> hand_;
};

}  // namespace firmware_sim
