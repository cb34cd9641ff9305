#include "match_save.h"

#include <utility>

#include "bytes.h"

namespace foosball {
namespace {

constexpr std::uint64_t kMagic = 0x38'30'4d'42'46'53;  // "SFBM08"

template <class Archive, class Magic, class Digest, class Desc, class State>
void visit_head(Archive& archive, Magic& magic, Digest& characters, Desc& desc, State& state) {
  archive.any(magic);
  archive.any(characters);
  archive.choice(desc.layout, kLayouts);
  archive.choice(desc.mode, kModes);
  visit_rules(archive, desc.rules);
  MatchState::visit(archive, state);
}

// Rejects combinations of fields that no match can have, although each field is in its range.
bool consistent(const MatchDesc& desc, const MatchState& s) {
  const Rules& rules = s.game.rules;
  const TableSpec& table = table_spec(desc.layout);
  const bool plays = s.screen == Screen::play;
  const auto man_of = [&](int rod, int man) { return man < table.rods[rod].men; };
  const auto touch_ok = [&](const Touch& touch) {
    return touch.tick <= s.tick && man_of(touch.rod, touch.man);
  };
  if (!playable(rules) || !playable(s.next.rules)) return false;
  // Counters that started with the match.
  bool ok = s.screen_ticks <= s.tick && s.play_ticks <= s.tick &&
            s.tally.set_ticks <= s.play_ticks && s.idle_ticks <= s.tick &&
            s.absent_ticks[0] <= s.tick && s.absent_ticks[1] <= s.tick;
  ok = ok && touch_ok(s.touch) && touch_ok(s.touch_of[0]) && touch_ok(s.touch_of[1]);
  // The ball has one location, and it is in play only on the play screen.
  ok = ok && !(s.ball_in_play && (s.ball_parked || !plays)) && (plays || !s.paused);
  // Limits of time-outs and sets.
  ok = ok && s.time_out_left <= ticks_of(rules.time_out_seconds) &&
       (s.time_out_left == 0 || (plays && !s.attract));
  for (int team = 0; team < kTeams; ++team) {
    const bool over = s.screen == Screen::end && s.last_scorer == team;
    ok = ok && s.tally.sets[team] < rules.sets_to_win + (over ? 1 : 0) &&
         s.tally.time_outs[team] <= rules.time_outs;
  }
  return ok && man_of(s.serve_rod, s.serve_man) && man_of(s.feed_rod, s.feed_man);
}

tl::unexpected<vp::Error> invalid(const char* why) {
  return tl::unexpected(vp::Error{vp::Errc::bad_data, why});
}

}  // namespace

void save_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world,
                std::vector<std::byte>& bytes) {
  ByteWriter writer(bytes);
  const std::uint64_t characters = digest(desc.characters);
  visit_head(writer, kMagic, characters, desc, state);
  world.snapshot(bytes);
}

vp::Expected<void> load_match(const MatchDesc& desc, std::span<const std::byte> bytes,
                              MatchState& state, std::unique_ptr<TableWorld>& world) {
  ByteReader reader(bytes);
  std::uint64_t magic = 0, characters = 0;
  MatchDesc saved_desc;
  MatchState saved;
  visit_head(reader, magic, characters, saved_desc, saved);
  if (!reader.ok() || magic != kMagic) {
    return invalid("These bytes are not a saved match of this version.");
  }
  if (saved_desc.layout != desc.layout || saved_desc.mode != desc.mode ||
      !(saved_desc.rules == desc.rules) || characters != digest(desc.characters)) {
    return invalid(
        "The saved match has another table, mode, other rules or characters; create the match with "
        "those.");
  }
  for (const auto& chosen : {saved.character, saved.built}) {
    for (const int character : chosen) {
      if (character >= static_cast<int>(desc.characters.size())) {
        return invalid("The saved match has a character that is none.");
      }
    }
  }
  if (!consistent(desc, saved)) return invalid("No match can be in the state that was saved.");
  if (saved.built == state.built && saved.first == state.first && saved.tuning == world->tuning()) {
    if (auto result = world->restore(reader.rest()); !result) return result;
  } else {
    auto rebuilt = std::make_unique<TableWorld>(desc.layout, bodies_of(desc, saved), saved.first,
                                                saved.tuning);
    if (auto result = rebuilt->restore(reader.rest()); !result) return result;
    world = std::move(rebuilt);
  }
  state = saved;
  return {};
}

// Hash of the header's bytes and the world's hash.
std::uint64_t hash_match(const MatchDesc& desc, const MatchState& state, const TableWorld& world) {
  ByteHash hash;
  ByteWriter writer(hash);
  const std::uint64_t characters = digest(desc.characters);
  visit_head(writer, kMagic, characters, desc, state);
  writer.any(world.state_hash());
  return hash.value;
}

}  // namespace foosball
