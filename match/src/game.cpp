#include "match/game.h"

#include <memory>
#include <optional>

#include "foosball/computer_player.h"
#include "match/player.h"
#include "server/match_record.h"
#include "server/record_schedule.h"
#include "wire/journal.h"

namespace match {
namespace {

using foosball::Command;
using foosball::kRods;
using foosball::kTeams;

// A journal in memory, in the format of the server's recorder.
class MemorySink {
 public:
  explicit MemorySink(std::vector<std::byte>& out) : out_(out) {}
  void add(const wire::JournalEntry& entry) { encoder_.add(entry, out_); }
  void flush() { encoder_.flush(out_); }

 private:
  std::vector<std::byte>& out_;
  wire::JournalEncoder encoder_;
};

foosball::MatchDesc match_of(const GameDesc& desc) {
  foosball::MatchDesc match{
      .layout = desc.layout, .seed = desc.seed, .rules = {}, .tuning = desc.tuning};
  match.characters = desc.character_list;
  return match;
}

class Game {
 public:
  Game(const GameDesc& desc, Recording recording)
      : desc_(desc),
        header_(server::to_header(match_of(desc))),
        match_(*foosball::Match::create(server::from_header(header_))),
        sink_(played_.journal) {
    for (int team = 0; team < kTeams; ++team) {
      const std::uint64_t seed =
          mix_seed(4 * desc.seed + static_cast<std::uint64_t>(2 * desc.variant + team));
      players_[team] = *make_player({desc.players[team], team, seed});
    }
    if (recording == Recording::on) record_.emplace(sink_, header_);
  }

  PlayedGame play() {
    for (std::uint64_t tick = 0; tick < desc_.max_ticks; ++tick) {
      if (step(tick)) break;
    }
    observer_.abandon();
    if (record_) {
      record_->finish(match_);
      sink_.flush();
    }
    GameResult& result = played_.result;
    result.score = match_.view().score;
    result.winner = result.score[0] == result.score[1]  ? -1
                    : result.score[0] > result.score[1] ? 0
                                                        : 1;
    result.state_hash = match_.state_hash();
    result.statistics = observer_.totals();
    return std::move(played_);
  }

 private:
  // Returns true when a team has won.
  bool step(std::uint64_t number) {
    const foosball::MatchView& view = match_.view();
    open_or_go_on(number, view);
    foosball::RodTargets hands{};
    for (auto& player : players_) player->play(view, hands, foosball::kAllRods);
    foosball::TickInput input;
    put_on_grid(hands);
    input.rods = on_grid_;
    input.commands = commands_;
    match_.step(input);
    for (const auto& player : players_) observer_.meant(player->passed(), desc_.layout);
    observer_.observe(view, match_.events(), input.rods);
    if (record_) {
      tick_.tick = number;
      tick_.commands.clear();
      for (const Command& command : commands_) tick_.commands.push_back(server::to_record(command));
      record_->add(tick_, match_);
    }
    for (const foosball::Event& event : match_.events()) {
      if (event.kind == foosball::EventKind::match_won) return true;
    }
    return false;
  }

  // Quantizes the targets as a recording does. Most targets do not change: those keep their
  // quantized values.
  void put_on_grid(const foosball::RodTargets& hands) {
    for (int rod = 0; rod < kRods; ++rod) {
      if (hands[rod] == hands_[rod]) continue;
      tick_.rods[rod] = server::to_grid(hands[rod]);
      on_grid_[rod] = server::from_grid(tick_.rods[rod]);
    }
    hands_ = hands;
  }

  // Passes the screens before play by commands, and leaves the ceremony as soon as the match
  // permits it.
  void open_or_go_on(std::uint64_t tick, const foosball::MatchView& view) {
    constexpr double kCeremony = 0.6;  // [s]
    commands_.clear();
    if (tick == 0) commands_.push_back({Command::Kind::push, 0, 0});
    if (tick == 1) {
      for (std::uint8_t team = 0; team < kTeams; ++team) {
        const auto character = static_cast<std::uint8_t>(desc_.characters[team]);
        commands_.push_back({Command::Kind::choose_character, team, character});
        commands_.push_back({Command::Kind::push, team, 0});
      }
    }
    if (view.screen == foosball::Screen::ceremony && view.screen_seconds >= kCeremony) {
      commands_.push_back({Command::Kind::push, 0, 0});
    }
  }

  GameDesc desc_;
  wire::JournalHeader header_;
  foosball::Match match_;
  std::array<std::unique_ptr<Player>, kTeams> players_;
  foosball::StatisticsObserver observer_;
  PlayedGame played_;
  MemorySink sink_;
  std::optional<server::RecordSchedule<MemorySink>> record_;
  wire::JournalTick tick_;
  foosball::RodTargets hands_{}, on_grid_{};  // of the previous tick
  std::vector<Command> commands_;
};

}  // namespace

PlayedGame play_game(const GameDesc& desc, Recording recording) {
  return Game(desc, recording).play();
}

std::uint64_t mix_seed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::array<int, foosball::kTeams> drawn_characters(std::uint64_t seed, std::size_t characters) {
  const std::uint64_t bits = mix_seed(seed ^ 0x6368617261637465u);
  const std::uint64_t n = characters;
  return {static_cast<int>(bits % n), static_cast<int>((bits >> 32) % n)};
}

}  // namespace match
