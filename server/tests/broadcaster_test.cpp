// The sender thread: every datagram is sent in order or counted, and none is left pending.
#include "broadcaster.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <vector>

#include "os/file_descriptor.h"
#include "os/socket_address.h"

namespace server {
namespace {

os::FileDescriptor bound_socket() {
  os::FileDescriptor fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int buffer = 4 << 20;
  ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  const auto any = os::loopback(0);
  EXPECT_EQ(::bind(fd.get(), any.generic(), any.size()), 0);
  return fd;
}

wire::SealKey key_of(std::uint32_t client) {
  return {static_cast<std::byte>(client), std::byte{7}};
}

// The numbers in the datagrams that have arrived, sealed for that client. On loopback a datagram
// arrives as it is sent.
std::vector<int> arrived(const os::FileDescriptor& fd, std::uint32_t client) {
  wire::DatagramOpener opener(key_of(client), client);
  std::vector<int> out;
  std::array<std::byte, 100> bytes;
  int number = 0;
  std::size_t size = 0;
  for (ssize_t got; (got = ::recv(fd.get(), bytes.data(), bytes.size(), 0)) > 0;) {
    const auto sealed = std::span<const std::byte>(bytes).first(static_cast<std::size_t>(got));
    EXPECT_EQ(opener.open(sealed, std::as_writable_bytes(std::span(&number, 1)), size),
              wire::SealVerdict::good);
    out.push_back(number);
  }
  return out;
}

struct Sending : testing::Test {
  void give(int number) { out.send(std::as_bytes(std::span(&number, 1)), ++counter, 0); }
  void add(std::uint32_t client, const os::SocketAddress& to) {
    out.add({.client = client, .to = to, .from = {}, .key = key_of(client)});
  }
  os::FileDescriptor from = bound_socket(), one = bound_socket(), two = bound_socket();
  std::uint64_t counter = 0;
  Broadcaster out{from.get(), 2, 0};
};

TEST_F(Sending, ReachesEachListenerInOrderAndNoneThatLeft) {
  add(1, os::local_address(one.get()));
  give(1);
  add(2, os::local_address(two.get()));
  give(2);
  out.remove(1);
  give(3);
  out.wait_sent();
  EXPECT_EQ(arrived(one, 1), (std::vector<int>{1, 2}));
  EXPECT_EQ(arrived(two, 2), (std::vector<int>{2, 3}));
  EXPECT_EQ(out.sent(), 4u);
  EXPECT_EQ(out.bytes(), 4 * (sizeof(int) + wire::kSealBytes));
}

TEST_F(Sending, SendsAllThatWasGivenBeforeItEnds) {
  add(1, os::local_address(one.get()));
  for (int i = 0; i < 16; ++i) give(i);  // as many as fit into the queue
  out.close();
  EXPECT_EQ(arrived(one, 1).size(), 16u);
  EXPECT_EQ(out.stats().cost.count(), 16u);
  EXPECT_EQ(out.stats().to_wire.count(), 16u);
}

// Queued faster than the thread can send: each is sent or counted, and the order is kept.
TEST_F(Sending, WhatFindsNoPlaceIsCountedForEachListener) {
  add(1, os::local_address(one.get()));
  add(2, os::local_address(two.get()));
  constexpr int kGiven = 2'000;
  for (int i = 0; i < kGiven; ++i) give(i);
  out.close();
  EXPECT_EQ(out.sent() + out.errors(), 2u * kGiven);
  const std::vector<int> received = arrived(one, 1);
  EXPECT_EQ(received.size(), out.sent() / 2);
  EXPECT_TRUE(std::is_sorted(received.begin(), received.end()));
  EXPECT_EQ(received, arrived(two, 2));
}

TEST_F(Sending, AListenerThatCannotBeReachedCostsTheOthersNothing) {
  add(1, *os::parse_address("255.255.255.255", 9));  // broadcasting is not permitted
  add(2, os::local_address(two.get()));
  give(7);
  out.wait_sent();
  EXPECT_EQ(out.errors(), 1u);
  EXPECT_EQ(arrived(two, 2), (std::vector<int>{7}));
}

// Expected early, late, without a datagram, or not at all: expect() only decides when the thread
// wakes.
TEST_F(Sending, WhatWasExpectedArrivesOnceAndWhatWasNotToo) {
  add(1, os::local_address(one.get()));
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
  EXPECT_EQ(arrived(one, 1), given);
}

TEST_F(Sending, WithoutAListenerNothingIsGivenToTheThread) {
  give(1);
  out.close();
  EXPECT_EQ(out.stats().cost.count(), 0u);
  EXPECT_EQ(out.sent() + out.errors(), 0u);
}

}  // namespace
}  // namespace server
