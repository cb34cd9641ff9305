#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "os/capabilities.h"
#include "os/clock.h"
#include "os/cores.h"
#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "os/thread_signal.h"
#include "os/time_of_day.h"
#include "os/user_folder.h"

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

TEST(SocketAddress, TakesAddressesOfBothFamiliesAndNoNames) {
  for (const char* wrong : {"", "localhost", "1.2.3", "1.2.3.256", "127.0.0.1:80", " 1.2.3.4",
                            "::g", "::1%no-such-if", "[::1]"}) {
    EXPECT_FALSE(parse_address(wrong, 1)) << wrong;
  }
  const auto v4 = parse_address("239.7.5.31", 7532), v6 = parse_address("ff15::7531", 7532);
  ASSERT_TRUE(v4 && v6);
  EXPECT_EQ(to_text(*v4), "239.7.5.31:7532");
  EXPECT_EQ(to_text(*v6), "[ff15::7531]:7532");
  for (const auto& address : {*v4, *v6}) {
    EXPECT_EQ(address.port(), 7532);
    EXPECT_TRUE(address.is_multicast());
    EXPECT_FALSE(address.is_loopback());
  }
  EXPECT_TRUE(parse_address("0.0.0.0", 1)->is_any());
  EXPECT_TRUE(parse_address("::", 1)->is_any());
  EXPECT_TRUE(SocketAddress().empty());
}

TEST(SocketAddress, KnowsThisMachineInEveryForm) {
  for (const char* here : {"127.0.0.1", "127.0.0.9", "127.255.255.255", "::1", "::ffff:127.0.0.1"})
    EXPECT_TRUE(parse_address(here, 0)->is_loopback()) << here;
  for (const char* elsewhere :
       {"0.0.0.0", "126.255.255.255", "128.0.0.1", "1.0.0.127", "::", "::2", "::ffff:1.0.0.127"}) {
    EXPECT_FALSE(parse_address(elsewhere, 0)->is_loopback()) << elsewhere;
  }
  EXPECT_FALSE(SocketAddress().is_loopback());
}

TEST(SocketAddress, AMappedAddressIsTheHostThatItIs) {
  const SocketAddress plain = *parse_address("192.0.2.7", 1);
  const SocketAddress mapped = *parse_address("::ffff:192.0.2.7", 2);
  EXPECT_TRUE(plain.same_host(mapped));
  EXPECT_EQ(plain.network(), mapped.network());
  EXPECT_EQ(to_text(mapped), "192.0.2.7:2");
  EXPECT_FALSE(plain.same_host(*parse_address("192.0.2.8", 1)));
  EXPECT_FALSE(plain.same_host(*parse_address("2001:db8::7", 1)));
  const SocketAddress v6 = *parse_address("2001:db8::7", 1);
  EXPECT_TRUE(v6.same_host(*parse_address("2001:db8::7", 9)));
  EXPECT_FALSE(v6.same_host(*parse_address("2001:db8::8", 1)));
  EXPECT_EQ(v6.network(), parse_address("2001:db8::8", 1)->network()) << "of one network";
  EXPECT_NE(v6.network(), parse_address("2001:db8:0:1::8", 1)->network());
}

TEST(SocketAddress, MachinesOfOneNetworkAreToldApartAndLinkLocalOnesAreNoNetwork) {
  const SocketAddress one = *parse_address("2001:db8::7", 1),
                      other = *parse_address("2001:db8::8", 1);
  EXPECT_NE(one.machine(), other.machine());
  EXPECT_EQ(one.machine(), parse_address("2001:db8::7", 9)->machine()) << "whatever the port";
  EXPECT_EQ(parse_address("192.0.2.7", 1)->machine(),
            parse_address("::ffff:192.0.2.7", 1)->machine());
  EXPECT_NE(parse_address("192.0.2.7", 1)->machine(), parse_address("192.0.2.8", 1)->machine());
  const SocketAddress lan = *parse_address("fe80::1", 1), neighbour = *parse_address("fe80::2", 1);
  EXPECT_NE(lan.network(), neighbour.network()) << "every LAN has the prefix fe80::/64";
  EXPECT_EQ(lan.network(), lan.machine());
  const SocketAddress end = *parse_address("febf::1", 1), beyond = *parse_address("fec0::1", 1);
  EXPECT_NE(end.network(), parse_address("febf::2", 1)->network());
  EXPECT_EQ(beyond.network(), parse_address("fec0::2", 1)->network());
  sockaddr_in6 on_second = lan.ipv6();
  on_second.sin6_scope_id = 2;
  EXPECT_NE(SocketAddress(on_second).machine(), lan.machine()) << "of another interface";
}

