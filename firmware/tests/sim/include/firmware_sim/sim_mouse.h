// A PS/2 mouse as seen from its two wires: it generates the clock, answers commands, and in stream
// mode sends a packet a report period while there is movement. It knows nothing of the host but the
// level of the wires, and nothing of the simulator but the time it is told.
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
  std::uint32_t clock_hz = 12'500;   // 10,000 to 16,700 by the standard
  std::uint32_t jitter_ns = 0;       // each clock phase is off by up to this, either way
  std::uint32_t byte_gap_us = 120;   // between the bytes of a packet
  std::uint32_t reply_us = 300;      // from a command's end to its answer
  std::uint32_t self_test_ms = 400;  // from power-on or reset to AA 00
  bool splits_overflow = true;  // movement beyond nine bits waits for the next packet; otherwise
                                // it is lost and the overflow flag says so
  bool forgets_cut_packets = false;  // a command after a packet's first byte loses its counts
  bool counts_disabled = false;      // answers EB with movement though it is not enabled
  std::uint64_t seed = 1;
};

class SimMouse {
 public:
  // Powered at time 0.
  explicit SimMouse(const MouseOptions& options = {});

  // ---- the hand
  // Moves by whole counts; reported from the next report on. Lost while the mouse is not enabled.
  void move(int slide_counts, int spin_counts);
  struct Counts {
    int slide = 0, spin = 0;
  };
  // A hand that moves all the time: asked, when a report is due, how far it has come since it was
  // asked last. Kept over unplugging; what it moves while the mouse is not enabled is lost.
  void follow(std::function<Counts(std::uint64_t now_ns)> hand) { hand_ = std::move(hand); }
  // Before power-on or while unplugged.
  void set_options(const MouseOptions& options);
  void unplug();
  void replug();  // power-on, self-test, then waits to be set up

  // ---- faults, each once
  void skip_clock(int bit);  // a packet byte lacks its clock pulse number bit (0..10)
  void flip_parity();        // a packet byte has wrong parity
  void drop_stop();          // a packet byte has stop bit 0
  void lose_byte();          // the second byte of a packet is not sent
  // The clock stays low for so much longer in bit (0..10) of a packet byte; or is pulled low once
  // more while it is high.
  void stretch_clock(int bit, std::uint32_t longer_us);
  void glitch_clock(int bit, std::uint32_t width_ns);
  void misread_command();              // the next command gets FE for an answer
  void lose_announcement();            // the next AA 00 is not sent
  void spike(std::uint64_t width_ns);  // the clock is pulled low as soon as the mouse is idle

  // ---- what it did
  bool plugged() const { return phase_ != Phase::unplugged; }
  bool enabled() const { return enabled_; }
  int rate() const { return rate_; }
  int counts_per_mm() const { return 1 << resolution_; }
  std::uint64_t packets_sent() const { return packets_sent_; }
  // When the last bit of the last movement packet went out [us]; 0: none yet.
  std::uint64_t last_packet_us() const { return last_packet_ns_ / 1000; }
  // Nothing waits to be reported or is being sent.
  bool settled() const;
  // Commands as received, with their arguments.
  const std::vector<std::uint8_t>& commands() const { return commands_; }
  // Counts handed to the wire, saturated ones as they were sent.
  std::int64_t slide_sent() const { return slide_sent_; }
  std::int64_t spin_sent() const { return spin_sent_; }
  // Counts that wait, and those of a packet that is not out whole.
  Counts unsent() const;
  std::uint64_t overflows_sent() const { return overflows_sent_; }

  // ---- the wires
  bool clock_low() const { return clock_low_ || spiking_; }
  bool data_low() const { return data_low_; }
  std::uint64_t next_event_ns() const;
  // Does what is due at now_ns, given what the host pulls low. Call at next_event_ns().
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
    take_fall,    // the host sends: data is read as the clock rises
    take_rise,
    ack_fall,
    ack_rise,
    ack_end,
  };
  enum class Fault { none, skip_clock, flip_parity, drop_stop, lose_byte, stretch, glitch };
  struct Chunk {  // sent as a whole, again from its start when the host interrupts it
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
  bool cut_after_byte_ = false;  // the host cut the packet off after a whole byte of it
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
