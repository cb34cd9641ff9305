// Memory use of one connection whose peer reads slowly.
#include "control_connection.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <vector>

namespace server {
namespace {

constexpr std::size_t kCap = 64 * 1024;

class ControlConnectionTest : public testing::Test {
 protected:
  void SetUp() override {
    std::array<int, 2> ends{-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    const int small = 4096;  // so that the peer falls behind at once
    ::setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
    connection.emplace(os::FileDescriptor(ends[0]), os::SocketAddress{}, 0);
    peer = os::FileDescriptor(ends[1]);
  }
  // Reads up to `most` bytes of those sent.
  void read(std::size_t max) {
    std::vector<std::byte> bytes(max);
    const ssize_t size = ::recv(peer.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size > 0) received.push({bytes.data(), static_cast<std::size_t>(size)});
    wire::ControlMessage message;
    while (received.next(message) == wire::ControlReader::Status::message) {
      ASSERT_TRUE(std::holds_alternative<wire::Pong>(message));
      ASSERT_EQ(std::get<wire::Pong>(message).id, ++received_count);
    }
  }
  std::optional<ControlConnection> connection;
  os::FileDescriptor peer;
  wire::ControlReader received;
  std::uint64_t received_count = 0;
};

// A peer that sends pings and reads at one rate is never dropped, and sent bytes are not retained.
TEST_F(ControlConnectionTest, KeepsNoMoreForASteadyReaderThatNeverCatchesUp) {
  std::uint64_t said = 0;
  const auto say = [&] { return connection->send(wire::Pong{++said}, kCap); };
  while (connection->buffered_bytes() < kCap / 2) {
    ASSERT_TRUE(say());
    ASSERT_TRUE(connection->flush());
  }
  std::vector<std::byte> one;
  wire::encode_control(wire::Pong{1}, one);
  std::size_t max = 0;
  for (int i = 0; i < 20'000; ++i) {
    for (int k = 0; k < 8; ++k) ASSERT_TRUE(say());
    read(8 * one.size());
    ASSERT_TRUE(connection->flush());
    ASSERT_TRUE(connection->wants_to_send());
    max = std::max(max, connection->buffered_bytes());
  }
  EXPECT_LE(max, kCap + 16 * 1024);
  EXPECT_GT(20'000 * 8 * one.size(), 10 * kCap);  // far more than that was sent
  while (connection->wants_to_send() || received_count < said) {
    ASSERT_TRUE(connection->flush());
    read(kCap);
  }
  EXPECT_EQ(received_count, said);  // in order, each once
}

TEST_F(ControlConnectionTest, CountsOnlyUnsentBytesAgainstTheCap) {
  bool within = true;
  std::uint64_t said = 0;
  while (within && said < 100'000) {
    within = connection->send(wire::Pong{++said}, kCap);
    ASSERT_TRUE(connection->flush());
  }
  EXPECT_FALSE(within);
  const auto sent_first = said;
  for (int i = 0; i < 1'000 && connection->wants_to_send(); ++i) {
    read(kCap);
    ASSERT_TRUE(connection->flush());
  }
  EXPECT_TRUE(connection->send(wire::Pong{++said}, kCap));
  EXPECT_GT(said, sent_first);
}

}  // namespace
}  // namespace server
