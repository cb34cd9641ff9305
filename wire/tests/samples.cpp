#include "samples.h"

#include <cmath>
#include <cstdio>

#include "crc32.h"
#include "wire/description.h"
#include "wire/limits.h"

namespace wire::samples {
namespace {

double uniform(std::mt19937_64& random, double limit) {
  return limit * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0);
}

template <class T>
T below(std::mt19937_64& random, std::uint64_t count) {
  return static_cast<T>(random() % count);
}

PoseVelocity random_pose(std::mt19937_64& random, double spin) {
  PoseVelocity pose;
  double sum = 0;
  for (auto& v : pose.orientation) {
    v = static_cast<float>(uniform(random, 1));
    sum += static_cast<double>(v) * static_cast<double>(v);
  }
  for (auto& v : pose.orientation) v = static_cast<float>(static_cast<double>(v) / std::sqrt(sum));
  for (auto& v : pose.position) v = static_cast<float>(uniform(random, 1.99));
  for (auto& v : pose.linear_velocity) v = static_cast<float>(uniform(random, 60));
  for (auto& v : pose.angular_velocity) v = static_cast<float>(uniform(random, spin));
  return pose;
}

PoseVelocity plain_pose(float seed) {
  PoseVelocity pose;
  pose.position = {0.1F * seed, -0.2F, 0.05F};
  pose.orientation = {0.0F, 0.6F, 0.0F, -0.8F};
  pose.linear_velocity = {1.5F, -2.25F, seed};
  pose.angular_velocity = {10.0F, -20.0F, 30.0F};
  return pose;
}

ShotSnapshot random_shot(std::mt19937_64& random) {
  return {below<std::uint8_t>(random, kTeamCount), below<std::uint8_t>(random, kRods),
          below<std::uint8_t>(random, kMenOnRod), static_cast<float>(30 + uniform(random, 30)),
          static_cast<float>(uniform(random, 3.0))};
}

Snapshot random_head(std::mt19937_64& random) {
  Snapshot s;
  s.session = random();
  s.sequence = random();
  s.tick = random() & kMaxTick;
  s.send_time_us = static_cast<std::int64_t>(random() >> 1);
  s.layout = below<std::uint8_t>(random, kLayoutCount);
  s.screen = below<std::uint8_t>(random, kScreenCount);
  s.paused = random() % 2;
  s.ball_in_play = random() % 2;
  s.score = {below<std::uint8_t>(random, 256), below<std::uint8_t>(random, 256)};
  s.character = {below<std::uint8_t>(random, kMaxCharacterCount),
                 below<std::uint8_t>(random, kMaxCharacterCount)};
  s.confirmed = {random() % 2 == 0, random() % 2 == 0};
  s.last_scorer = below<std::uint8_t>(random, kTeamCount);
  s.mode = below<std::uint8_t>(random, kModeCount);
  s.rule_set = below<std::uint8_t>(random, kRuleSetCount);
  s.sets = {below<std::uint8_t>(random, 10), below<std::uint8_t>(random, 10)};
  s.time_outs_left = {below<std::uint8_t>(random, 256), below<std::uint8_t>(random, 256)};
  s.time_out_seconds = static_cast<float>(30 + uniform(random, 30));
  s.time_out_team = below<std::uint8_t>(random, kTeamCount);
  s.timed = random() % 2;
  s.golden_goal = random() % 2;
  s.seconds_left = static_cast<float>(2000 + uniform(random, 1600));
  s.next_server = below<std::uint8_t>(random, kTeamCount);
  s.fouled = random() % 2;
  s.last_foul = below<std::uint8_t>(random, kFoulCount);
  s.last_foul_team = below<std::uint8_t>(random, kTeamCount);
  s.possession_team = below<std::uint8_t>(random, kTeamCount);
  s.possession_seconds = static_cast<float>(10 + uniform(random, 10));
  s.computer = {random() % 2 == 0, random() % 2 == 0};
  s.attract = random() % 2;
  s.rung = below<std::uint8_t>(random, kRungCount);
  s.feed_rod = below<std::uint8_t>(random, kRods);
  s.feed_man = below<std::uint8_t>(random, kMenOnRod);
  s.ball_visible = random() % 2;
  s.last_goal = random_shot(random);
  s.last_goal_own = random() % 2;
  s.last_shot = random_shot(random);
  s.screen_seconds = static_cast<float>(8000 + uniform(random, 8000));
  s.play_seconds = static_cast<float>(8000 + uniform(random, 8000));
  s.ball = random_pose(random, 2000);
  for (RodSnapshot& rod : s.rods) {
    rod.slide = static_cast<float>(uniform(random, 1.9));
    rod.angle = static_cast<float>(uniform(random, 800));
    rod.slide_rate = static_cast<float>(uniform(random, 60));
    rod.angle_rate = static_cast<float>(uniform(random, 250));
    rod.status = below<std::uint8_t>(random, kRodStatusCount);
    rod.source = below<std::uint8_t>(random, kRodSourceCount);
  }
  return s;
}

JournalRod random_rod(std::mt19937_64& random, const JournalRod& before) {
  switch (random() % 8) {
    case 0:  // anything
      return {static_cast<std::int32_t>(random()),
              static_cast<std::int64_t>(random() % 2'000'000'000'000'001) - kJournalAngleLimit,
              static_cast<std::int32_t>(random()), static_cast<std::int32_t>(random()),
              random() % 2 == 0};
    case 1:
    case 2: {  // a small motion of a hand
      JournalRod rod = before;
      rod.slide_100nm += rod.slide_100nm < 0 ? 312 : -417;
      rod.angle_urad += rod.angle_urad < 0 ? 12'000 : -9'000;
      rod.live = true;
      return rod;
    }
    default:
      return before;
  }
}

}  // namespace

Snapshot snapshot() {
  Snapshot s;
  s.session = 0x1122334455667788;
  s.sequence = 1'000'001;
  s.tick = 1'000'000;
  s.send_time_us = 123'456'789'012;
  s.layout = 1;
  s.screen = 2;
  s.ball_in_play = true;
  s.score = {3, 4};
  s.character = {2, 1};
  s.confirmed = {true, false};
  s.last_scorer = 1;
  s.mode = 3;
  s.rule_set = 1;
  s.sets = {1, 2};
  s.time_outs_left = {2, 1};
  s.time_out_seconds = 12.5F;
  s.time_out_team = 1;
  s.timed = s.fouled = s.last_goal_own = s.ball_visible = true;
  s.seconds_left = 75.25F;
  s.next_server = 1;
  s.last_foul = 2;
  s.last_foul_team = 1;
  s.possession_seconds = 3.5F;
  s.computer = {false, true};
  s.rung = 4;
  s.feed_rod = 6;
  s.feed_man = 2;
  s.last_goal = {1, 5, 2, 7.5F, 0.25F};
  s.last_shot = {0, 2, 1, 9.25F, -0.125F};
  s.screen_seconds = 12.5F;
  s.play_seconds = 99.25F;
  s.ball = plain_pose(0.5F);
  for (std::size_t i = 0; i < s.rods.size(); ++i) {
    const float n = static_cast<float>(i);
    s.rods[i] = {0.01F * n,
                 1.5F * n - 4.0F,
                 -0.5F * n,
                 3.0F * n,
                 static_cast<std::uint8_t>(i % kRodStatusCount),
                 static_cast<std::uint8_t>(i % kRodSourceCount)};
  }
  s.men = {{0, 0, plain_pose(1.0F)}, {7, 4, plain_pose(-1.0F)}};
  s.events = {{77, 3, 1, 5, 3, 0.125F, {0.25F, -0.5F, 0.017F}, 0.5F, true}};
  return s;
}

InputDatagram input() {
  InputDatagram i;
  i.session = 0x1122334455667788;
  i.token = 0x99AABBCCDDEEFF00;
  i.sequence = 4242;
  for (std::size_t rod = 0; rod < i.rods.size(); ++rod) {
    const float n = static_cast<float>(rod);
    i.rods[rod] = {rod % 2 == 1, 0.02F * n - 0.05F, 2000.0 * n - 5000.0, 0.25F * n, -1.5F * n};
  }
  return i;
}

std::vector<std::pair<std::string, PhoneRequest>> phone_requests() {
  PhoneInput input{.sequence = 4242};
  input.rods = {PhoneRod{true, 0.0625F, -kTurn / 4, 0.5F, -20.0F},
                PhoneRod{false, -0.125F, 3 * kTurn, 0.0F, 8.0F}};
  return {{"hello", PhoneHello{0x1122334455667788, 0x99AABBCCDDEEFF00, "J\xC3\xBCrgen"}},
          {"claim", PhoneClaim{1, number(RodPair::attack)}},
          {"input", input}};
}

std::vector<std::pair<std::string, PhoneReply>> phone_replies() {
  PhoneState state{.session = 0x1122334455667788,
                   .ticket = 0x99AABBCCDDEEFF00,
                   .team = 1,
                   .pair = number(RodPair::attack),
                   .free = 0b0101,
                   .name = "Ann 2"};
  state.rods = {PhoneRodPlace{3, 3, 0.1875F, 0.125F}, PhoneRodPlace{2, 5, 0.125F, 0.0625F}};
  return {{"state", state},
          {"notice", PhoneNotice{number(PhoneNotice::Level::warning), "team 0 is taken"}},
          {"pulse", PhonePulse{1, 200, 40}}};
}

template <std::size_t kSize>
std::array<std::byte, kSize> octets(unsigned first) {
  std::array<std::byte, kSize> bytes;
  for (std::size_t i = 0; i < kSize; ++i) bytes[i] = static_cast<std::byte>(first + i);
  return bytes;
}

Tuning tuning() {
  Tuning all;
  for (std::size_t i = 0; i < all.values.size(); ++i)
    all.values[i] = 0.5 * static_cast<double>(i) - 1.25;
  return all;
}

std::vector<CharacterRecord> characters() {
  CharacterRecord tall{"tall", "hard shots", {}, {}, {1, 2, 3}, {253, 254, 255}, 5, 3};
  for (std::size_t i = 0; i < tall.body.size(); ++i) tall.body[i] = 0x3FF8000000000000 + i;
  tall.voice = {0x4074000000000000, 0x3FE0000000000000};
  return {tall, {"J\xC3\xBCrgen", "", {}, {}, {}, {}, 0, 0}};
}

Devices devices() {
  DeviceReport cabinet{.name = "cabinet at serial:/dev/ttyACM0",
                       .state = number(DeviceState::live),
                       .frames = 60'000,
                       .lost = 3,
                       .bad = 2,
                       .stale = 1,
                       .reopened = 4,
                       .overflows = 5,
                       .impossible = 6,
                       .line_errors = 7,
                       .stamped = 59'000,
                       .latency_sum_us = 29'500'000,
                       .latency_max_us = 1'900,
                       .rods = {}};
  for (std::size_t i = 0; i < cabinet.rods.size(); ++i) {
    const auto n = static_cast<std::int64_t>(i);
    cabinet.rods[i] = {number(RodStatus::live), -5'000'000'000 + n, 7 * n,
                       0.01f * static_cast<float>(i), -0.5f};
  }
  return {0x1122334455667788, {cabinet, DeviceReport{.name = "mouse", .rods = {}}}};
}

std::vector<std::pair<std::string, ControlMessage>> control() {
  return {{"hello", Hello{1, 0xDEADBEEF, "J\xC3\xBCrgen", 4243, 0, 0x81, 0x1122334455667788, 7}},
          {"welcome", Welcome{0x1122334455667788, 0x99AABBCCDDEEFF00, 4242, 1000, 1, kWatchOnly,
                              "239.1.2.3", 4244, 0x81, 2, 9, octets<32>(1), octets<32>(101)}},
          {"refusal", Refusal{Refusal::Code::team_taken, "Team 0 is taken; choose team 1."}},
          {"request", MatchRequest{1, 1, 2, 0.0}},
          {"tune", MatchRequest{8, 0, 26, 0.125}},
          {"ping", Ping{7}},
          {"pong", Pong{7}},
          {"notice", Notice{Notice::Level::warning, 3, "cabinet unplugged: its rods hold"}},
          {"bye", Bye{"window closed"}},
          {"knock", Knock{2, 1, octets<16>(1), octets<32>(65)}},
          {"challenge", Challenge{octets<32>(17)}},
          {"claim", Claim{0x2A}},
          {"kick", Kick{7}},
          {"change_of_team", Claim{0xF0, 1}},
          {"roster", Roster{{{1, "Ann", 0, 0x0B, 2, false}, {2, "", 1, 0xF0, 1, true}},
                            {"", "Ben", "", "", "", "", "", "J\xC3\xBCrgen"}}},
          {"phones", Phones{"http://192.168.1.5:7541/23456789abcdefghjkmnpqrstu"}},
          {"device_query", DeviceQuery{}},
          {"devices", devices()},
          {"names", Names{"Ann", {"", "Ben", "", "", "", "", "", "J\xC3\xBCrgen"}}},
          {"tuning", tuning()},
          {"game", Game{2, 0, 0, 0, 90'000, true, 4, 3, 20261122, true}},
          {"characters", Characters{characters()}},
          {"questionnaire", Questionnaire{3, 0x2B}},
          {"answers", Answers{3, 0x0B, {5, 4, 0, 1, 3, 2}}},
          {"report", Report{3,
                            {{{7, 5, 2, 11, 1, 60.25f, 1516.0f, 16.0f, 9.5f},
                              {3, 1, 4, 2, 0, 50.0f, 1484.0f, -16.0f, 0.0f}}},
                            {{"J\xC3\xBCrgen", 1516.0f, 12, 7, 9.5f, 40, 22},
                             {"computer 2", 1484.0f, 1, 0}}}}};
}

std::vector<JournalEntry> journal() {
  std::vector<JournalEntry> entries{JournalHeader{.layout = 1,
                                                  .seed = 42,
                                                  .mode = 2,
                                                  .rule_set = 1,
                                                  .sets_to_win = 3,
                                                  .match_ms = 120'000,
                                                  .change_sides = true,
                                                  .spin = 2,
                                                  .characters = characters()}};
  JournalTick tick;
  tick.rods[3] = {400'000, -1'570'796, 2'000'000, -31'416, true};
  tick.commands = {{0, 1, 0, 0},
                   {1, 0, 2, 0},
                   {8, 0, 3, 0x3FF8000000000000},
                   {9, 0, 0, 0, {3, 1, 7, 5, 90'000, true, 20261122}}};
  entries.emplace_back(tick);
  tick.tick = 1;
  tick.commands.clear();
  tick.rods[3].slide_100nm = 400'321;
  entries.emplace_back(tick);
  tick.tick = 2;
  entries.emplace_back(tick);
  entries.emplace_back(JournalHash{3, 0xFEEDFACECAFEBEEF});
  entries.emplace_back(JournalKeyframe{3, {std::byte{1}, std::byte{2}, std::byte{3}}});
  entries.emplace_back(JournalStanding{3, {5, 3}, {2, 1}, {0, 4}, {false, true}, 1});
  entries.emplace_back(JournalEnd{3, 0xFEEDFACECAFEBEEF});
  return entries;
}

DeviceFrame device_frame() {
  DeviceFrame frame{};
  frame.flags = 1;
  frame.sequence = 0x0102;
  frame.time_us = 0x03040506;
  for (int rod = 0; rod < kDeviceRods; ++rod) {
    frame.slide[rod] = static_cast<std::uint16_t>(1000 * rod);
    frame.spin[rod] = static_cast<std::uint16_t>(65535 - 300 * rod);
  }
  frame.present = 0xFF;
  frame.overflow = 0x08;
  frame.quality = 2;
  frame.index = 0x41;
  return frame;
}

std::vector<std::pair<std::string, DeviceCommand>> device_commands() {
  DeviceCommand pulse{}, off{}, settings{}, stick{}, tell{};
  pulse.kind = kPulseCommand;
  pulse.sequence = off.sequence = settings.sequence = 0x0102;
  pulse.rod = 5;
  pulse.amplitude = 200;
  pulse.duration_ms = 20;
  off.kind = kAllOffCommand;
  settings.kind = kSettingsCommand;
  settings.resolution = 20;
  settings.brightness = 64;
  settings.ps2 = 0x81;
  settings.switches = 1;
  stick.kind = kStickCommand;
  stick.rod = 3;
  stick.travel = 1216;
  stick.turn = 402;
  stick.reversed = kSpinReversed;
  tell.kind = kTellSettingsCommand;
  return {{"pulse", pulse}, {"off", off}, {"settings", settings}, {"stick", stick}, {"tell", tell}};
}

DeviceSettings device_settings() {
  DeviceSettings settings;
  settings.resolution = 60;
  settings.brightness = 200;
  settings.ps2 = 0x81;
  settings.switches = kPulsesOff | kGamepads;
  settings.sticks[3] = {1216, 402};
  settings.slide_reversed = 0x08;
  settings.spin_reversed = 0x42;
  return settings;
}

Snapshot random_snapshot(std::mt19937_64& random, bool full) {
  Snapshot s = random_head(random);
  s.men.resize(full ? kMaxMen : random() % (kMaxMen + 1));
  for (ManState& man : s.men) {
    man.rod = below<std::uint8_t>(random, kRods);
    man.man = below<std::uint8_t>(random, kMenOnRod);
    man.body = random_pose(random, 250);
  }
  s.events.resize(full ? kMaxEvents : random() % (kMaxEvents + 1));
  for (EventSnapshot& event : s.events) {
    event.id = static_cast<std::uint32_t>(random());
    event.kind = below<std::uint8_t>(random, kEventKindCount);
    event.team = below<std::uint8_t>(random, kTeamCount);
    event.rod = below<std::uint8_t>(random, kRods);
    event.man = below<std::uint8_t>(random, kMenOnRod);
    event.value = static_cast<float>(uniform(random, 60));
    event.angle = static_cast<float>(uniform(random, 3.0));
    event.own = random() % 2;
    for (float& v : event.point) v = static_cast<float>(uniform(random, 1.99));
  }
  return s;
}

InputDatagram random_input(std::mt19937_64& random) {
  InputDatagram i;
  i.session = random();
  i.token = random();
  i.sequence = static_cast<std::uint32_t>(random());
  for (InputRod& rod : i.rods) {
    rod.driven = random() % 2;
    rod.slide = static_cast<float>(uniform(random, 1.9));
    rod.angle = uniform(random, 200'000);
    rod.slide_rate = static_cast<float>(uniform(random, 60));
    rod.angle_rate = static_cast<float>(uniform(random, 250));
  }
  return i;
}

std::vector<CharacterRecord> random_characters(std::mt19937_64& random) {
  std::vector<CharacterRecord> all(1 + random() % kMaxCharacterCount);
  for (CharacterRecord& c : all) {
    c.name = std::string(random() % (kMaxCharacterName + 1), 'n');
    c.specialty = std::string(random() % (kMaxCharacterSpecialty + 1), 's');
    for (auto& bits : c.body) bits = random();
    for (auto& bits : c.voice) bits = random();
    for (auto& part : c.skin) part = below<std::uint8_t>(random, 256);
    for (auto& part : c.accent) part = below<std::uint8_t>(random, 256);
    c.headgear = below<std::uint8_t>(random, kHeadgearCount);
    c.face = below<std::uint8_t>(random, kFaceCount);
  }
  return all;
}

JournalSetup random_setup(std::mt19937_64& random) {
  return {below<std::uint8_t>(random, kModeCount),       below<std::uint8_t>(random, kRuleSetCount),
          below<std::uint8_t>(random, kMaxGoals + 1),    below<std::uint8_t>(random, kMaxSets + 1),
          below<std::uint32_t>(random, kMaxMatchMs + 1), random() % 2 == 0,
          below<std::uint32_t>(random, kLastDate + 1)};
}

std::vector<JournalEntry> random_journal(std::mt19937_64& random, int ticks) {
  std::vector<JournalEntry> entries{
      JournalHeader{.seed = random(), .dead_ball_ms = 1, .ceremony_ms = 2, .end_ms = 3}};
  std::get<JournalHeader>(entries[0]).characters = random_characters(random);
  JournalTick tick;
  for (; tick.tick < static_cast<std::uint64_t>(ticks); ++tick.tick) {
    for (JournalRod& rod : tick.rods) rod = random_rod(random, rod);
    tick.commands.resize(random() % 16 == 0 ? random() % (kMaxJournalCommands + 1) : 0);
    for (JournalCommand& command : tick.commands) {
      command = {below<std::uint8_t>(random, kCommandKindCount),
                 below<std::uint8_t>(random, kTeamCount), below<std::uint8_t>(random, 256), 0};
      if (command.kind == number(RequestKind::tune)) command.amount = random();
      if (command.kind == number(RequestKind::set_up)) command.setup = random_setup(random);
    }
    entries.emplace_back(tick);
    if (random() % 50 == 0) entries.emplace_back(JournalHash{tick.tick + 1, random()});
    if (random() % 50 == 0) {
      const auto any = [&] { return below<std::uint8_t>(random, 256); };
      entries.emplace_back(JournalStanding{tick.tick + 1,
                                           {any(), any()},
                                           {any(), any()},
                                           {any(), any()},
                                           {random() % 2 == 0, random() % 2 == 0},
                                           any()});
    }
    if (random() % 100 == 0) {
      JournalKeyframe keyframe{tick.tick + 1, Bytes(random() % 3000)};
      for (std::byte& b : keyframe.snapshot) b = static_cast<std::byte>(random());
      entries.emplace_back(keyframe);
    }
  }
  entries.emplace_back(JournalEnd{tick.tick, random()});
  return entries;
}

Bytes encoded(const Snapshot& snapshot) {
  Bytes bytes(kMaxDatagram);
  bytes.resize(encode_snapshot(snapshot, bytes));
  return bytes;
}

Bytes encoded(const PhoneRequest& request) {
  Bytes bytes(kMaxPhoneRequest);
  bytes.resize(encode_phone(request, bytes));
  return bytes;
}

Bytes encoded(const PhoneReply& reply) {
  Bytes bytes(kMaxPhoneReply);
  bytes.resize(encode_phone(reply, bytes));
  return bytes;
}

Bytes encoded(const InputDatagram& input) {
  Bytes bytes(kMaxInputDatagram);
  bytes.resize(encode_input(input, bytes));
  return bytes;
}

Bytes encoded(const ControlMessage& message) {
  Bytes bytes;
  encode_control(message, bytes);
  return bytes;
}

Bytes encoded(const std::vector<JournalEntry>& journal) {
  Bytes bytes;
  JournalEncoder encoder;
  for (const JournalEntry& entry : journal) encoder.add(entry, bytes);
  encoder.flush(bytes);
  return bytes;
}

Bytes encoded(const DeviceFrame& frame) {
  Bytes bytes(kDeviceFrameBytes);
  encode_device_frame(frame, reinterpret_cast<std::uint8_t*>(bytes.data()));
  return bytes;
}

Bytes encoded_version_1(DeviceFrame frame) {
  frame.index = 0;
  Bytes bytes = encoded(frame);
  auto* const octets = reinterpret_cast<std::uint8_t*>(bytes.data());
  octets[0] = 1;
  device_put16(octets + 44, device_crc16(octets, 44));
  return bytes;
}

Bytes encoded(const DeviceCommand& command) {
  Bytes bytes(kDeviceCommandBytes);
  encode_device_command(command, reinterpret_cast<std::uint8_t*>(bytes.data()));
  return bytes;
}

Bytes encoded(const DeviceSettings& settings) {
  Bytes bytes(kDeviceFrameBytes);
  encode_settings_report(settings, kHasSensors, 0x1234,
                         reinterpret_cast<std::uint8_t*>(bytes.data()));
  return bytes;
}

Bytes encoded_cobs(const DeviceFrame& frame) {
  const Bytes plain = encoded(frame);
  Bytes bytes(kDeviceCobsBytes);
  bytes.resize(cobs_encode(reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size(),
                           reinterpret_cast<std::uint8_t*>(bytes.data())));
  return bytes;
}

void reseal(Bytes& datagram) {
  if (datagram.size() < 4) return;
  const std::size_t covered = datagram.size() - 4;
  const std::uint32_t crc = crc32(std::span(datagram).first(covered));
  for (std::size_t i = 0; i < 4; ++i) {
    datagram[covered + i] = static_cast<std::byte>(crc >> 8 * i);
  }
}

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned>(b));
    text += digits;
  }
  return text;
}

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

}  // namespace wire::samples
