// The queues between threads; also the main test for the thread sanitizer.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <thread>

#include "server/byte_ring.h"
#include "server/spsc_queue.h"

namespace server {
namespace {

TEST(SpscQueue, KeepsTheOrderAcrossThreads) {
  constexpr std::uint64_t kCount = 100'000;
  SpscQueue<std::uint64_t, 64> queue;
  std::thread writer([&queue] {
    for (std::uint64_t i = 0; i < kCount;) {
      if (queue.push(i)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t expected = 0;
  while (expected < kCount) {
    std::uint64_t value = 0;
    if (!queue.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(value, expected);
    ++expected;
  }
  writer.join();
}

TEST(SpscQueue, RefusesWhatDoesNotFitAndSaysHowMuchDoes) {
  SpscQueue<std::string, 4> queue;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(queue.room(), static_cast<std::size_t>(4 - i));
    EXPECT_TRUE(queue.push(std::to_string(i)));
  }
  EXPECT_FALSE(queue.push("4"));
  std::string value;
  EXPECT_TRUE(queue.pop(value));
  EXPECT_EQ(value, "0");
  EXPECT_TRUE(queue.push("4"));
  for (const char* expected : {"1", "2", "3", "4"}) {
    EXPECT_TRUE(queue.pop(value));
    EXPECT_EQ(value, expected);
  }
  EXPECT_FALSE(queue.pop(value));
}

std::vector<std::byte> run_of(std::size_t size, std::uint8_t first) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = std::byte(first + i);
  return bytes;
}

TEST(ByteRing, TakesAWriteWholeOrNotAtAll) {
  ByteRing ring(10);
  EXPECT_TRUE(ring.write(run_of(7, 0)));
  EXPECT_FALSE(ring.write(run_of(4, 100)));
  EXPECT_TRUE(ring.write(run_of(3, 7)));
  const auto all = ring.peek();
  ASSERT_EQ(all.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(all[i], std::byte(i));
}

// Writer and reader use a ring much smaller than the data that passes through it.
TEST(ByteRing, PassesEveryByteInOrderAcrossThreads) {
  constexpr std::size_t kTotal = 300'000;
  ByteRing ring(257);  // prime: wraps at every offset
  std::thread writer([&ring] {
    for (std::size_t sent = 0; sent < kTotal;) {
      const std::size_t size = std::min<std::size_t>(1 + sent % 61, kTotal - sent);
      if (ring.write(run_of(size, static_cast<std::uint8_t>(sent)))) {
        sent += size;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (std::size_t received = 0; received < kTotal;) {
    const auto piece = ring.peek();
    for (const std::byte byte : piece) ASSERT_EQ(byte, std::byte(received++));
    ring.consume(piece.size());
    if (piece.empty()) std::this_thread::yield();
  }
  writer.join();
}

}  // namespace
}  // namespace server
