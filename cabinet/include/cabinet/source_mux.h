// Selects the driver of each rod: every rod has an ordered list of sources, and the first one that
// owns the rod drives it.
//
// Ownership, not activity, decides: a source owns a rod while its status is live or held. So the
// rod of an idle or unplugged person stays held and does not pass to the next source in the list.
// Only `absent` (never connected, or given up) or a new assign() passes a rod on.
//
// Nothing jumps when the driver changes: the difference between the rod's pose and the new driver's
// pose becomes an offset added to that driver. Rods start at slide 0 and angle 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cabinet/rod_input.h"

namespace cabinet {

// The reference of a source's positions, which determines how its offset changes.
enum class Origin : std::uint8_t {
  // A handle with sensors: only motion is meaningful; the offset stays, except that of an angle
  // which an index mark has made known.
  relative,
  absolute,  // knows the table (computer player, client with snapshots): the offset fades
};

class SourceMux final : public InputSource {
 public:
  static constexpr int kNobody = -1;

  // slide_limit: |slide| <= this on every rod [m]. A driver that goes beyond it loses its offset.
  explicit SourceMux(const std::array<double, kRods>& slide_limit);

  // Returns the index of the source, from 0. The source must outlive the mux. Sources are never
  // removed: leave one out of assign() instead.
  int add(InputSource& source, Origin origin);
  // The sources that may drive the rod, in descending priority. Ignores indices that do not exist.
  // Empty: no source.
  void assign(int rod, std::span<const int> order);
  // Sets the true pose of a rod (a match was restored): output and driver continue from there.
  void place(int rod, double slide, double angle);

  // Polls every source once, then selects the drivers. A rod without a driver is absent and stays
  // in place with zero rates.
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
    double angle_offset = 0;  // fades to a multiple of 2 pi
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