TEST(SocketAddress, AnOwnerHasOneAddressOrANetworkAndANeighbourIsNotAllOfTheLan) {
  const auto owner = [](const char* address, const char* local) {
    return parse_address(address, 4242)->owner(*parse_address(local, 17));
  };
  const char *far = "2001:db8:1:2::1", *farther = "2001:db8:1:2:ffff:ffff:ffff:ffff";
  EXPECT_EQ(owner(far, "2001:db8::1"), owner(farther, "2001:db8::1"));
  EXPECT_NE(owner(far, "2001:db8::1"), owner("2001:db8:1:3::1", "2001:db8::1"));
  EXPECT_NE(owner(far, "2001:db8:1:2::7"), owner(farther, "2001:db8:1:2::7"));
  EXPECT_NE(owner("192.0.2.1", "192.0.2.7"), owner("192.0.2.2", "192.0.2.7"));
  EXPECT_EQ(owner("192.0.2.1", "192.0.2.7"), owner("::ffff:192.0.2.1", "::ffff:192.0.2.7"));
  EXPECT_NE(owner("fe80::1", "fe80::7"), owner("fe80::2", "fe80::7"));
}

TEST(SocketAddress, OfASocketIsWhereItIsBound) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const SocketAddress any = loopback(0);
  ASSERT_EQ(::bind(socket.get(), any.generic(), any.size()), 0);
  EXPECT_NE(local_address(socket.get()).port(), 0);
  EXPECT_TRUE(local_address(socket.get()).is_loopback());
  EXPECT_TRUE(local_address(-1).empty());
}

TEST(HostPort, IsTakenInEveryUsualForm) {
  struct Case {
    const char *text, *host;
    int port;  // 0: none
  };
  for (const Case& c :
       {Case{"table", "table", 0}, Case{"table:99", "table", 99}, Case{":99", "", 99},
        Case{"[::1]:99", "::1", 99}, Case{"::1", "::1", 0}, Case{"[fd00::2]", "fd00::2", 0},
        Case{"10.0.0.1:65535", "10.0.0.1", 65535}}) {
    const auto parsed = parse_host_port(c.text);
    ASSERT_TRUE(parsed) << c.text;
    EXPECT_EQ(parsed->host, c.host) << c.text;
    EXPECT_EQ(parsed->port.value_or(0), c.port) << c.text;
  }
  for (const char* wrong :
       {"", "table:", "table:0", "table:65536", "table:x", "[::1", "[::1]99", "[table]:9", "a:b:c"})
    EXPECT_FALSE(parse_host_port(wrong)) << wrong;
}

TEST(Clock, ASleepEndsNoEarlierThanItsDeadline) {
  const std::int64_t deadline = monotonic_ns() + 2'000'000;
  sleep_until_ns(deadline);
  EXPECT_GE(monotonic_ns(), deadline);
}

TEST(Cores, AQuotaIsReadAsCoresOfTime) {
  EXPECT_DOUBLE_EQ(quota_of("150000 100000\n"), 1.5);
  EXPECT_DOUBLE_EQ(quota_of("max 100000\n"), 0.0);
  EXPECT_DOUBLE_EQ(quota_of(""), 0.0);
  EXPECT_GE(usable_cores(), 1);
}

TEST(Capabilities, AreGoneForTheThreadThatGaveThemUpAndNoOther) {
  const auto effective = [] {
    std::ifstream status("/proc/thread-self/status");
    for (std::string word; status >> word;) {
      if (word == "CapEff:") return status >> word, word;
    }
    return std::string();
  };
  const std::string before = effective();
  bool dropped = false;
  std::string after;
  std::thread([&] {
    dropped = drop_capabilities(false);
    after = effective();
  }).join();
  EXPECT_TRUE(dropped);
  EXPECT_EQ(after, "0000000000000000");
  EXPECT_EQ(effective(), before);
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

TEST(TimeOfDay, ATextOfItIsReadBackAndNoOtherIs) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(utc_seconds("2000-02-29T12:00:00Z"), 951'825'600);
  for (const std::time_t time : {std::time_t{1}, std::time_t{1'795'000'000}, std::time_t{-86'400}})
    EXPECT_EQ(utc_seconds(utc_text(time)), time);
  for (const char* text : {"", "2026-11-22", "2026-11-22T23:59:59", "2026-11-22T23:59:59+",
                           "2026-02-30T00:00:00Z", "2026-13-01T00:00:00Z", "2026-11-22T24:00:00Z",
                           "2026-11-22T23:59:60Z", "2026-11-22 23:59:59Z", "-026-11-22T23:59:59Z"})
    EXPECT_EQ(utc_seconds(text), std::nullopt) << text;
  EXPECT_TRUE(utc_seconds(utc_now()));
}

// Sets a variable of the environment, and restores it at the end.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(UserFolder, IsTheNamedOneElseThatOfTheHome) {
  const Variable home("HOME", "/home/ann");
  {
    const Variable data("XDG_DATA_HOME", "/data"), config("XDG_CONFIG_HOME", "/config");
    EXPECT_EQ(data_folder(), "/data");
    EXPECT_EQ(config_folder(), "/config");
  }
  for (const char* ignored : {"", "relative", static_cast<const char*>(nullptr)}) {
    const Variable data("XDG_DATA_HOME", ignored), config("XDG_CONFIG_HOME", ignored);
    EXPECT_EQ(data_folder(), "/home/ann/.local/share");
    EXPECT_EQ(config_folder(), "/home/ann/.config");
    const Variable nowhere("HOME", nullptr);
    EXPECT_EQ(data_folder(), "");
    EXPECT_EQ(config_folder(), "");
  }
}

}  // namespace
}  // namespace os
