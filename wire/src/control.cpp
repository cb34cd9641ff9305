#include "wire/control.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "control_generated.h"
#include "wire/limits.h"
#include "wire/text.h"

namespace wire {
namespace {

constexpr std::size_t kLengthBytes = 4;

// --- to FlatBuffers: one overload per message.

using Builder = flatbuffers::FlatBufferBuilder;

auto text(Builder& b, const std::string& s, std::size_t max_bytes) {
  return b.CreateString(clean_text(s, max_bytes));
}
template <std::size_t kSize>
auto octets(Builder& b, const std::array<std::byte, kSize>& bytes) {
  return b.CreateVector(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}
auto build(Builder& b, const Knock& m) {
  // Argument evaluation order is unspecified, and the bytes must not depend on the compiler.
  const auto share = octets(b, m.share);
  const auto sid = octets(b, m.sid);
  return fb::CreateKnock(b, m.version, m.role, sid, share);
}
auto build(Builder& b, const Challenge& m) {
  return fb::CreateChallenge(b, octets(b, m.share));
}
auto build(Builder& b, const Hello& m) {
  return fb::CreateHello(b, m.version, m.snapshot_layout, text(b, m.name, kMaxName), m.udp_port,
                         m.team, m.rods, m.session, m.ticket);
}
auto build(Builder& b, const Claim& m) {
  return fb::CreateClaim(b, m.rods, m.team);
}
auto build(Builder& b, const Kick& m) {
  return fb::CreateKick(b, m.client);
}
auto texts(Builder& b, const RodPlayers& players) {
  std::array<flatbuffers::Offset<flatbuffers::String>, kRods> each;
  for (std::size_t rod = 0; rod < each.size(); ++rod) each[rod] = text(b, players[rod], kMaxName);
  return b.CreateVector(each.data(), each.size());
}
auto build(Builder& b, const Names& m) {
  const auto players = texts(b, m.players);
  return fb::CreateNames(b, text(b, m.name, kMaxName), players);
}
auto build(Builder& b, const Tuning& m) {
  return fb::CreateTuning(b, b.CreateVector(m.values.data(), m.values.size()));
}
auto build(Builder& b, const Game& m) {
  return fb::CreateGame(b, m.mode, m.rule_set, m.goals, m.sets, m.match_ms, m.change_sides, m.level,
                        m.style, m.date, m.waits);
}
auto build(Builder& b, const Seat& m) {
  return fb::CreateSeat(b, m.client, text(b, m.name, kMaxName), m.team, m.rods, m.role, m.away);
}
auto build(Builder& b, const Roster& m) {
  std::vector<flatbuffers::Offset<fb::Seat>> seats;
  for (const Seat& seat : m.seats) {
    if (seats.size() < kMaxSeats) seats.push_back(build(b, seat));
  }
  const auto players = texts(b, m.players);
  return fb::CreateRoster(b, b.CreateVector(seats), players);
}
auto build(Builder& b, const Characters& m) {
  const std::vector<std::byte> list = encode_characters(m);
  return fb::CreateCharacters(
      b, b.CreateVector(reinterpret_cast<const std::uint8_t*>(list.data()), list.size()));
}
auto build(Builder& b, const Welcome& m) {
  const auto snapshot_key = octets(b, m.snapshot_key);
  const auto input_key = octets(b, m.input_key);
  const auto multicast = text(b, m.multicast, kMaxName);
  return fb::CreateWelcome(b, m.session, m.token, m.udp_port, m.tick_us, m.layout, m.team,
                           multicast, m.multicast_port, m.rods, m.role, m.client, input_key,
                           snapshot_key);
}
auto build(Builder& b, const Refusal& m) {
  return fb::CreateRefusal(b, static_cast<fb::RefusalCode>(m.code), text(b, m.reason, kMaxText));
}
auto build(Builder& b, const MatchRequest& m) {
  return fb::CreateMatchRequest(b, m.kind, m.team, m.value, m.amount);
}
auto build(Builder& b, const Ping& m) {
  return fb::CreatePing(b, m.id);
}
auto build(Builder& b, const Pong& m) {
  return fb::CreatePong(b, m.id);
}
auto build(Builder& b, const Notice& m) {
  return fb::CreateNotice(b, static_cast<fb::NoticeLevel>(m.level), m.topic,
                          text(b, m.text, kMaxText));
}
auto build(Builder& b, const Bye& m) {
  return fb::CreateBye(b, text(b, m.reason, kMaxText));
}
auto build(Builder& b, const Phones& m) {
  return fb::CreatePhones(b, text(b, m.url, kMaxUrl));
}
auto build(Builder& b, const DeviceQuery&) {
  return fb::CreateDeviceQuery(b);
}
auto build(Builder& b, const DeviceReport& m) {
  std::vector<flatbuffers::Offset<fb::DeviceRod>> rods;
  for (const DeviceRod& rod : m.rods)
    rods.push_back(fb::CreateDeviceRod(b, rod.status, rod.slide_counts, rod.spin_counts, rod.slide,
                                       rod.angle));
  const auto all = b.CreateVector(rods);
  return fb::CreateDeviceReport(b, text(b, m.name, kMaxName), m.state, m.frames, m.lost, m.bad,
                                m.stale, m.reopened, m.overflows, m.impossible, m.line_errors,
                                m.stamped, m.latency_sum_us, m.latency_max_us, all);
}
auto build(Builder& b, const Devices& m) {
  std::vector<flatbuffers::Offset<fb::DeviceReport>> devices;
  for (const DeviceReport& device : m.devices) {
    if (devices.size() < kMaxDevices) devices.push_back(build(b, device));
  }
  return fb::CreateDevices(b, m.time_us, b.CreateVector(devices));
}
auto build(Builder& b, const Questionnaire& m) {
  return fb::CreateQuestionnaire(b, m.match, m.rods);
}
auto build(Builder& b, const Answers& m) {
  return fb::CreateAnswers(b, m.match, m.rods, b.CreateVector(m.scores.data(), m.scores.size()));
}
auto build(Builder& b, const TeamReport& m) {
  return fb::CreateTeamReport(b, m.shots, m.shots_on_target, m.saves, m.passes, m.own_goals,
                              m.possession, m.rating, m.rating_change, m.fastest_shot);
}
auto build(Builder& b, const Fame& m) {
  return fb::CreateFame(b, text(b, m.name, kMaxName), m.rating, m.matches, m.wins, m.fastest_shot,
                        m.shots_faced, m.saves);
}
auto build(Builder& b, const Report& m) {
  std::vector<flatbuffers::Offset<fb::TeamReport>> teams;
  for (const TeamReport& team : m.teams) teams.push_back(build(b, team));
  std::vector<flatbuffers::Offset<fb::Fame>> fame;
  for (const Fame& one : m.fame) {
    if (fame.size() < kMaxFame) fame.push_back(build(b, one));
  }
  const auto all = b.CreateVector(teams);
  return fb::CreateReport(b, m.match, all, b.CreateVector(fame));
}

template <class Table>
fb::Message kind_of(flatbuffers::Offset<Table>) {
  return fb::MessageTraits<Table>::enum_value;
}

// --- from FlatBuffers, verified: returns false if a value is out of range.

bool take(const flatbuffers::String* from, std::size_t max_bytes, std::string& to) {
  if (!is_clean_text(from->string_view(), max_bytes)) return false;
  to = from->str();
  return true;
}
bool is_team(std::uint8_t team) {
  return team < kTeamCount || team == kWatchOnly;
}

template <std::size_t kSize>
bool take(const flatbuffers::Vector<std::uint8_t>* from, std::array<std::byte, kSize>& to) {
  if (from->size() != kSize) return false;
  std::memcpy(to.data(), from->data(), kSize);
  return true;
}

bool take(const fb::Knock& t, Knock& m) {
  m.version = t.version();
  m.role = t.role();
  return m.role < kRoleCount && take(t.sid(), m.sid) && take(t.share(), m.share);
}
bool take(const fb::Challenge& t, Challenge& m) {
  return take(t.share(), m.share);
}
bool take(const fb::Claim& t, Claim& m) {
  m.rods = t.rods();
  m.team = t.team();
  return is_team(m.team);
}
bool take(const fb::Kick& t, Kick& m) {
  m.client = t.client();
  return m.client != 0;
}
using Texts = flatbuffers::Vector<flatbuffers::Offset<flatbuffers::String>>;
bool take(const Texts* from, RodPlayers& to) {
  if (from->size() != to.size()) return false;
  for (std::size_t rod = 0; rod < to.size(); ++rod) {
    if (!take(from->Get(static_cast<flatbuffers::uoffset_t>(rod)), kMaxName, to[rod])) return false;
  }
  return true;
}
bool take(const fb::Names& t, Names& m) {
  return take(t.name(), kMaxName, m.name) && take(t.players(), m.players);
}
bool take(const fb::Tuning& t, Tuning& m) {
  if (t.values()->size() != m.values.size()) return false;
  for (std::size_t i = 0; i < m.values.size(); ++i) {
    m.values[i] = t.values()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (!std::isfinite(m.values[i])) return false;
  }
  return true;
}
// The server validates numbers that index no table, and answers with a sentence.
bool take(const fb::Game& t, Game& m) {
  m = {t.mode(),         t.rule_set(), t.goals(), t.sets(), t.match_ms(),
       t.change_sides(), t.level(),    t.style(), t.date(), t.waits()};
  return m.mode < kModeCount && m.rule_set < kRuleSetCount && m.style <= kStyleCount;
}
bool take(const fb::Seat& t, Seat& m) {
  m.client = t.client();
  m.team = t.team();
  m.rods = t.rods();
  m.role = t.role();
  m.away = t.away();
  return take(t.name(), kMaxName, m.name) && is_team(m.team) && m.role < kRoleCount;
}
bool take(const fb::Roster& t, Roster& m) {
  if (t.seats()->size() > kMaxSeats) return false;
  m.seats.clear();
  for (const auto* seat : *t.seats()) {
    if (!take(*seat, m.seats.emplace_back())) return false;
  }
  return take(t.players(), m.players);
}
bool take(const fb::Characters& t, Characters& m) {
  return decode_characters(std::as_bytes(std::span(t.list()->data(), t.list()->size())), m);
}
bool take(const fb::Hello& t, Hello& m) {
  m.version = t.version();
  m.snapshot_layout = t.snapshot_layout();
  m.udp_port = t.udp_port();
  m.team = t.team();
  m.rods = t.rods();
  m.session = t.session();
  m.ticket = t.ticket();
  return take(t.name(), kMaxName, m.name) && is_team(m.team);
}
bool take(const fb::Welcome& t, Welcome& m) {
  m.session = t.session();
  m.token = t.token();
  m.udp_port = t.udp_port();
  m.tick_us = t.tick_us();
  m.layout = t.layout();
  m.team = t.team();
  m.multicast_port = t.multicast_port();
  m.rods = t.rods();
  m.role = t.role();
  m.client = t.client();
  return take(t.input_key(), m.input_key) && take(t.snapshot_key(), m.snapshot_key) &&
         m.role < kRoleCount && take(t.multicast(), kMaxName, m.multicast) && m.tick_us > 0 &&
         m.tick_us <= kMaxTickUs && m.layout < kLayoutCount && is_team(m.team);
}
bool take(const fb::Refusal& t, Refusal& m) {
  m.code = static_cast<Refusal::Code>(t.code());
  return t.code() <= fb::RefusalCode::MAX && take(t.reason(), kMaxText, m.reason);
}
bool take(const fb::MatchRequest& t, MatchRequest& m) {
  m = {t.kind(), t.team(), t.value(), t.amount()};
  const bool kind = m.kind < kRequestKindCount || m.kind == number(RequestKind::tune);
  return kind && m.team < kTeamCount && std::isfinite(m.amount);
}
bool take(const fb::Ping& t, Ping& m) {
  m.id = t.id();
  return true;
}
bool take(const fb::Pong& t, Pong& m) {
  m.id = t.id();
  return true;
}
bool take(const fb::Notice& t, Notice& m) {
  m.level = static_cast<Notice::Level>(t.level());
  m.topic = t.topic();
  return t.level() <= fb::NoticeLevel::MAX && take(t.text(), kMaxText, m.text);
}
bool take(const fb::Bye& t, Bye& m) {
  return take(t.reason(), kMaxText, m.reason);
}
bool take(const fb::Phones& t, Phones& m) {
  return take(t.url(), kMaxUrl, m.url);
}
bool take(const fb::DeviceQuery&, DeviceQuery&) {
  return true;
}
bool take(const fb::DeviceRod& t, DeviceRod& m) {
  m = {t.status(), t.slide_counts(), t.spin_counts(), t.slide(), t.angle()};
  return m.status < kRodStatusCount && std::isfinite(m.slide) && std::isfinite(m.angle);
}
bool take(const fb::DeviceReport& t, DeviceReport& m) {
  m.state = t.state();
  m.frames = t.frames();
  m.lost = t.lost();
  m.bad = t.bad();
  m.stale = t.stale();
  m.reopened = t.reopened();
  m.overflows = t.overflows();
  m.impossible = t.impossible();
  m.line_errors = t.line_errors();
  m.stamped = t.stamped();
  m.latency_sum_us = t.latency_sum_us();
  m.latency_max_us = t.latency_max_us();
  if (t.rods()->size() != m.rods.size()) return false;
  for (std::size_t i = 0; i < m.rods.size(); ++i) {
    if (!take(*t.rods()->Get(static_cast<flatbuffers::uoffset_t>(i)), m.rods[i])) return false;
  }
  return m.state < kDeviceStateCount && take(t.name(), kMaxName, m.name);
}
bool take(const fb::Devices& t, Devices& m) {
  m.time_us = t.time_us();
  if (t.devices()->size() > kMaxDevices) return false;
  m.devices.resize(t.devices()->size());
  for (std::size_t i = 0; i < m.devices.size(); ++i) {
    if (!take(*t.devices()->Get(static_cast<flatbuffers::uoffset_t>(i)), m.devices[i]))
      return false;
  }
  return true;
}
bool take(const fb::Questionnaire& t, Questionnaire& m) {
  m = {t.match(), t.rods()};
  return m.rods != 0;
}
bool take(const fb::Answers& t, Answers& m) {
  if (t.scores()->size() != m.scores.size()) return false;
  m.match = t.match();
  m.rods = t.rods();
  for (std::size_t i = 0; i < m.scores.size(); ++i) {
    m.scores[i] = t.scores()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (m.scores[i] > kMaxScore) return false;
  }
  return m.rods != 0;
}
bool take(const fb::TeamReport& t, TeamReport& m) {
  m = {t.shots(),      t.shots_on_target(), t.saves(),         t.passes(),      t.own_goals(),
       t.possession(), t.rating(),          t.rating_change(), t.fastest_shot()};
  return std::isfinite(m.possession) && std::isfinite(m.rating) && std::isfinite(m.rating_change) &&
         std::isfinite(m.fastest_shot);
}
bool take(const fb::Fame& t, Fame& m) {
  m.rating = t.rating();
  m.matches = t.matches();
  m.wins = t.wins();
  m.fastest_shot = t.fastest_shot();
  m.shots_faced = t.shots_faced();
  m.saves = t.saves();
  return take(t.name(), kMaxName, m.name) && std::isfinite(m.rating) &&
         std::isfinite(m.fastest_shot);
}
bool take(const fb::Report& t, Report& m) {
  m.match = t.match();
  if (t.teams()->size() != m.teams.size() || t.fame()->size() > kMaxFame) return false;
  for (std::size_t i = 0; i < m.teams.size(); ++i) {
    if (!take(*t.teams()->Get(static_cast<flatbuffers::uoffset_t>(i)), m.teams[i])) return false;
  }
  m.fame.clear();
  for (const auto* one : *t.fame()) {
    if (!take(*one, m.fame.emplace_back())) return false;
  }
  return true;
}

template <class Struct, class Table>
bool take_as(const Table* table, ControlMessage& message) {
  return table != nullptr && take(*table, message.emplace<Struct>());
}

// The verifier accepts a message of an unknown kind; the last line rejects it.
bool take_any(const fb::Control& control, ControlMessage& message) {
  switch (control.message_type()) {
    case fb::Message::Hello:
      return take_as<Hello>(control.message_as_Hello(), message);
    case fb::Message::Welcome:
      return take_as<Welcome>(control.message_as_Welcome(), message);
    case fb::Message::Refusal:
      return take_as<Refusal>(control.message_as_Refusal(), message);
    case fb::Message::MatchRequest:
      return take_as<MatchRequest>(control.message_as_MatchRequest(), message);
    case fb::Message::Ping:
      return take_as<Ping>(control.message_as_Ping(), message);
    case fb::Message::Pong:
      return take_as<Pong>(control.message_as_Pong(), message);
    case fb::Message::Notice:
      return take_as<Notice>(control.message_as_Notice(), message);
    case fb::Message::Bye:
      return take_as<Bye>(control.message_as_Bye(), message);
    case fb::Message::Knock:
      return take_as<Knock>(control.message_as_Knock(), message);
    case fb::Message::Challenge:
      return take_as<Challenge>(control.message_as_Challenge(), message);
    case fb::Message::Claim:
      return take_as<Claim>(control.message_as_Claim(), message);
    case fb::Message::Roster:
      return take_as<Roster>(control.message_as_Roster(), message);
    case fb::Message::Tuning:
      return take_as<Tuning>(control.message_as_Tuning(), message);
    case fb::Message::Characters:
      return take_as<Characters>(control.message_as_Characters(), message);
    case fb::Message::Questionnaire:
      return take_as<Questionnaire>(control.message_as_Questionnaire(), message);
    case fb::Message::Answers:
      return take_as<Answers>(control.message_as_Answers(), message);
    case fb::Message::Report:
      return take_as<Report>(control.message_as_Report(), message);
    case fb::Message::Kick:
      return take_as<Kick>(control.message_as_Kick(), message);
    case fb::Message::Game:
      return take_as<Game>(control.message_as_Game(), message);
    case fb::Message::Names:
      return take_as<Names>(control.message_as_Names(), message);
    case fb::Message::Phones:
      return take_as<Phones>(control.message_as_Phones(), message);
    case fb::Message::DeviceQuery:
      return take_as<DeviceQuery>(control.message_as_DeviceQuery(), message);
    case fb::Message::Devices:
      return take_as<Devices>(control.message_as_Devices(), message);
    case fb::Message::NONE:
      break;
  }
  return false;
}

// Precondition: bytes are aligned as operator new aligns, since FlatBuffers reads numbers in place.
bool parse(const std::vector<std::byte>& bytes, ControlMessage& message) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  // A Roster or a Devices message has the most tables.
  constexpr std::uint32_t kMaxDepth = 5,
                          kMaxTables = std::max(kMaxSeats, kMaxDevices * (kRods + 1)) + 2;
  flatbuffers::Verifier verifier(data, bytes.size(), kMaxDepth, kMaxTables);
  return fb::VerifyControlBuffer(verifier) && take_any(*fb::GetControl(data), message);
}

}  // namespace

void encode_control(const ControlMessage& message, std::vector<std::byte>& out) {
  Builder builder(256);
  std::visit(
      [&](const auto& m) {
        const auto table = build(builder, m);
        fb::FinishControlBuffer(builder, fb::CreateControl(builder, kind_of(table), table.Union()));
      },
      message);
  const std::size_t size = builder.GetSize();
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    out.push_back(static_cast<std::byte>(size >> 8 * i));
  }
  const auto* data = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  out.insert(out.end(), data, data + size);
}

void ControlReader::push(std::span<const std::byte> bytes) {
  if (broken_) return;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(read_));
  read_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

ControlReader::Status ControlReader::refuse() {
  broken_ = true;
  buffer_ = {};
  read_ = 0;
  return Status::broken;
}

ControlReader::Status ControlReader::next(ControlMessage& message) {
  if (broken_) return Status::broken;
  const auto waiting = std::span<const std::byte>(buffer_).subspan(read_);
  if (waiting.size() < kLengthBytes) return Status::need_more;
  std::size_t size = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    size |= static_cast<std::size_t>(waiting[i]) << 8 * i;
  }
  if (size > kMaxControlMessage) return refuse();
  if (waiting.size() < kLengthBytes + size) return Status::need_more;
  const auto payload = waiting.subspan(kLengthBytes, size);
  const std::vector<std::byte> aligned(payload.begin(), payload.end());
  if (!parse(aligned, message)) return refuse();
  read_ += kLengthBytes + size;
  return Status::message;
}

}  // namespace wire
