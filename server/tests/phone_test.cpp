// Phones with a real port, a WebSocket of Boost.Beast and a server in lockstep; and untrusted
// connections.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "control_fixture.h"
#include "os/clock.h"
#include "os/file_descriptor.h"
#include "phone_guest.h"
#include "phone_probe.h"

namespace server {
namespace {

using wire::number;
using wire::RodPair;

void with_phones(ServerOptions& options) {
  options.phones.open = true;
  options.random = [token = std::uint64_t{1000}]() mutable { return token = token * 31 + 7; };
}

class PhoneTest : public testing::Test {
 protected:
  PhoneTest() : PhoneTest([](ServerOptions&) {}) {}
  explicit PhoneTest(const std::function<void(ServerOptions&)>& change)
      : table([&change](ServerOptions& o) {
          with_phones(o);
          change(o);
        }),
        url(table->phones()) {}

  PhoneCounters phones() { return table->counters().phones; }
  double slide(int rod) { return table->match().view().rods[static_cast<std::size_t>(rod)].slide; }
  double angle(int rod) { return table->match().view().rods[static_cast<std::size_t>(rod)].angle; }
  RodPairOf pair(int team, RodPair which) {
    return rods_of_pair(table->match().view().layout, team, which);
  }

  Lockstep table;
  std::string url;
};

TEST_F(PhoneTest, MovesTwoRodsAndNoOther) {
  PhoneProbe phone(url);
  const auto state = phone.join("J\xC3\xBCrgen");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->name, "J\xC3\xBCrgen");
  EXPECT_EQ(state->free, 0b1111);
  const auto mine = phone.claim(1, RodPair::attack);
  ASSERT_TRUE(mine);
  EXPECT_EQ(mine->pair, number(RodPair::attack));
  EXPECT_EQ(mine->team, 1);
  const RodPairOf rods = pair(1, RodPair::attack);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& spec = foosball::table_spec(table->match().view().layout)
                           .rods[static_cast<std::size_t>(rods.by_x[i])];
    EXPECT_EQ(mine->rods[i].line, static_cast<int>(spec.line));
    EXPECT_EQ(mine->rods[i].men, spec.men);
    EXPECT_NEAR(mine->rods[i].slide_limit, spec.slide_limit, 1e-4);
  }
  wire::PhoneInput input;
  input.rods[0] = {true, 0.04f, 0.7, 0.0f, 0.0f};
  input.rods[1] = {true, -0.03f, -0.5, 0.0f, 0.0f};
  ASSERT_TRUE(table.tick_until([&] {
    ++input.sequence;
    EXPECT_TRUE(phone.send(input));
    return std::abs(slide(rods.by_x[0]) - 0.04) < 2e-3 &&
           std::abs(slide(rods.by_x[1]) + 0.03) < 2e-3 &&
           std::abs(angle(rods.by_x[0]) - 0.7) < 0.05 && std::abs(angle(rods.by_x[1]) + 0.5) < 0.05;
  }));
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const bool mine_too = (rods.rods >> rod & 1) != 0;
    EXPECT_TRUE(mine_too || slide(rod) == 0.0) << rod;
  }
  EXPECT_GT(phones().inputs, 0u);
}

TEST_F(PhoneTest, AnInputIsInTheMatchAtTheTickAfterItCame) {
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(0, RodPair::attack));
  table.tick();
  const int rod = pair(0, RodPair::attack).by_x[0];
  wire::PhoneInput input{.sequence = 1};
  input.rods[0] = {true, 0.05f, 0.0, 0.0f, 0.0f};
  ASSERT_TRUE(phone.send(input));
  ASSERT_TRUE(table.wait_until([&] { return phones().inputs == 1; }));
  const double before = slide(rod);
  table.tick();
  EXPECT_GT(slide(rod), before);
}

