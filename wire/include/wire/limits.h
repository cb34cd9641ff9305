// Limits of the values in the messages. The decoders reject values beyond them, so that a receiver
// may index its tables with received values. They mirror the enumerations of foosball and cabinet,
// which wire does not know; the server, which knows both, asserts that they agree.
#pragma once

#include <cstdint>

#include "wire/enums.h"

namespace wire {

// Simulated time in microseconds is tick * tick_us. It stays below 2^62, so that times and their
// differences fit into 64 bits without a check. 2^48 ticks of one millisecond are 8900 years.
inline constexpr std::uint64_t kMaxTick = (std::uint64_t{1} << 48) - 1;
inline constexpr std::uint32_t kMaxTickUs = 10'000;
static_assert(kMaxTick <= (std::uint64_t{1} << 62) / kMaxTickUs);

inline constexpr unsigned kTeamCount = 2;
inline constexpr int kRods = 8;
inline constexpr unsigned kLayoutCount = 2;  // foosball::Layout
inline constexpr unsigned kScreenCount = number(Screen::end) + 1;
inline constexpr unsigned kMaxCharacterCount = 12;  // foosball::kMaxCharacters
inline constexpr unsigned kBodyNumberCount = 14;    // foosball::kBodyFields
inline constexpr unsigned kVoiceNumberCount = 2;    // foosball::kVoiceFields
inline constexpr unsigned kHeadgearCount = 6;       // foosball::Headgear
inline constexpr unsigned kFaceCount = 4;           // foosball::Face
inline constexpr unsigned kEventKindCount = number(EventKind::match_drawn) + 1;
inline constexpr unsigned kRequestKindCount =
    number(RequestKind::feed) + 1;  // that a client may send; also tune
inline constexpr unsigned kCommandKindCount = number(RequestKind::set_up) + 1;
inline constexpr unsigned kTuningCount = 28;  // foosball::kTuningFields
inline constexpr unsigned kRuleSetCount = number(RuleSet::itsf) + 1;
inline constexpr unsigned kModeCount = number(Mode::ladder) + 1;
inline constexpr unsigned kMaxGoals = 99;           // foosball::kMaxGoals
inline constexpr unsigned kMaxSets = 17;            // foosball::kMaxSets
inline constexpr unsigned kMaxMatchMs = 3'600'000;  // foosball::kMaxMatchMs
inline constexpr unsigned kLastDate = 99991231;     // foosball::kLastDate
inline constexpr unsigned kStyleCount = 4;          // foosball::kPlayStyles
inline constexpr unsigned kFoulCount = number(Foul::serve) + 1;
inline constexpr unsigned kSpinRuleCount = 3;  // foosball::SpinRule
inline constexpr unsigned kRungCount = 5;      // foosball::kLadderRungs
inline constexpr unsigned kRoleCount = number(Role::host) + 1;
inline constexpr unsigned kMenOnRod = 5;
inline constexpr unsigned kQuestionCount = 6;  // results::kQuestions
inline constexpr std::uint8_t kMaxScore = 5;   // results::kMaxScore
inline constexpr unsigned kRodStatusCount = number(RodStatus::held) + 1;
inline constexpr unsigned kDeviceStateCount = number(DeviceState::over) + 1;
inline constexpr unsigned kRodSourceCount = number(RodSource::replay) + 1;

// Notice::topic of answers that are not stored.
inline constexpr std::uint32_t kAnswersTopic = 301;

// Notice::topic of a Game, or a tuning value, that is rejected.
inline constexpr std::uint32_t kGameAnswerTopic = 303;

// Notice::topic of a Kick that is rejected; of a vote against a client: kKickTopics + its number.
inline constexpr std::uint32_t kKickAnswerTopic = 302;
inline constexpr std::uint32_t kKickTopics = 2'000'000;

// Notice::topic of a vote. It encodes the kind and value of the request, so that a client can offer
// to agree.
inline constexpr std::uint32_t kVoteTopics = 200;
struct VoteTopic {
  RequestKind kind;
  std::uint8_t value;
};
constexpr std::uint32_t vote_topic(RequestKind kind, std::uint8_t value) {
  return kVoteTopics + 2u * number(kind) + (value & 1u);
}
constexpr bool is_vote_topic(std::uint32_t topic) {
  return topic >= kVoteTopics && topic < kVoteTopics + 2 * kRequestKindCount;
}
// Precondition: is_vote_topic().
constexpr VoteTopic vote_of(std::uint32_t topic) {
  return {static_cast<RequestKind>((topic - kVoteTopics) / 2),
          static_cast<std::uint8_t>((topic - kVoteTopics) % 2)};
}

}  // namespace wire
