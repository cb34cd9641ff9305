#include "match_save.h"

#include <utility>

#include "bytes.h"

namespace foosball {
namespace {

constexpr std::uint64_t kMagic = 0x36'30'4d'42'46'53;  // "SFBM06"

template <class Archive, class R>
void visit_rules(Archive& archive, R& rules) {
  archive.choice(rules.set, kRuleSets);
  archive.choice(rules.goals_to_win, kMaxScore + 1);
  archive.choice(rules.max_goals, kMaxScore + 1);
  archive.choice(rules.lead, kMaxScore + 1);
  archive.choice(rules.sets_to_win, kMaxSets + 1);
  archive.real(rules.match_seconds, 0.0, kMaxDuration);
  archive.flag(rules.golden_goal);
  archive.flag(rules.change_sides);
  archive.real(rules.dead_ball_seconds, 0.0, kMaxDuration);
  archive.real(rules.still_seconds, 0.0, kMaxDuration);
  archive.real(rules.possession_midfield_seconds, 0.0, kMaxDuration);
  archive.real(rules.possession_seconds, 0.0, kMaxDuration);
  archive.choice(rules.time_outs, kMaxCount + 1);
  archive.real(rules.time_out_seconds, 0.0, kMaxDuration);
  archive.choice(rules.spin, kSpinRules);
  archive.flag(rules.jarring);
  archive.real(rules.ceremony_seconds, 0.0, kMaxDuration);
  archive.real(rules.end_seconds, 0.0, kMaxDuration);
  archive.real(rules.idle_seconds, 0.0, kMaxDuration);
  archive.real(rules.attract_seconds, 0.0, kMaxDuration);
}

template <class Archive, class Count, class Desc, class State>
void visit_head(Archive& archive, Count& magic, Desc& desc, State& state) {
  archive.count(magic);
  archive.choice(desc.layout, kLayouts);
  archive.choice(desc.mode, kModes);
  visit_rules(archive, desc.rules);
  MatchState::visit(archive, state);
}

// FNV-1a of the bytes it is given. Takes no memory: the recorder hashes between two ticks.
struct ByteHash {
  void push_back(std::byte b) {
    value = (value ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  }
  std::uint64_t value = 0xcbf29ce484222325u;
};

tl::unexpected<vp::Error> refuse(const char* why) {
  return tl::unexpected(vp::Error{vp::Errc::bad_data, why});
}

}  // namespace

void save_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world,
                std::vector<std::byte>& bytes) {
  ByteWriter writer(bytes);
  visit_head(writer, kMagic, desc, state);
  world.snapshot(bytes);
}

vp::Expected<void> load_match(const MatchDesc& desc, std::span<const std::byte> bytes,
                              MatchState& state, std::unique_ptr<TableWorld>& world) {
  ByteReader reader(bytes);
  std::uint64_t magic = 0;
  MatchDesc saved_desc;
  MatchState saved;
  visit_head(reader, magic, saved_desc, saved);
  if (!reader.ok() || magic != kMagic) {
    return refuse("These bytes are not a saved match of this version.");
  }
  if (saved_desc.layout != desc.layout || saved_desc.mode != desc.mode ||
      !(saved_desc.rules == desc.rules)) {
    return refuse(
        "The saved match has another table, mode or other rules; create the match with those.");
  }
  if (saved.built == state.built && saved.first == state.first && saved.tuning == world->tuning()) {
    if (auto result = world->restore(reader.rest()); !result) return result;
  } else {
    auto rebuilt =
        std::make_unique<TableWorld>(desc.layout, saved.built, saved.first, saved.tuning);
    if (auto result = rebuilt->restore(reader.rest()); !result) return result;
    world = std::move(rebuilt);
  }
  state = saved;
  return {};
}

// Over the head's bytes and those of the world's hash.
std::uint64_t hash_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world) {
  ByteHash hash;
  ByteWriter writer(hash);
  visit_head(writer, kMagic, desc, state);
  writer.count(world.state_hash());
  return hash.value;
}

}  // namespace foosball
