// Test fixture: a recording of two computer players with a goal, in a temporary folder.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "foosball/computer_player.h"
#include "server/match_record.h"
#include "server/playback.h"
#include "server/record_schedule.h"

namespace watch {

class RecordedMatch : public testing::Test {
 protected:
  static constexpr std::uint64_t kTicks = 9'000;

  struct Recording {
    wire::JournalEncoder encoder;
    std::vector<std::byte> bytes;
    std::size_t without_end = 0;        // bytes that a server leaves when it is killed
    std::vector<std::uint64_t> hashes;  // after each tick
    std::vector<std::uint64_t> goals;   // ticks stepped
    void add(const wire::JournalEntry& entry) { encoder.add(entry, bytes); }
  };

  static Recording play(std::uint64_t seed) {
    Recording made;
    foosball::MatchDesc wanted;
    wanted.seed = seed;
    wanted.layout = foosball::Layout::tournament;
    const wire::JournalHeader header = server::to_header(wanted);
    auto match = foosball::Match::create(server::from_header(header));
    if (!match) return made;
    std::vector<foosball::ComputerPlayer> players;
    for (int team = 0; team < foosball::kTeams; ++team)
      players.emplace_back(foosball::ComputerPlayerDesc{
          .team = team, .seed = seed, .opens_match = false, .player = {.level = 4}});
    server::RecordSchedule schedule(made, header);
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      foosball::RodTargets hands{};
      for (auto& player : players) player.play(match->view(), hands);
      wire::JournalTick entry;
      entry.tick = tick;
      for (std::size_t rod = 0; rod < hands.size(); ++rod)
        entry.rods[rod] = server::to_grid(hands[rod]);
      if (tick < 2) entry.commands = {{0, 0, 0, 0}, {0, 1, 0, 0}};  // start the play at once
      server::step_recorded(*match, entry);
      schedule.add(entry, *match);
      made.hashes.push_back(match->state_hash());
      for (const foosball::Event& event : match->events())
        if (event.kind == foosball::EventKind::goal) made.goals.push_back(tick + 1);
    }
    made.encoder.flush(made.bytes);
    made.without_end = made.bytes.size();
    schedule.finish(*match);
    return made;
  }
  // The first seed with a goal in the middle, independent of small changes of the physics.
  static const Recording& recording() {
    static const Recording made = [] {
      for (std::uint64_t seed = 1; seed < 200; ++seed) {
        Recording one = play(seed);
        if (!one.goals.empty() && one.goals[0] > 3'000 && one.goals[0] < 8'000) return one;
      }
      return Recording{};
    }();
    return made;
  }

  void SetUp() override {
    ASSERT_EQ(hashes_.size(), kTicks) << "no match had a goal";
    folder_ = std::filesystem::temp_directory_path() / ("watch_test." + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("match.sfr", bytes_.size());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, std::size_t size) const {
    std::ofstream(path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(size));
  }

  std::filesystem::path folder_;
  std::vector<std::byte> bytes_ = recording().bytes;
  std::size_t without_end_ = recording().without_end;
  const std::vector<std::uint64_t>& hashes_ = recording().hashes;
  const std::vector<std::uint64_t>& goals_ = recording().goals;
};

}  // namespace watch
