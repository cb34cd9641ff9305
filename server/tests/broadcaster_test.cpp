// The thread that sends: everything given is sent in order or counted, and nothing is left behind.
#include "broadcaster.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <vector>

#include "os/file_descriptor.h"
#include "os/socket_address.h"

namespace server {
namespace {

os::FileDescriptor bound_socket() {
  os::FileDescriptor fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int buffer = 4 << 20;
  ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  const sockaddr_in any = os::loopback(0);
  EXPECT_EQ(::bind(fd.get(), os::generic(any), sizeof any), 0);
  return fd;
}

// The number in each datagram that has arrived. On loopback one is there once it was sent.
std::vector<int> arrived(const os::FileDescriptor& fd) {
  std::vector<int> out;
  for (int number = 0; ::recv(fd.get(), &number, sizeof number, 0) == sizeof number;) {
    out.push_back(number);
  }
  return out;
}

struct Sending : testing::Test {
  void give(int number) { out.send(std::as_bytes(std::span(&number, 1)), 0); }
  os::FileDescriptor from = bound_socket(), one = bound_socket(), two = bound_socket();
  Broadcaster out{from.get(), 2, 0};
};

TEST_F(Sending, ReachesEachListenerInOrderAndNoneThatLeft) {
  out.add(1, os::local_address(one.get()));
  give(1);
  out.add(2, os::local_address(two.get()));
  give(2);
  out.remove(1);
  give(3);
  out.wait_sent();
  EXPECT_EQ(arrived(one), (std::vector<int>{1, 2}));
  EXPECT_EQ(arrived(two), (std::vector<int>{2, 3}));
  EXPECT_EQ(out.sent(), 4u);
  EXPECT_EQ(out.bytes(), 4 * sizeof(int));
}

TEST_F(Sending, SendsAllThatWasGivenBeforeItEnds) {
  out.add(1, os::local_address(one.get()));
  for (int i = 0; i < 16; ++i) give(i);  // as many as can wait
  out.close();
  EXPECT_EQ(arrived(one).size(), 16u);
  EXPECT_EQ(out.stats().cost.count(), 16u);
  EXPECT_EQ(out.stats().to_wire.count(), 16u);
}

// Given faster than the thread may send: each is sent or counted, and the order stays.
TEST_F(Sending, WhatFindsNoPlaceIsCountedForEachListener) {
  out.add(1, os::local_address(one.get()));
  out.add(2, os::local_address(two.get()));
  constexpr int kGiven = 2'000;
  for (int i = 0; i < kGiven; ++i) give(i);
  out.close();
  EXPECT_EQ(out.sent() + out.errors(), 2u * kGiven);
  const std::vector<int> heard = arrived(one);
  EXPECT_EQ(heard.size(), out.sent() / 2);
  EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
  EXPECT_EQ(heard, arrived(two));
}

TEST_F(Sending, AListenerThatCannotBeReachedCostsTheOthersNothing) {
  out.add(1, *os::parse_ipv4("255.255.255.255", 9));  // broadcasting is not permitted
  out.add(2, os::local_address(two.get()));
  give(7);
  out.wait_sent();
  EXPECT_EQ(out.errors(), 1u);
  EXPECT_EQ(arrived(two), (std::vector<int>{7}));
}

// Expected early, late, in vain or not at all: it only says when the thread wakes.
TEST_F(Sending, WhatWasExpectedArrivesOnceAndWhatWasNotToo) {
  out.add(1, os::local_address(one.get()));
  std::vector<int> given;
  for (int i = 0; i < 300; ++i) {
    if (i % 3 != 0) out.expect();
    if (i % 5 == 0) out.expect();
    if (i % 7 == 0) continue;
    give(i);
    given.push_back(i);
    if (i % 2 == 0) out.wait_sent();
  }
  out.expect();
  out.close();
  EXPECT_EQ(arrived(one), given);
}

TEST_F(Sending, WithoutAListenerNothingIsGivenToTheThread) {
  give(1);
  out.close();
  EXPECT_EQ(out.stats().cost.count(), 0u);
  EXPECT_EQ(out.sent() + out.errors(), 0u);
}

}  // namespace
}  // namespace server
