#include "socket.h"

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <thread>
#include <vector>

namespace server {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(PortSentence, SaysWhatToChangeForEachThingThatCanBeWrong) {
  NetworkOptions options;
  options.port = 80;
  const std::string forbidden = sentence(options, {EACCES});
  EXPECT_TRUE(contains(forbidden, "port 80 on 127.0.0.1 needs permissions")) << forbidden;
  EXPECT_TRUE(contains(forbidden, "below 1024: choose another port with --port")) << forbidden;
  EXPECT_FALSE(contains(forbidden, "--listen")) << forbidden;
  const std::string taken = sentence(options, {EADDRINUSE});
  EXPECT_TRUE(contains(taken, "already in use")) << taken;
  const std::string elsewhere = sentence(options, {EADDRNOTAVAIL});
  EXPECT_TRUE(contains(elsewhere, "an address of this machine with --listen")) << elsewhere;
  EXPECT_TRUE(contains(sentence(options, {EMFILE}), "Too many open files"));
}

TEST(OpenPorts, SaysThatAnAddressIsNone) {
  NetworkOptions options;
  options.listen = "everywhere";
  const auto ports = open_ports(options);
  ASSERT_FALSE(ports);
  EXPECT_TRUE(contains(sentence(options, ports.error()), "\"everywhere\" is not an address"));
}

// With the TCP port first, both could bind it, and both could fail to listen.
TEST(OpenPorts, OfServersThatStartAtOneMomentExactlyOneHasThePort) {
  constexpr int kServers = 4, kRounds = 200;
  for (int round = 0; round < kRounds; ++round) {
    NetworkOptions options;
    {
      const auto free = open_ports(options);
      ASSERT_TRUE(free);
      options.port = free->port;
    }
    std::barrier together(kServers), all_tried(kServers);
    std::atomic<int> opened{0}, refused{0};
    std::vector<std::thread> servers;
    for (int i = 0; i < kServers; ++i) {
      servers.emplace_back([&] {
        together.arrive_and_wait();
        const auto ports = open_ports(options);
        opened += ports ? 1 : 0;
        refused += !ports && ports.error().occupied() ? 1 : 0;
        all_tried.arrive_and_wait();  // a server keeps its port until all have tried
      });
    }
    for (auto& server : servers) server.join();
    ASSERT_EQ(opened, 1) << round;
    ASSERT_EQ(refused, kServers - 1) << round;
  }
}

}  // namespace
}  // namespace server
