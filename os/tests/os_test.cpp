#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <thread>

#include "os/clock.h"
#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "os/thread_signal.h"

namespace os {
namespace {

bool is_open(int fd) {
  return ::fcntl(fd, F_GETFD) >= 0;
}
FileDescriptor null_device() {
  return FileDescriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

TEST(FileDescriptor, ClosesWhatItOwnsOnceAndWhatItIsGivenInItsPlace) {
  FileDescriptor first = null_device();
  const int one = first.get();
  FileDescriptor second = null_device();
  const int two = second.get();
  first = std::move(second);
  EXPECT_FALSE(is_open(one));
  EXPECT_EQ(first.get(), two);
  EXPECT_FALSE(second);  // NOLINT(bugprone-use-after-move): what is tested
  {
    const FileDescriptor third(std::move(first));
    EXPECT_TRUE(is_open(two));
  }
  EXPECT_FALSE(is_open(two));
}

TEST(FileDescriptor, ReleasedItIsTheCallers) {
  int fd = -1;
  {
    FileDescriptor owner = null_device();
    fd = owner.release();
  }
  ASSERT_TRUE(is_open(fd));
  FileDescriptor(fd).reset();
  EXPECT_FALSE(is_open(fd));
}

TEST(SocketAddress, TakesDottedAddressesOnly) {
  for (const char* wrong :
       {"", "localhost", "1.2.3", "1.2.3.256", "::1", "127.0.0.1:80", " 1.2.3.4"}) {
    EXPECT_FALSE(parse_ipv4(wrong, 1)) << wrong;
  }
  const auto address = parse_ipv4("239.7.5.31", 7532);
  ASSERT_TRUE(address);
  EXPECT_EQ(to_text(*address), "239.7.5.31:7532");
  EXPECT_EQ(port_of(*address), 7532);
}

TEST(SocketAddress, AllOf127IsThisMachine) {
  for (const char* here : {"127.0.0.1", "127.0.0.9", "127.255.255.255"}) {
    EXPECT_TRUE(is_loopback(*parse_ipv4(here, 0))) << here;
  }
  for (const char* elsewhere : {"0.0.0.0", "126.255.255.255", "128.0.0.1", "1.0.0.127"}) {
    EXPECT_FALSE(is_loopback(*parse_ipv4(elsewhere, 0))) << elsewhere;
  }
}

TEST(SocketAddress, OfASocketIsWhereItIsBound) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const sockaddr_in any = loopback(0);
  ASSERT_EQ(::bind(socket.get(), generic(any), sizeof any), 0);
  EXPECT_NE(port_of(local_address(socket.get())), 0);
  EXPECT_TRUE(is_loopback(local_address(socket.get())));
  EXPECT_EQ(port_of(local_address(-1)), 0);
}

TEST(Clock, ASleepEndsNoEarlierThanItsDeadline) {
  const std::int64_t deadline = monotonic_ns() + 2'000'000;
  sleep_until_ns(deadline);
  EXPECT_GE(monotonic_ns(), deadline);
}

TEST(ThreadSignal, APostIsNotLostWhicheverComesFirst) {
  ThreadSignal to, from;
  std::thread echo([&] {
    for (int i = 0; i < 1000; ++i) {
      to.wait();
      from.post();
    }
  });
  for (int i = 0; i < 1000; ++i) {
    to.post();
    from.wait();
  }
  echo.join();
}

}  // namespace
}  // namespace os