TEST_F(PhoneTest, IsInTheRosterAndIsPutOutByTheHost) {
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join("Ann"));
  ASSERT_TRUE(phone.claim(0, RodPair::defence));
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  ASSERT_TRUE(host.catch_up());
  ASSERT_EQ(host.roster().seats.size(), 2u);
  const wire::Seat& seat = host.roster().seats[0];
  EXPECT_EQ(seat.name, "Ann");
  EXPECT_EQ(seat.rods, pair(0, RodPair::defence).rods);
  EXPECT_EQ(seat.role, number(wire::Role::player))
      << "never the host, though it is at this machine";
  ASSERT_TRUE(host.send(wire::Kick{seat.client}));
  std::optional<wire::PhoneNotice> notice;
  do {
    notice = phone.receive_a<wire::PhoneNotice>();
    ASSERT_TRUE(notice);
  } while (notice->level != number(wire::PhoneNotice::Level::end));
  EXPECT_NE(notice->text.find("removed you"), std::string::npos) << notice->text;
  EXPECT_TRUE(phone.sees_close());
  EXPECT_EQ(table->counters().control.kicked, 1u);
}

TEST_F(PhoneTest, OfTwoPhonesTheSecondIsToldWhatIsTakenAndWhy) {
  PhoneProbe ann(url), ben(url);
  ASSERT_TRUE(ann.join("Ann"));
  ASSERT_TRUE(ann.claim(0, RodPair::defence));
  const auto state = ben.join("Ben");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->free, 0b1110);
  ben.send(wire::PhoneClaim{0, number(RodPair::defence)});
  const auto notice = ben.receive_a<wire::PhoneNotice>();
  ASSERT_TRUE(notice);
  EXPECT_NE(notice->text.find("taken"), std::string::npos) << notice->text;
  EXPECT_TRUE(ben.claim(0, RodPair::attack));
}

class KeptSeats : public PhoneTest {
 protected:
  KeptSeats() : PhoneTest([](ServerOptions& o) { o.limits.seat_kept_us = 60'000'000; }) {}
};

TEST_F(KeptSeats, APhoneThatWasLostHasItsRodsAgainWithItsTicket) {
  wire::PhoneState before;
  {
    PhoneProbe phone(url);
    ASSERT_TRUE(phone.join("Ann"));
    const auto state = phone.claim(1, RodPair::attack);
    ASSERT_TRUE(state);
    before = *state;
    phone.vanish();
  }
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  PhoneProbe other(url);
  EXPECT_EQ(other.join("Ben")->free, 0b0111) << "kept for her";
  PhoneProbe phone(url);
  const auto state = phone.join("Ann", before);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->pair, number(RodPair::attack));
  EXPECT_EQ(state->team, 1);
  const int rod = pair(1, RodPair::attack).by_x[0];
  wire::PhoneInput input;  // its counter restarts
  input.rods[0] = {true, 0.05f, 0.0, 0.0f, 0.0f};
  EXPECT_TRUE(table.tick_until([&] {
    ++input.sequence;
    return phone.send(input) && slide(rod) > 0.04;
  }));
}

TEST_F(KeptSeats, APageThatIsClosedOnPurposeGivesItsRodsUp) {
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(1, RodPair::attack));
  phone.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  EXPECT_EQ(table->counters().control.lost, 0u);
  PhoneProbe other(url);
  EXPECT_EQ(other.join()->free, 0b1111);
}

TEST_F(PhoneTest, IsToldWhyTheServerEnds) {
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join());
  table->finish(wire::make_sentence<wire::SentenceId::time_is_over>());
  const auto notice = phone.receive_a<wire::PhoneNotice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->text, wire::make_sentence<wire::SentenceId::time_is_over>().text());
  EXPECT_EQ(notice->level, number(wire::PhoneNotice::Level::end));
}

TEST_F(PhoneTest, PlayersAreToldWhereAndWatchersAreNot) {
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  const auto phones = host.receive_a<wire::Phones>();
  ASSERT_TRUE(phones);
  EXPECT_EQ(phones->url, url);
  EXPECT_LE(url.size(), wire::kMaxUrl);
}

TEST(NoPhones, NobodyIsToldOfAPortThatIsNotOpen) {
  Lockstep table;
  EXPECT_EQ(table->phones(), "");
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  ASSERT_TRUE(host.send(wire::Ping{1}));
  EXPECT_TRUE(host.receive_a<wire::Pong>());
}

// --- haptics

