#include "wire/control.h"

#include <gtest/gtest.h>

#include "control_generated.h"
#include "samples.h"
#include "wire/limits.h"
#include "wire/text.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::encoded;
using Status = ControlReader::Status;

// A frame around a FlatBuffers table that encode_control would never write.
template <class Table>
Bytes framed(flatbuffers::FlatBufferBuilder& b, fb::Message kind,
             flatbuffers::Offset<Table> table) {
  fb::FinishControlBuffer(b, fb::CreateControl(b, kind, table.Union()));
  Bytes bytes;
  for (std::size_t i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(b.GetSize() >> 8 * i));
  const auto* data = reinterpret_cast<const std::byte*>(b.GetBufferPointer());
  bytes.insert(bytes.end(), data, data + b.GetSize());
  return bytes;
}

Status read_one(const Bytes& bytes) {
  ControlReader reader;
  reader.push(bytes);
  ControlMessage message;
  return reader.next(message);
}

TEST(Control, EveryMessageRoundTrips) {
  for (const auto& [name, sent] : samples::control()) {
    ControlReader reader;
    reader.push(encoded(sent));
    ControlMessage received;
    ASSERT_EQ(reader.next(received), Status::message) << name;
    EXPECT_TRUE(samples::same(sent, received)) << name;
    EXPECT_EQ(reader.next(received), Status::need_more) << name;
  }
}

TEST(Control, AStreamFedByteByByteGivesEveryMessageAtItsLastByte) {
  const auto all = samples::control();
  ControlReader reader;
  ControlMessage received;
  for (const auto& [name, sent] : all) {
    const Bytes bytes = encoded(sent);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      ASSERT_EQ(reader.next(received), Status::need_more) << name << " byte " << i;
      reader.push(std::span(bytes).subspan(i, 1));
    }
    ASSERT_EQ(reader.next(received), Status::message) << name;
    EXPECT_TRUE(samples::same(sent, received)) << name;
  }
}

TEST(Control, ManyMessagesInOnePushComeOutInOrder) {
  Bytes stream;
  for (std::uint64_t id = 0; id < 1000; ++id) encode_control(Ping{id}, stream);
  ControlReader reader;
  reader.push(stream);
  ControlMessage received;
  for (std::uint64_t id = 0; id < 1000; ++id) {
    ASSERT_EQ(reader.next(received), Status::message);
    ASSERT_EQ(std::get<Ping>(received).id, id);
  }
  EXPECT_EQ(reader.next(received), Status::need_more);
}

TEST(Control, EveryTruncationWaitsForMore) {
  for (const auto& [name, sent] : samples::control()) {
    const Bytes whole = encoded(sent);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_EQ(read_one({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}),
                Status::need_more);
    }
  }
}

TEST(Control, EveryTruncationThatClaimsToBeWholeIsRefused) {
  for (const auto& [name, sent] : samples::control()) {
    const Bytes whole = encoded(sent);
    for (std::size_t size = 4; size < whole.size(); ++size) {
      Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      part[0] = static_cast<std::byte>(size - 4);
      part[1] = static_cast<std::byte>((size - 4) >> 8);
      EXPECT_NE(read_one(part), Status::need_more) << name << " " << size;
      // FlatBuffers pads after a string: truncating the padding loses nothing.
      if (size + 4 <= whole.size()) {
        EXPECT_EQ(read_one(part), Status::broken) << name << " " << size;
      }
    }
  }
}

TEST(Control, NoSingleBitFlipGivesAValueOutOfRange) {
  for (const auto& [name, sent] : samples::control()) {
    const Bytes whole = encoded(sent);
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      Bytes bytes = whole;
      bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
      ControlReader reader;
      reader.push(bytes);
      ControlMessage received;
      if (reader.next(received) != Status::message) continue;
      // An accepted message can be sent: it decodes to an equal one.
      ControlReader again;
      again.push(encoded(received));
      ControlMessage returned;
      ASSERT_EQ(again.next(returned), Status::message) << name << " " << bit;
      EXPECT_TRUE(samples::same(received, returned)) << name << " " << bit;
    }
  }
}

TEST(Control, ALengthAboveTheCapBreaksTheConnectionForGood) {
  for (const std::size_t size : {kMaxControlMessage + 1, std::size_t{0xFFFFFFFF}}) {
    ControlReader reader;
    Bytes head;
    for (int shift = 0; shift < 32; shift += 8)
      head.push_back(static_cast<std::byte>(size >> shift));
    reader.push(head);
    ControlMessage message;
    EXPECT_EQ(reader.next(message), Status::broken);
    reader.push(encoded(ControlMessage{Ping{1}}));
    EXPECT_EQ(reader.next(message), Status::broken);
  }
}

