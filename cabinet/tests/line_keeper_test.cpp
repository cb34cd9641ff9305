// A device that opens slowly: the poller does not wait for it.
#include "line_keeper.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <future>
#include <optional>
#include <thread>

#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

bool is_open(int fd) {
  return fcntl(fd, F_GETFD) >= 0;
}

template <class Condition>
bool comes_true(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

int take_when_ready(LineKeeper& keeper) {
  int fd = -1;
  EXPECT_TRUE(comes_true([&] { return (fd = keeper.take()) >= 0; }));
  return fd;
}

TEST(LineKeeper, DoesNotWaitForADeviceThatOpensSlowly) {
  std::promise<void> answered;
  std::atomic<int> opened{0};
  LineKeeper keeper([&, answer = answered.get_future().share()] {
    ++opened;
    answer.wait();  // blocks as long as the test requires
    return ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  });
  for (int i = 0; i < 1'000; ++i) EXPECT_EQ(keeper.take(), -1);
  answered.set_value();
  const Descriptor device(take_when_ready(keeper));
  EXPECT_TRUE(is_open(device.fd));
  EXPECT_EQ(opened, 1);  // requested a thousand times, opened once
}

TEST(LineKeeper, AsksAgainForADeviceThatIsNotThere) {
  std::atomic<int> tries{0};
  LineKeeper keeper([&] { return ++tries < 4 ? -1 : ::open("/dev/null", O_RDONLY | O_CLOEXEC); });
  const Descriptor device(take_when_ready(keeper));
  EXPECT_EQ(tries, 4);
}

TEST(LineKeeper, SaysWhyADeviceDoesNotOpen) {
  std::atomic<int> error{EACCES};
  LineKeeper keeper([&] {
    errno = error;
    return -1;
  });
  const auto says = [&](int wanted) {
    return comes_true([&] { return keeper.take() < 0 && errno == wanted; });
  };
  EXPECT_TRUE(says(EACCES));
  error = EBUSY;
  EXPECT_TRUE(says(EBUSY));
}

// Otherwise a port with exclusive access could not be opened.
TEST(LineKeeper, ClosesADeviceBeforeItOpensItAgain) {
  std::atomic<int> last{-1};
  std::atomic<int> still_open{0};
  LineKeeper keeper([&] {
    if (last >= 0 && is_open(last)) ++still_open;
    last = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    return last.load();
  });
  for (int i = 0; i < 2'000; ++i) keeper.close(take_when_ready(keeper));
  EXPECT_EQ(still_open, 0);
  EXPECT_TRUE(comes_true([&] { return !is_open(last); }));
}

TEST(LineKeeper, ClosesWhatNobodyTookWhenItEnds) {
  std::atomic<int> last{-1};
  {
    LineKeeper keeper([&] { return last = ::open("/dev/null", O_RDONLY | O_CLOEXEC); });
    EXPECT_EQ(keeper.take(), -1);
    ASSERT_TRUE(comes_true([&] { return last >= 0; }));
  }
  EXPECT_FALSE(is_open(last));
}

TEST(LineKeeper, WritesPacketsInTheirOrderThoughTheDeviceTakesItsTime) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const Descriptor reader(ends[0]);
  ASSERT_GE(::fcntl(ends[1], F_SETPIPE_SZ, 4096), 4096);
  LineKeeper keeper([fd = ends[1]] { return fd; });
  const int line = take_when_ready(keeper);
  std::array<std::byte, kMaxPacket> packet{};
  const auto send = [&](int number) {
    packet[0] = static_cast<std::byte>(number);
    return keeper.send(line, packet);
  };
  // Nobody reads: the thread blocks in write(2) once the pipe is full, and the sender never does.
  int sent = 0;
  ASSERT_TRUE(comes_true([&] {
    if (send(sent)) ++sent;
    return sent == 4096 / 65 + 16;
  }));
  EXPECT_FALSE(send(255)) << "sixteen wait already";
  for (int i = 0; i < sent; ++i) {
    std::array<std::byte, kMaxPacket> got{};
    std::size_t size = 0;
    while (size < got.size()) {
      const ssize_t piece = ::read(reader.fd, got.data() + size, got.size() - size);
      ASSERT_GT(piece, 0);
      size += static_cast<std::size_t>(piece);
    }
    ASSERT_EQ(std::to_integer<int>(got[0]), i);
  }
  std::array<std::byte, 66> long_one{};
  EXPECT_FALSE(keeper.send(line, long_one));
  EXPECT_FALSE(keeper.send(-1, packet));
  keeper.close(line);
  EXPECT_TRUE(comes_true([&] { return !is_open(line); }));
}

}  // namespace