TEST(PhonePulses, AHitIsToldInItsTickToThePhoneThatHasTheRod) {
  Lockstep table([](ServerOptions& o) {
    with_phones(o);
    o.match.rules.goals_to_win = 99;
    o.match.rules.max_goals = 99;
  });
  PhoneProbe phone(table->phones());
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(0, RodPair::attack));
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join());
  for (const auto screen : {foosball::Screen::selection, foosball::Screen::play}) {
    for (std::uint8_t team = 0; team < foosball::kTeams; ++team)
      host.send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
    ASSERT_TRUE(table.tick_until([&] { return table->match().view().screen == screen; }));
  }
  const RodPairOf mine = rods_of_pair(table->match().view().layout, 0, RodPair::attack);
  int hits = 0, behind = 0;
  std::uint64_t before = 0;
  wire::PhoneInput input;
  ASSERT_TRUE(table.tick_until([&] {
    // Both rods swing and slide, as when a child plays.
    ++input.sequence;
    const double t = 1e-6 * static_cast<double>(table.now_us());
    for (wire::PhoneRod& rod : input.rods)
      rod = {true, static_cast<float>(0.08 * std::sin(3.0 * t)), 1.2 * std::sin(25.0 * t), 0, 0};
    EXPECT_TRUE(phone.send(input));
    // The previous tick.
    for (const foosball::Event& event : table->match().events()) {
      const bool felt = event.kind == foosball::EventKind::man_hit &&
                        (mine.rods >> event.rod & 1) != 0 && event.value >= cabinet::kSoftestFelt;
      hits += felt;
    }
    const std::uint64_t pulses = table->counters().haptic_pulses;
    behind += static_cast<int>(pulses - before) > 0 && hits == 0;
    before = pulses;
    return pulses >= 3;
  }));
  EXPECT_EQ(behind, 0);
  EXPECT_GE(hits, 3) << "each pulse is of a hit of the tick that it was told in";
  const auto pulse = phone.receive_a<wire::PhonePulse>();
  ASSERT_TRUE(pulse);
  EXPECT_LT(pulse->rod, 2);
  EXPECT_GT(pulse->strength, 0);
  EXPECT_GE(pulse->ms, cabinet::kShortestPulseMs);
  EXPECT_LE(pulse->ms, cabinet::kLongestPulseMs);
}

// --- untrusted connections

