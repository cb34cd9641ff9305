// The only description of the journal's payloads. wire/description.h defines its elements,
// wire/journal.h the records around the payloads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "wire/characters_description.h"
#include "wire/description.h"
#include "wire/journal.h"
#include "wire/limits.h"

namespace wire {

inline constexpr std::uint64_t kJournalMagic = 0x4C4A4653;  // "SFJL"
inline constexpr std::uint64_t kJournalVersion = 2;

// First byte of each payload.
enum class JournalKind : std::uint8_t {
  header = 1,
  ticks = 2,
  hash = 3,
  keyframe = 4,
  end = 5,
  standing = 6
};

constexpr Constant journal_kind(JournalKind kind) {
  return Constant{"kind", 8, static_cast<std::uint64_t>(kind), "of payload"};
}

struct JournalTicksHead {
  std::uint64_t first_tick = 0;
  std::uint8_t count = 0;
};

inline constexpr std::uint64_t kAnyTick = std::numeric_limits<std::uint64_t>::max();

template <class Codec, class H>
void describe_journal_header(Codec& codec, H& h) {
  constexpr std::uint64_t kAny32 = std::numeric_limits<std::uint32_t>::max();
  codec.constant(journal_kind(JournalKind::header));
  codec.constant(Constant{"magic", 32, kJournalMagic, "bytes \"SFJL\""});
  codec.constant(Constant{"version", 16, kJournalVersion, ""});
  codec.layout_hash(LayoutHash{"layout_hash", "of all the journal's tables"});
  codec.integer(Integer{"layout", 8, kLayoutCount - 1, "", "0 paper, 1 tournament"}, h.layout);
  codec.integer(Integer{"seed", 64, std::numeric_limits<std::uint64_t>::max(), "", ""}, h.seed);
  codec.integer(
      Integer{"mode", 8, kModeCount - 1, "", "0 match, 1 training, 2 challenge, 3 ladder"}, h.mode);
  codec.integer(Integer{"rule_set", 8, kRuleSetCount - 1, "", "0 arcade, 1 ITSF"}, h.rule_set);
  codec.integer(
      Integer{"spin", 8, kSpinRuleCount - 1, "", "0 allowed, 1 void goal, 2 loss of ball"}, h.spin);
  codec.integer(Integer{"goals_to_win", 32, kAny32, "", ""}, h.goals_to_win);
  codec.integer(Integer{"max_goals", 32, kAny32, "", ""}, h.max_goals);
  codec.integer(Integer{"lead", 32, kAny32, "", "in the last set"}, h.lead);
  codec.integer(Integer{"sets_to_win", 32, kAny32, "", ""}, h.sets_to_win);
  codec.integer(Integer{"match_ms", 32, kAny32, "ms", "of a set; 0: no limit"}, h.match_ms);
  codec.integer(Integer{"time_outs", 32, kAny32, "", "of a team in a set"}, h.time_outs);
  codec.integer(Integer{"time_out_ms", 32, kAny32, "ms", ""}, h.time_out_ms);
  codec.integer(Integer{"dead_ball_ms", 32, kAny32, "ms", "out of reach"}, h.dead_ball_ms);
  codec.integer(Integer{"still_ms", 32, kAny32, "ms", "within reach, untouched; 0: not judged"},
                h.still_ms);
  codec.integer(Integer{"possession_midfield_ms", 32, kAny32, "ms", ""}, h.possession_midfield_ms);
  codec.integer(Integer{"possession_ms", 32, kAny32, "ms", "elsewhere"}, h.possession_ms);
  codec.integer(Integer{"ceremony_ms", 32, kAny32, "ms", ""}, h.ceremony_ms);
  codec.integer(Integer{"end_ms", 32, kAny32, "ms", ""}, h.end_ms);
  codec.integer(Integer{"idle_ms", 32, kAny32, "ms", "0: never"}, h.idle_ms);
  codec.integer(Integer{"attract_ms", 32, kAny32, "ms", "0: never"}, h.attract_ms);
  codec.array(Group{"tuning", "values of foosball/tuning.h, in its order"}, h.tuning,
              [&](auto& bits) {
                codec.integer(Integer{"bits", 64, std::numeric_limits<std::uint64_t>::max(), "",
                                      "of a double, IEEE 754"},
                              bits);
              });
  describe_characters(codec, h.characters);
  codec.flag(Flag{"golden_goal", ""}, h.golden_goal);
  codec.flag(Flag{"change_sides", ""}, h.change_sides);
  codec.flag(Flag{"jarring", "is judged"}, h.jarring);
  codec.align();
}

template <class Codec, class H>
void describe_journal_ticks_head(Codec& codec, H& head) {
  codec.constant(journal_kind(JournalKind::ticks));
  codec.varint(Varint{"first_tick", kAnyTick, "",
                      "number of the first tick: one more than the last tick before"},
               head.first_tick);
  codec.integer(Integer{"count", 8, kJournalBatch, "", "number of ticks that follow, at least 1"},
                head.count);
}

template <class Codec, class S>
void describe_journal_setup(Codec& codec, S& s) {
  codec.integer(
      Integer{"mode", 2, kModeCount - 1, "", "0 match, 1 training, 2 challenge, 3 ladder"}, s.mode);
  codec.integer(Integer{"rule_set", 1, kRuleSetCount - 1, "", "0 arcade, 1 ITSF"}, s.rule_set);
  codec.integer(Integer{"goals", 7, kMaxGoals, "", "goals that win a set; 0: as in the rule set"},
                s.goals);
  codec.integer(
      Integer{"sets", 5, kMaxSets, "", "best of this number of sets; 0: as in the rule set"},
      s.sets);
  codec.integer(Integer{"match_ms", 22, kMaxMatchMs, "ms", "of a set; 0: no limit"}, s.match_ms);
  codec.integer(Integer{"date", 27, kLastDate, "", "of a challenge, such as 20261122; else 0"},
                s.date);
  codec.flag(Flag{"change_sides", ""}, s.change_sides);
}

template <class Codec, class T>
void describe_journal_tick(Codec& codec, T& tick) {
  constexpr std::int64_t kDelta32 = std::numeric_limits<std::uint32_t>::max();
  codec.array(Group{"rods", "from -x to +x"}, tick.rods, [&](auto& rod) {
    codec.flag(Flag{"changed", "from the tick before"}, rod.changed);
    codec.when(Group{"changed", "the next fields only if it is 1:"}, rod.changed, [&] {
      codec.flag(Flag{"live", ""}, rod.live);
      codec.delta(Delta{"slide", kDelta32, "100 nm", "change"}, rod.slide);
      codec.delta(Delta{"angle", 2 * kJournalAngleLimit, "urad", "change"}, rod.angle);
      codec.delta(Delta{"slide_rate", kDelta32, "um/s", "change"}, rod.slide_rate);
      codec.delta(Delta{"angle_rate", kDelta32, "mrad/s", "change"}, rod.angle_rate);
    });
  });
  codec.list(List{"commands", 7, kMaxJournalCommands, "in the order they were applied"},
             tick.commands, [&](auto& command) {
               codec.integer(Integer{"kind", 4, kCommandKindCount - 1, "",
                                     "0 push, 1 choose character, 2 pause, 3 restart, 4 time-out, "
                                     "5 feed, 6 seat, 7 touch, 8 tune, 9 set up"},
                             command.kind);
               codec.integer(Integer{"team", 1, kTeamCount - 1, "", ""}, command.team);
               codec.integer(Integer{"value", 8, 255, "", ""}, command.value);
               codec.when(Group{"kind", "the next field only if it is 8, tune:"},
                          command.kind == number(RequestKind::tune), [&] {
                            codec.integer(
                                Integer{"amount", 64, std::numeric_limits<std::uint64_t>::max(), "",
                                        "bits of a double, IEEE 754"},
                                command.amount);
                          });
               codec.when(Group{"kind", "the next fields only if it is 9, set up:"},
                          command.kind == number(RequestKind::set_up),
                          [&] { describe_journal_setup(codec, command.setup); });
             });
  codec.align();
}

template <class Codec, class H>
void describe_journal_hash(Codec& codec, H& hash) {
  codec.constant(journal_kind(JournalKind::hash));
  codec.varint(Varint{"tick", kAnyTick, "", "ticks stepped so far"}, hash.tick);
  codec.integer(Integer{"state_hash", 64, std::numeric_limits<std::uint64_t>::max(), "", ""},
                hash.state_hash);
}

template <class Codec, class K>
void describe_journal_keyframe(Codec& codec, K& keyframe) {
  codec.constant(journal_kind(JournalKind::keyframe));
  codec.varint(Varint{"tick", kAnyTick, "", "ticks stepped so far"}, keyframe.tick);
  codec.bytes(Bytes{"snapshot", kMaxKeyframe, "of the match, opaque here"}, keyframe.snapshot);
}

template <class Codec, class E>
void describe_journal_end(Codec& codec, E& end) {
  codec.constant(journal_kind(JournalKind::end));
  codec.varint(Varint{"ticks", kAnyTick, "", "total"}, end.ticks);
  codec.integer(Integer{"state_hash", 64, std::numeric_limits<std::uint64_t>::max(), "", ""},
                end.state_hash);
}

template <class Codec, class S>
void describe_journal_standing(Codec& codec, S& s) {
  codec.constant(journal_kind(JournalKind::standing));
  codec.varint(Varint{"tick", kAnyTick, "", "ticks stepped so far"}, s.tick);
  codec.array(Group{"score", "of the last match with a goal"}, s.score, [&](auto& goals) {
    codec.integer(Integer{"goals", 8, 255, "", ""}, goals);
  });
  codec.array(Group{"sets", "won in that match"}, s.sets, [&](auto& sets) {
    codec.integer(Integer{"sets", 8, 255, "", ""}, sets);
  });
  codec.array(Group{"character", "by the header's list"}, s.character, [&](auto& character) {
    codec.integer(Integer{"character", 8, 255, "", ""}, character);
  });
  codec.array(Group{"computer", "plays the team"}, s.computer, [&](auto& computer) {
    codec.flag(Flag{"computer", ""}, computer);
  });
  codec.align();
  codec.integer(Integer{"won", 16, 65535, "", "matches that were won so far"}, s.won);
}

}  // namespace wire
