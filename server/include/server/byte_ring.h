// Lock-free byte ring for one writer thread and one reader thread. A write is atomic: it stores all
// bytes or none, and the reader sees all of them at once.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace server {

class ByteRing {
 public:
  explicit ByteRing(std::size_t capacity) : bytes_(capacity) {}

  // Writer. Returns false, and stores nothing, if the bytes do not fit.
  bool write(std::span<const std::byte> in) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (in.size() > bytes_.size() - (tail - head_.load(std::memory_order_acquire))) return false;
    const std::size_t at = tail % bytes_.size();
    const std::size_t first = std::min(in.size(), bytes_.size() - at);
    if (first > 0) std::memcpy(bytes_.data() + at, in.data(), first);
    if (in.size() > first) std::memcpy(bytes_.data(), in.data() + first, in.size() - first);
    tail_.store(tail + in.size(), std::memory_order_release);
    return true;
  }

  // Reader. The readable bytes up to the end of the ring, in one piece; empty if there are none.
  // Valid until consume().
  std::span<const std::byte> peek() const {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t size = tail_.load(std::memory_order_acquire) - head;
    const std::size_t at = head % bytes_.size();
    return {bytes_.data() + at, std::min(size, bytes_.size() - at)};
  }

  void consume(std::size_t size) {
    head_.store(head_.load(std::memory_order_relaxed) + size, std::memory_order_release);
  }

 private:
  std::vector<std::byte> bytes_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace server