class Stranger {
 public:
  explicit Stranger(const std::string& url, const std::string& from = "127.0.0.1") {
    const auto at = os::parse_host_port(url.substr(7, url.find('/', 7) - 7));
    const auto to = os::parse_address(at->host, *at->port), mine = os::parse_address(from, 0);
    fd_ = os::FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ::bind(fd_.get(), mine->generic(), mine->size());
    connected_ = ::connect(fd_.get(), to->generic(), to->size()) == 0;
  }
  bool connected() const { return connected_; }
  bool send(std::string_view bytes) {
    return ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  // Everything received until the server closes.
  std::string drain(int patience_ms = 10'000) {
    std::string all;
    std::array<char, 4096> buffer;
    while (wait_readable(fd_.get(), patience_ms)) {
      const auto size = ::recv(fd_.get(), buffer.data(), buffer.size(), 0);
      if (size <= 0) {
        closed_ = true;
        break;
      }
      all.append(buffer.data(), static_cast<std::size_t>(size));
    }
    return all;
  }
  bool closed() const { return closed_; }
  int fd() const { return fd_.get(); }

 private:
  os::FileDescriptor fd_;
  bool connected_ = false, closed_ = false;
};

std::string get(const std::string& target, std::size_t padding = 0) {
  return "GET " + target + " HTTP/1.1\r\nHost: x\r\nX-Pad: " + std::string(padding, 'a') +
         "\r\n\r\n";
}

TEST_F(PhoneTest, ServesThePageToWhoKnowsTheToken) {
  const std::string path = url.substr(url.find('/', 7));
  for (const std::string& target : {path, path + "/"}) {
    Stranger visitor(url);
    ASSERT_TRUE(visitor.send(get(target)));
    const std::string answer = visitor.drain();
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n"));
    EXPECT_NE(answer.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
    EXPECT_TRUE(answer.ends_with("</html>\n"));
    EXPECT_EQ(answer.find("src=\"http"), std::string::npos) << "it loads nothing of others";
  }
  EXPECT_EQ(phones().pages, 2u);
}

TEST_F(PhoneTest, WithoutTheTokenThereIsASentenceNeverLongerThanTheRequest) {
  const std::string path = url.substr(url.find('/', 7));
  std::string wrong = path, longer = path + "a", shorter = path;
  wrong.back() = wrong.back() == 'a' ? 'b' : 'a';
  shorter.pop_back();
  int sentences = 0, silences = 0;
  for (const std::string& target : {std::string("/"), std::string("/ws"), wrong, wrong + "/ws",
                                    longer, shorter, path + "/x", path + "/ws/"}) {
    for (const std::size_t padding : {0, 50, 300}) {
      Stranger stranger(url);
      const std::string request = get(target, padding);
      ASSERT_TRUE(stranger.send(request));
      const std::string answer = stranger.drain();
      EXPECT_TRUE(stranger.closed());
      EXPECT_LE(answer.size(), request.size());
      EXPECT_EQ(answer.find("<html"), std::string::npos);
      EXPECT_EQ(answer.find(path.substr(1)), std::string::npos);
      answer.empty() ? ++silences : ++sentences;
      EXPECT_TRUE(answer.empty() || answer.find("Scan the code") != std::string::npos);
    }
  }
  EXPECT_GE(sentences, 8);
  EXPECT_GE(silences, 1);
  PhoneProbe phone(url);
  EXPECT_FALSE(phone.upgrade(wrong + "/ws"));
  EXPECT_EQ(phones().joined, 0u);
  EXPECT_EQ(phones().pages, 0u);
}

TEST_F(PhoneTest, OtherMethodsThanGetAreRefusedWithTheTokenToo) {
  const std::string path = url.substr(url.find('/', 7));
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "BREW"}) {
    Stranger stranger(url);
    stranger.send(std::string(method) + " " + path +
                  " HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n" +
                  "X-Pad: " + std::string(200, 'a') + "\r\n\r\n");
    EXPECT_FALSE(stranger.drain().starts_with("HTTP/1.1 200")) << method;
  }
  Stranger sender(url);
  sender.send("GET " + path + " HTTP/1.1\r\nHost: x\r\nContent-Length: 1000000\r\n\r\n");
  EXPECT_EQ(sender.drain(), "") << "a body";
  EXPECT_EQ(phones().pages, 0u);
}

TEST_F(PhoneTest, NoBytesEndMoreThanTheirOwnConnection) {
  const std::string path = url.substr(url.find('/', 7));
  std::mt19937_64 random(5);
  std::vector<std::string> all{
      "\r\n\r\n",
      std::string(5000, 'a'),
      std::string(100, '\0'),
      "GET " + std::string(4200, 'a') + " HTTP/1.1\r\n\r\n",
      "GET / HTTP/9.9\r\n\r\n",
      "GET / HTTP/1.1\r\nA\r\n\r\n",
      "GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
      "GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffff\r\n"};
  const std::string good = get(path + "/ws");
  for (int i = 0; i < 100; ++i) {
    std::string bytes = good;
    for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    all.push_back(bytes);
  }
  for (const std::string& bytes : all) {
    Stranger stranger(url);
    ASSERT_TRUE(stranger.connected());
    stranger.send(bytes);
    ::shutdown(stranger.fd(), SHUT_WR);
    stranger.drain();
    EXPECT_TRUE(stranger.closed());
  }
  PhoneProbe phone(url);
  EXPECT_TRUE(phone.join());
}

