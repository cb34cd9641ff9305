// The recorder: writes the calls that change a world.
#include "vphysics/recording.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recording_io.h"
#include "world/recording_limits.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {
namespace {

// A frame ends with a step, or when it is longer than this [bytes].
constexpr std::size_t kLongFrame = 1 << 20;

}  // namespace

std::uint32_t recording::check_of(std::span<const std::byte> bytes) {
  std::uint32_t hash = 0x811c9dc5u;  // FNV-1a
  for (const std::byte b : bytes) hash = (hash ^ std::to_integer<std::uint32_t>(b)) * 0x01000193u;
  return hash;
}

Expected<void> World::record(std::shared_ptr<Recorder> recorder) {
  if (recorder) {
    std::uint64_t untouched = 0;
    TopologyHash(untouched).add(impl_->given_desc);
    const auto begun = recorder->begin(*this, impl_->given_desc, impl_->topology_hash,
                                       impl_->topology_hash == untouched);
    if (!begun) return begun;
  }
  if (impl_->recorder) impl_->recorder->end();
  impl_->recorder = std::move(recorder);
  return {};
}

void World::Impl::log(const RecordedCall& call) {
  recorder->add(call, topology_hash);
}

Expected<void> Recorder::begin(const World& world, const WorldDesc& desc,
                               std::uint64_t topology_hash, bool empty) {
  if (begun_) return invalid("record: a recorder records once; make a new one");
  if (auto problem = problem_with(desc)) return invalid("record: " + *problem);
  begun_ = true;
  recording::Writer out(bytes_, parts_);
  std::vector<std::byte> snapshot;
  if (!empty) world.snapshot(snapshot);
  out(recording::kMagic, recording::kFormat, desc, topology_hash, !empty, snapshot);
  const std::uint32_t check = recording::check_of(bytes_);
  out.append(&check, sizeof check);
  return {};
}

void Recorder::add(const RecordedCall& call, std::uint64_t topology_hash) {
  recording::Writer out(frame_, parts_);
  out(call.what);
  if (recording::builds(call)) out(topology_hash);
  if (frame_.size() > kLongFrame) write_frame();
}

void Recorder::add_step(const World& world, double dt) {
  ++steps_;
  const bool hashed = hash_every_ != 0 && steps_ % hash_every_ == 0;
  const bool other = dt != dt_;
  dt_ = dt;
  recording::Writer out(frame_, parts_);
  out.byte(static_cast<std::uint8_t>(recording::kStep | (other ? recording::kNewDt : 0) |
                                     (hashed ? recording::kHash : 0)));
  if (other) out(dt);
  if (hashed) out(world.state_hash());
  write_frame();
}

void Recorder::end() {
  recording::Writer out(frame_, parts_);
  out.byte(recording::kEnd);
  out(steps_);
  write_frame();
}

void Recorder::write_frame() {
  const std::size_t begin = bytes_.size();
  recording::Writer out(bytes_, parts_);
  const auto length = static_cast<std::uint32_t>(frame_.size());
  out.append(&length, sizeof length);
  out.append(frame_.data(), frame_.size());
  const std::uint32_t check = recording::check_of(std::span(bytes_).subspan(begin));
  out.append(&check, sizeof check);
  frame_.clear();
}

std::vector<std::byte> Recorder::take() {
  return std::exchange(bytes_, {});
}

}  // namespace vp
