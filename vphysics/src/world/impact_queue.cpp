#include "world/impact_queue.h"

#include <algorithm>
#include <tuple>

namespace vp {
namespace {

bool is_later(const ImpactQueue::Entry& x, const ImpactQueue::Entry& y) {
  return std::tie(x.time, x.kind, x.key, x.pair) > std::tie(y.time, y.kind, y.key, y.pair);
}

}  // namespace

void ImpactQueue::reserve(std::size_t pairs) {
  pairs_.reserve(pairs);
  heap_.reserve(pairs);
}

void ImpactQueue::clear(std::size_t bodies) {
  pairs_.clear();
  heap_.clear();
  motions_.assign(bodies, 0);
}

std::uint32_t ImpactQueue::add(QueuedPair pair) {
  pair.motion_a = motions_[pair.a];
  pair.motion_b = motions_[pair.b];
  pairs_.push_back(pair);
  return static_cast<std::uint32_t>(pairs_.size() - 1);
}

void ImpactQueue::wait(std::uint32_t index, Kind kind) {
  const QueuedPair& pair = pairs_[index];
  heap_.push_back({pair.found + pair.after, kind, pair.swept.pair.key, index});
  std::push_heap(heap_.begin(), heap_.end(), is_later);
}

const ImpactQueue::Entry* ImpactQueue::first() {
  while (!heap_.empty() && !holds(pairs_[heap_.front().pair])) pop();
  return heap_.empty() ? nullptr : &heap_.front();
}

void ImpactQueue::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), is_later);
  heap_.pop_back();
}

}  // namespace vp
