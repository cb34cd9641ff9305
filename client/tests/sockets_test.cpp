#include "core/sockets.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <vector>

#include "os/socket_address.h"

namespace client {
namespace {

// On loopback a datagram has arrived when sendto() returns.
void send(const UdpSocket& from, std::uint16_t port, std::span<const std::byte> bytes) {
  const auto to = os::loopback(port);
  ASSERT_EQ(::sendto(from.fd.get(), bytes.data(), bytes.size(), 0, to.generic(), to.size()),
            static_cast<ssize_t>(bytes.size()));
}

TEST(Datagrams, AFloodIsTakenInPortionsAndInOrder) {
  const auto from = open_udp(os::loopback(0)), to = open_udp(os::loopback(0));
  ASSERT_TRUE(from && to);
  for (int i = 0; i < 10; ++i) send(*from, to->port, std::vector(3, static_cast<std::byte>(i)));
  std::vector<int> taken;
  const auto take = [&](std::span<const std::byte> bytes) {
    EXPECT_EQ(bytes.size(), 3u);
    taken.push_back(static_cast<int>(bytes[0]));
  };
  EXPECT_EQ(take_datagrams(to->fd.get(), 4, take), 4u);
  EXPECT_EQ(taken, (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(take_datagrams(to->fd.get(), 4, take), 4u);
  EXPECT_EQ(take_datagrams(to->fd.get(), 4, take), 2u);
  EXPECT_EQ(take_datagrams(to->fd.get(), 4, take), 0u);
  EXPECT_EQ(taken.back(), 9);
}

TEST(Datagrams, EmptyAndOverlongOnesAreTakenToo) {
  const auto from = open_udp(os::loopback(0)), to = open_udp(os::loopback(0));
  ASSERT_TRUE(from && to);
  send(*from, to->port, {});
  send(*from, to->port, std::vector<std::byte>(kLongestDatagram + 1));
  std::vector<std::size_t> sizes;
  take_datagrams(to->fd.get(), 9,
                 [&](std::span<const std::byte> bytes) { sizes.push_back(bytes.size()); });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{0, kLongestDatagram}));
}

TEST(Resolve, AnAddressIsTakenAsItIsAndANameIsLookedUp) {
  EXPECT_EQ(os::to_text(resolve("192.0.2.7", 99).value()), "192.0.2.7:99");
  EXPECT_EQ(os::to_text(resolve("localhost", 7531).value()), "127.0.0.1:7531");
  const auto unknown = resolve("no such host", 1);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().find("--server HOST:PORT"), std::string::npos);
}

}  // namespace
}  // namespace client
