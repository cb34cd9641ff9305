#include "socket.h"

#include <gtest/gtest.h>

namespace server {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(PortSentence, SaysWhatToChangeForEachThingThatCanBeWrong) {
  NetworkOptions options;
  options.port = 80;
  const std::string forbidden = sentence(options, {EACCES});
  EXPECT_TRUE(contains(forbidden, "port 80 on 127.0.0.1 may not be used")) << forbidden;
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
  EXPECT_TRUE(contains(sentence(options, ports.error()), "\"everywhere\" is no address"));
}

}  // namespace
}  // namespace server