TEST(Control, AnEmptyFrameAndGarbageAreRefused) {
  EXPECT_EQ(read_one(Bytes(4, std::byte{0})), Status::broken);
  std::mt19937_64 random(31);
  for (int i = 0; i < 1000; ++i) {
    Bytes bytes(4 + random() % 200);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    bytes[0] = static_cast<std::byte>(bytes.size() - 4);
    bytes[1] = bytes[2] = bytes[3] = std::byte{0};
    EXPECT_EQ(read_one(bytes), Status::broken);
  }
}

TEST(Control, AnHttpRequestIsRefused) {
  const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const auto bytes = std::as_bytes(std::span(request));
  EXPECT_EQ(read_one({bytes.begin(), bytes.end()}), Status::broken);
}

TEST(Control, ValuesOutOfRangeAreRefused) {
  flatbuffers::FlatBufferBuilder b;
  const auto refused = [&](fb::Message kind, auto table) {
    const Status status = read_one(framed(b, kind, table));
    b.Clear();
    return status == Status::broken;
  };
  EXPECT_FALSE(refused(fb::Message::MatchRequest, fb::CreateMatchRequest(b, 3, 1, 255)));
  EXPECT_TRUE(refused(fb::Message::MatchRequest, fb::CreateMatchRequest(b, 6, 0, 0))) << "kind";
  EXPECT_TRUE(refused(fb::Message::MatchRequest, fb::CreateMatchRequest(b, 0, 2, 0))) << "team";
  EXPECT_TRUE(refused(fb::Message::Hello, fb::CreateHelloDirect(b, 1, 1, "a", 1, 2))) << "team";
  const std::vector<std::uint8_t> key(32, 1), sid(16, 1), long_key(33, 1);
  const auto welcome = [&](std::uint32_t us, std::uint8_t layout, std::uint8_t role,
                           const std::vector<std::uint8_t>& input_key) {
    return fb::CreateWelcomeDirect(b, 1, 1, 1, us, layout, 0, "", 0, 0, role, 1, &input_key, &key);
  };
  const auto tick_of = [&](std::uint32_t us) { return welcome(us, 0, 0, key); };
  EXPECT_TRUE(refused(fb::Message::Welcome, tick_of(0))) << "a tick of length 0";
  EXPECT_FALSE(refused(fb::Message::Welcome, tick_of(kMaxTickUs)));
  EXPECT_TRUE(refused(fb::Message::Welcome, tick_of(kMaxTickUs + 1))) << "a tick too long";
  EXPECT_TRUE(refused(fb::Message::Welcome, welcome(1, 2, 0, key))) << "layout";
  EXPECT_TRUE(refused(fb::Message::Welcome, welcome(1, 0, 3, key))) << "role";
  EXPECT_TRUE(refused(fb::Message::Welcome, welcome(1, 0, 0, sid))) << "a short key";
  EXPECT_TRUE(refused(fb::Message::Welcome, welcome(1, 0, 0, long_key))) << "a long key";
  EXPECT_FALSE(refused(fb::Message::Knock, fb::CreateKnockDirect(b, 2, 2, &sid, &key)));
  EXPECT_TRUE(refused(fb::Message::Knock, fb::CreateKnockDirect(b, 2, 3, &sid, &key))) << "role";
  EXPECT_TRUE(refused(fb::Message::Knock, fb::CreateKnockDirect(b, 2, 1, &key, &key))) << "sid";
  EXPECT_TRUE(refused(fb::Message::Challenge, fb::CreateChallengeDirect(b, &sid))) << "share";
  EXPECT_FALSE(refused(fb::Message::Claim, fb::CreateClaim(b, 0))) << "gives up all";
  EXPECT_FALSE(refused(fb::Message::Claim, fb::CreateClaim(b, 1, 1)));
  EXPECT_TRUE(refused(fb::Message::Claim, fb::CreateClaim(b, 1, 2))) << "team";
  const auto tuning = [&](std::size_t count, double value) {
    const std::vector<double> values(count, value);
    return fb::CreateTuningDirect(b, &values);
  };
  EXPECT_FALSE(refused(fb::Message::Tuning, tuning(kTuningCount, 1e300)));
  EXPECT_TRUE(refused(fb::Message::Tuning, tuning(kTuningCount - 1, 1.0))) << "too few";
  EXPECT_TRUE(refused(fb::Message::Tuning, tuning(kTuningCount + 1, 1.0))) << "too many";
  EXPECT_TRUE(refused(fb::Message::Tuning, tuning(kTuningCount, std::nan("")))) << "no number";
  const auto game = [&](unsigned mode, unsigned rules, unsigned style) {
    const auto byte = [](unsigned n) { return static_cast<std::uint8_t>(n); };
    return fb::CreateGame(b, byte(mode), byte(rules), 255, 255, 0xFFFFFFFF, false, 255,
                          byte(style));
  };
  EXPECT_FALSE(refused(fb::Message::Game, game(kModeCount - 1, kRuleSetCount - 1, kStyleCount)))
      << "numbers are the server's to judge";
  EXPECT_TRUE(refused(fb::Message::Game, game(kModeCount, 0, 0))) << "mode";
  EXPECT_TRUE(refused(fb::Message::Game, game(0, kRuleSetCount, 0))) << "rules";
  EXPECT_TRUE(refused(fb::Message::Game, game(0, 0, kStyleCount + 1))) << "style";
  EXPECT_FALSE(refused(fb::Message::Kick, fb::CreateKick(b, 1)));
  EXPECT_TRUE(refused(fb::Message::Kick, fb::CreateKick(b, 0))) << "nobody";
  const auto answers = [&](std::uint8_t rods, std::size_t count, std::uint8_t score) {
    const std::vector<std::uint8_t> scores(count, score);
    return fb::CreateAnswersDirect(b, 1, rods, &scores);
  };
  EXPECT_FALSE(refused(fb::Message::Answers, answers(1, kQuestionCount, kMaxScore)));
  EXPECT_FALSE(refused(fb::Message::Answers, answers(1, kQuestionCount, 0)));
  EXPECT_TRUE(refused(fb::Message::Answers, answers(1, kQuestionCount, kMaxScore + 1))) << "score";
  EXPECT_TRUE(refused(fb::Message::Answers, answers(1, kQuestionCount + 1, 1))) << "too many";
  EXPECT_TRUE(refused(fb::Message::Answers, answers(1, kQuestionCount - 1, 1))) << "too few";
  EXPECT_TRUE(refused(fb::Message::Answers, answers(1, 60'000, 1))) << "a flood";
  EXPECT_TRUE(refused(fb::Message::Answers, answers(0, kQuestionCount, 1))) << "nobody's";
  EXPECT_TRUE(refused(fb::Message::Questionnaire, fb::CreateQuestionnaire(b, 1, 0))) << "nobody's";
  const auto report = [&](std::size_t teams, std::size_t fame, float rating) {
    const std::vector all(teams, fb::CreateTeamReport(b, 1, 1, 1, 1, 1, 1.0f, rating, 0.0f));
    const auto one = fb::CreateFameDirect(b, "a", rating, 1, 1);
    const std::vector best(fame, one);
    return fb::CreateReportDirect(b, 1, &all, &best);
  };
  EXPECT_FALSE(refused(fb::Message::Report, report(2, kMaxFame, 1500.0f)));
  EXPECT_TRUE(refused(fb::Message::Report, report(1, 0, 1500.0f))) << "a team is missing";
  EXPECT_TRUE(refused(fb::Message::Report, report(2, kMaxFame + 1, 1500.0f))) << "too many";
  EXPECT_TRUE(refused(fb::Message::Report, report(2, 1, std::nanf("")))) << "no number";
  const auto texts = [&](std::size_t count, const char* each) {
    return std::vector(count, b.CreateString(each));
  };
  const auto roster = [&](std::size_t seats, std::uint8_t team) {
    const auto seat = fb::CreateSeatDirect(b, 1, "a", team, 1, 1, false);
    const std::vector all(seats, seat);
    const auto nobody = texts(8, "");
    return fb::CreateRosterDirect(b, &all, &nobody);
  };
  const auto names = [&](std::size_t rods, const char* player) {
    const auto players = texts(rods, player);
    return fb::CreateNamesDirect(b, "Ann", &players);
  };
  EXPECT_FALSE(refused(fb::Message::Names, names(8, "Ben")));
  EXPECT_TRUE(refused(fb::Message::Names, names(7, "Ben"))) << "a rod is missing";
  EXPECT_TRUE(refused(fb::Message::Names, names(9, "Ben"))) << "too many";
  EXPECT_TRUE(refused(fb::Message::Names, names(8, "B\n"))) << "a control character";
  EXPECT_TRUE(refused(fb::Message::Names, names(8, std::string(65, 'a').c_str()))) << "too long";
  EXPECT_FALSE(refused(fb::Message::Roster, roster(kMaxSeats, 0)));
  EXPECT_TRUE(refused(fb::Message::Roster, roster(kMaxSeats + 1, 0))) << "too many seats";
  EXPECT_TRUE(refused(fb::Message::Roster, roster(1, 2))) << "team";
  EXPECT_TRUE(refused(fb::Message::Refusal,
                      fb::CreateRefusalDirect(b, static_cast<fb::RefusalCode>(7), "")));
  EXPECT_TRUE(refused(fb::Message::Notice,
                      fb::CreateNoticeDirect(b, static_cast<fb::NoticeLevel>(3), 0, "")));
  EXPECT_TRUE(refused(static_cast<fb::Message>(200), fb::CreatePing(b, 1))) << "unknown kind";
}

TEST(Control, TextsThatAreLongOrNotPlainUtf8AreRefused) {
  flatbuffers::FlatBufferBuilder b;
  const auto status_of = [&](const std::string& name) {
    const Status status =
        read_one(framed(b, fb::Message::Hello, fb::CreateHello(b, 1, 1, b.CreateString(name))));
    b.Clear();
    return status;
  };
  EXPECT_EQ(status_of(std::string(64, 'a')), Status::message);
  EXPECT_EQ(status_of(std::string(65, 'a')), Status::broken);
  EXPECT_EQ(status_of("\xE2\x82\xAC"), Status::message);
  EXPECT_EQ(status_of("\xE2\x82"), Status::broken) << "cut";
  EXPECT_EQ(status_of("\xC0\xAF"), Status::broken) << "overlong";
  EXPECT_EQ(status_of("\xED\xA0\x80"), Status::broken) << "surrogate";
  EXPECT_EQ(status_of("\xF4\x90\x80\x80"), Status::broken) << "above the last character";
  EXPECT_EQ(status_of("\x1B[2J"), Status::broken) << "escape sequence for a terminal";
  EXPECT_EQ(status_of(std::string("a\0b", 3)), Status::broken);
}

TEST(Control, WhatIsSentIsMadePlainAndCutToWholeCharacters) {
  const auto sent_name = [](const std::string& name) {
    ControlReader reader;
    reader.push(encoded(ControlMessage{Hello{1, 0, name, 0, 0}}));
    ControlMessage message;
    EXPECT_EQ(reader.next(message), Status::message);
    return std::get<Hello>(message).name;
  };
  EXPECT_EQ(sent_name("a\nb\xFF"), "a?b?");
  std::string euros;
  for (int i = 0; i < 30; ++i) euros += "\xE2\x82\xAC";
  EXPECT_EQ(sent_name(euros), euros.substr(0, 63));
}

TEST(CleanText, IsIdempotent) {
  std::mt19937_64 random(32);
  for (int i = 0; i < 10'000; ++i) {
    std::string text(random() % 40, ' ');
    for (char& c : text) c = static_cast<char>(random());
    const std::size_t cap = random() % 40;
    const std::string clean = clean_text(text, cap);
    EXPECT_LE(clean.size(), cap);
    EXPECT_TRUE(is_clean_text(clean, cap));
  }
}

TEST(CleanName, IsWhatOthersSee) {
  const std::pair<std::string, std::string> names[] = {
      {"", "unnamed"},
      {"\u200b\ufeff \u3164", "unnamed"},
      {"An\u200bn", "Ann"},
      {"\u00adAnn\ufe0f", "Ann"},
      {"\u202ennA", "nnA"},
      {"a\U000e0041\u2800b", "ab"},
      {"  Ann\u00a0\u2003 Lee ", "Ann Lee"},
      {"J\u00fcrgen \uae40\u2013", "J\u00fcrgen \uae40\u2013"},
      {"\U0001f469\u200d\U0001f680", "\U0001f469\U0001f680"},
      {"\x1b[2J\n", "?[2J?"},
      {"\xff", "?"},
  };
  for (const auto& [given, shown] : names) EXPECT_EQ(clean_name(given), shown);
}

TEST(CleanName, IsIdempotentAndNoLongerThanANameMayBe) {
  std::mt19937_64 random(33);
  for (int i = 0; i < 10'000; ++i) {
    std::string name(random() % 80, ' ');
    for (char& c : name) c = static_cast<char>(random() % 3 == 0 ? random() : ' ' + random() % 90);
    const std::string clean = clean_name(name);
    EXPECT_LE(clean.size(), kMaxName);
    EXPECT_TRUE(is_clean_text(clean, kMaxName));
    EXPECT_EQ(clean_name(clean), clean);
  }
}

}  // namespace
}  // namespace wire::test