TEST_F(PhoneTest, MalformedFramesAndMessagesEndTheirOwnConnection) {
  const auto bytes = [](std::initializer_list<int> list) {
    std::vector<unsigned char> out;
    for (const int b : list) out.push_back(static_cast<unsigned char>(b));
    return out;
  };
  // Frames: 2^62 bytes long; unmasked; of a reserved kind; a continuation without a start; a ping
  // of 126 bytes; a close of one byte.
  std::vector<std::vector<unsigned char>> frames{
      bytes({0x82, 0xFF, 0x3F, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3, 4}),
      bytes({0x82, 0x01, 0x00}),
      bytes({0x83, 0x80, 1, 2, 3, 4}),
      bytes({0x80, 0x80, 1, 2, 3, 4}),
      bytes({0x89, 0xFE, 0x00, 0x7E, 1, 2, 3, 4}),
      bytes({0x88, 0x81, 1, 2, 3, 4, 9})};
  std::uint64_t bad = 0;
  for (const auto& frame : frames) {
    PhoneProbe phone(url);
    ASSERT_TRUE(phone.join());
    ASSERT_TRUE(phone.send_raw(frame));
    EXPECT_TRUE(phone.sees_close());
    ++bad;
  }
  EXPECT_TRUE(table.wait_until([&] { return phones().bad_messages == bad; }));
  // Messages: too long, text, empty, of an unknown kind, a second hello, truncated.
  std::vector<std::byte> input(wire::kMaxPhoneRequest);
  input.resize(wire::encode_phone(wire::PhoneRequest(wire::PhoneInput{}), input));
  const std::vector<std::byte> cut(input.begin(), input.end() - 1);
  for (const auto& message :
       {std::vector<std::byte>(wire::kMaxPhoneRequest + 1), std::vector<std::byte>(100'000),
        std::vector<std::byte>{}, std::vector<std::byte>{std::byte{1}, std::byte{9}}, cut}) {
    PhoneProbe phone(url);
    ASSERT_TRUE(phone.join());
    phone.send(message);
    EXPECT_TRUE(phone.sees_close()) << message.size();
    ++bad;
  }
  PhoneProbe texts(url);
  ASSERT_TRUE(texts.join());
  texts.send(input, false);
  EXPECT_TRUE(texts.sees_close());
  ++bad;
  EXPECT_TRUE(table.wait_until([&] { return phones().bad_messages == bad; }));
  PhoneProbe early(url);
  ASSERT_TRUE(early.upgrade());
  early.send(input);
  EXPECT_TRUE(early.sees_close()) << "before the hello";
  PhoneProbe phone(url);
  EXPECT_TRUE(phone.join());
}

class Hurried : public PhoneTest {
 protected:
  Hurried() : PhoneTest([](ServerOptions& o) { o.phones.limits.hello_us = 400'000; }) {}
};

// One byte every 10 ms: slow sending does not extend the time to say hello.
TEST_F(Hurried, ASlowLorisIsShownOutInTime) {
  const std::string request = get(url.substr(url.find('/', 7)), 4000);
  const std::int64_t began = os::monotonic_us();
  Stranger loris(url);
  std::size_t sent = 0;
  while (!wait_readable(loris.fd(), 10) && sent < request.size()) {
    if (!loris.send(request.substr(sent++, 1))) break;
  }
  loris.drain();
  const std::int64_t took = os::monotonic_us() - began;
  EXPECT_LT(sent, request.size());
  EXPECT_GE(took, 350'000);
  EXPECT_LT(took, 3'000'000);
  EXPECT_TRUE(table.wait_until([&] { return phones().timed_out == 1; }));
}

TEST_F(Hurried, WhoUpgradesAndSaysNothingIsShownOutAndWhoSaysHelloMayStay) {
  PhoneProbe phone(url), silent(url);
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(silent.upgrade());
  EXPECT_TRUE(silent.sees_close());
  EXPECT_TRUE(phone.claim(0, RodPair::attack));
}

// 500 connections that send nothing or only the first line: a phone can still join.
TEST_F(PhoneTest, FiveHundredConnectionsKeepNoPhoneOut) {
  std::vector<std::unique_ptr<Stranger>> crowd;
  for (int i = 0; i < 500; ++i) {
    crowd.push_back(std::make_unique<Stranger>(url, "127.0.0." + std::to_string(2 + i % 8)));
    ASSERT_TRUE(crowd.back()->connected());
    if (i % 2 == 0) crowd.back()->send("GET / HTTP/1.1\r\n");
  }
  ASSERT_TRUE(table.wait_until([&] { return phones().crowded_out >= 500 - 64; }));
  const std::int64_t began = os::monotonic_us();
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(0, RodPair::attack));
  std::printf("joined in %.1f ms past 500 strangers\n",
              1e-3 * static_cast<double>(os::monotonic_us() - began));
  EXPECT_LT(os::monotonic_us() - began, 2'000'000);
}

class FewPhones : public PhoneTest {
 protected:
  FewPhones() : PhoneTest([](ServerOptions& o) { o.phones.limits.phones = 2; }) {}
};

TEST_F(FewPhones, NoMorePhonesGetInThanThereMayBe) {
  PhoneProbe ann(url), ben(url);
  ASSERT_TRUE(ann.join());
  ASSERT_TRUE(ben.join());
  PhoneProbe third(url);
  EXPECT_FALSE(third.upgrade());
  ann.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  PhoneProbe fourth(url);
  EXPECT_TRUE(fourth.join());
}

// The capacity is checked when a phone says hello, not only when its connection is opened.
TEST_F(FewPhones, OfManyThatAreOpenBeforeTheFirstHelloNoMoreGetIn) {
  std::vector<std::unique_ptr<PhoneProbe>> crowd;
  for (int i = 0; i < 6; ++i) {
    crowd.push_back(std::make_unique<PhoneProbe>(url));
    ASSERT_TRUE(crowd.back()->upgrade());
  }
  int inside = 0;
  for (const auto& phone : crowd) {
    ASSERT_TRUE(phone->send(wire::PhoneHello{{}, {}, "Ann"}));
    if (inside < 2) {
      ASSERT_TRUE(phone->receive_a<wire::PhoneState>());
      ++inside;
      continue;
    }
    const auto notice = phone->receive_a<wire::PhoneNotice>();
    ASSERT_TRUE(notice);
    EXPECT_EQ(notice->level, number(wire::PhoneNotice::Level::end));
    EXPECT_EQ(notice->text, wire::make_sentence<wire::SentenceId::server_full>().text());
    EXPECT_TRUE(phone->sees_close());
  }
}

class PacedPhones : public PhoneTest {
 protected:
  PacedPhones()
      : PhoneTest([](ServerOptions& o) {
          o.phones.limits.messages_at_once = 20;
          o.phones.limits.message_every_us = 20'000;
        }) {}
};

// A flood is throttled, not stored: a burst of 20, then 50 per second.
TEST_F(PacedPhones, AFloodOfInputsIsReadAtItsPace) {
  PhoneProbe phone(url);
  ASSERT_TRUE(phone.join());
  ASSERT_TRUE(phone.claim(0, RodPair::attack));
  const std::int64_t began = os::monotonic_us();
  for (std::uint32_t i = 1; i <= 60; ++i) ASSERT_TRUE(phone.send(wire::PhoneInput{.sequence = i}));
  ASSERT_TRUE(table.wait_until([&] { return phones().inputs == 60; }));
  EXPECT_GE(os::monotonic_us() - began, 700'000);
  EXPECT_EQ(phones().inputs_dropped, 0u);
}

// Open to the network although the control port is not.
TEST(PhonePort, ListensWhereItIsTold) {
  Lockstep table([](ServerOptions& o) {
    with_phones(o);
    o.phones.listen = "127.0.0.3";
  });
  EXPECT_TRUE(table->phones().starts_with("http://127.0.0.3:")) << table->phones();
  PhoneProbe phone(table->phones());
  EXPECT_TRUE(phone.join());
  EXPECT_FALSE(ProbeClient(table.port(), "127.0.0.1", "127.0.0.3").connected());
}

TEST(PhonePort, OneThatIsTakenIsToldWithTheOptionThatChoosesAnother) {
  Lockstep first(with_phones);
  const std::string url = first->phones();
  const auto at = os::parse_host_port(url.substr(7, url.find('/', 7) - 7));
  Lockstep second([&](ServerOptions& o) {
    with_phones(o);
    o.phones.port = *at->port;
  });
  EXPECT_FALSE(second.started());
  EXPECT_EQ(second.error().kind, StartError::Kind::port_taken);
  EXPECT_NE(second.error().sentence.find("--phone-port"), std::string::npos);
}

}  // namespace
}  // namespace server
