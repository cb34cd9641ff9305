// Who drives each rod: for every rod an ordered list of sources, the first that has the rod drives
// it.
//
// Ownership, not activity: a source has a rod while its status is live or held. So an idle or
// unplugged person's rod holds and is never given to the next in the list behind the person's back;
// only `absent` (never there, or given up) or a new assign() passes a rod on.
//
// Nothing jumps when the driver changes: the difference between where the rod is and where the new
// driver says it is becomes an offset on top of that driver. Rods start at slide 0 and angle 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cabinet/rod_input.h"

namespace cabinet {

// What a source's positions mean, and so what becomes of the offset.
enum class Origin : std::uint8_t {
  relative,  // a handle with sensors: only its motion means anything; the offset stays, but that of
             // an angle which an index mark has made known
  absolute,  // knows the table (computer player, client that sees snapshots): the offset fades
};

class SourceMux final : public InputSource {
 public:
  static constexpr int kNobody = -1;

  // slide_limit: |slide| <= this on every rod [m]. A driver that pushes beyond it loses its offset.
  explicit SourceMux(const std::array<double, kRods>& slide_limit);

  // Its index, from 0. The source must outlive the mux. No source is ever removed: leave it out of
  // assign() instead.
  int add(InputSource& source, Origin origin);
  // The sources that may drive the rod, the most wanted first; indices that do not exist are
  // ignored. Empty: nobody.
  void assign(int rod, std::span<const int> order);
  // Says where the rod really is (a match was restored): output and driver continue from there.
  void place(int rod, double slide, double angle);

  // Polls every source once, then picks. While nobody drives a rod it stays, absent, at zero rates.
  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override { return rods_; }
  const SourceCounters& counters() const override { return counters_; }  // sums
  const std::string& name() const override { return name_; }

  int source_of(int rod) const { return slots_[rod].driver; }  // or kNobody
  const InputSource& source(int index) const { return *sources_[index].source; }

 private:
  struct Entry {
    InputSource* source;
    Origin origin;
  };
  struct Slot {
    std::vector<int> order;
    int driver = kNobody;
    double slide_offset = 0;
    double angle_offset = 0;  // fades to whole turns
  };
  int pick(int rod) const;
  void take_over(int rod, int driver);
  void follow(int rod, double seconds);

  std::array<double, kRods> slide_limit_;
  std::vector<Entry> sources_;
  std::array<Slot, kRods> slots_;
  RodInputs rods_{};
  SourceCounters counters_;
  std::string name_ = "rods";
  std::int64_t last_us_ = 0;
  bool started_ = false;
};

}  // namespace cabinet
