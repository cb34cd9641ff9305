#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "server/match_record.h"
#include "server/record_schedule.h"
#include "timeline.h"

namespace {

namespace fs = std::filesystem;

// A recording in a folder of its own: rods that swing, so that the state changes with each tick.
class Timeline : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("watch_test." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    foosball::MatchDesc desc = server::from_header(server::to_header(foosball::MatchDesc{}));
    auto match = foosball::Match::create(desc);
    ASSERT_TRUE(match);
    server::RecordSchedule schedule(*this, server::to_header(desc));
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      wire::JournalTick entry;
      entry.tick = tick;
      for (std::size_t rod = 0; rod < 8; ++rod) {
        entry.rods[rod].live = true;
        entry.rods[rod].angle_urad = static_cast<std::int64_t>(tick * (300 + 40 * rod));
      }
      if (tick == 10 || tick == 500 || tick == 600) {
        entry.commands = {{0, 0, 0, 0}, {0, 1, 0, 0}};  // both teams push
      }
      server::step_recorded(*match, entry);
      schedule.add(entry, *match);
      hashes_.push_back(match->state_hash());
    }
    if (::testing::UnitTest::GetInstance()->current_test_info()->name() !=
        std::string("SaysThatARecordingStopsEarly"))
      schedule.finish(*match);
    encoder_.flush(bytes_);
    write(bytes_.size());
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(std::size_t size) const {
    std::ofstream(path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(size));
  }
  std::string path() const { return (folder_ / "match.sfr").string(); }

 public:
  void add(const wire::JournalEntry& entry) { encoder_.add(entry, bytes_); }

 protected:
  static constexpr std::uint64_t kTicks = 9'000;
  fs::path folder_;
  wire::JournalEncoder encoder_;
  std::vector<std::byte> bytes_;
  std::vector<std::uint64_t> hashes_;  // after each tick
};

TEST_F(Timeline, GoesToAnyTickBothWaysToTheBit) {
  auto timeline = watch::Timeline::open(path());
  ASSERT_TRUE(timeline) << timeline.error();
  (*timeline)->wait_until_read();
  for (const std::uint64_t tick : {8'999u, 1u, 4'001u, 4'000u, 3'999u, 7'345u, 2'000u, 9'000u}) {
    ASSERT_TRUE((*timeline)->seek(tick));
    EXPECT_EQ((*timeline)->scene().ticks(), tick);
    EXPECT_EQ((*timeline)->scene().state_hash(), hashes_[tick - 1]) << tick;
  }
  ASSERT_TRUE((*timeline)->seek(3'000));
  (*timeline)->play_to(3'500);
  EXPECT_EQ((*timeline)->scene().state_hash(), hashes_[3'499]);
}

TEST_F(Timeline, FindsThatTheReplayIsTheMatchThatWasPlayed) {
  auto timeline = watch::Timeline::open(path());
  ASSERT_TRUE(timeline) << timeline.error();
  (*timeline)->wait_until_read();
  const watch::Findings findings = (*timeline)->findings();
  EXPECT_TRUE(findings.done);
  EXPECT_EQ(findings.verdict, server::Playback::Verdict::same) << findings.sentence;
  EXPECT_EQ(findings.read, kTicks);
  EXPECT_EQ(findings.total, kTicks);
}

TEST_F(Timeline, SaysThatARecordingStopsEarly) {
  auto timeline = watch::Timeline::open(path());
  ASSERT_TRUE(timeline) << timeline.error();
  (*timeline)->wait_until_read();
  EXPECT_EQ((*timeline)->findings().verdict, server::Playback::Verdict::cut_short);
  EXPECT_FALSE((*timeline)->has_grown());
  ASSERT_TRUE((*timeline)->seek(kTicks + 5));
  EXPECT_EQ((*timeline)->scene().ticks(), kTicks);
}

TEST_F(Timeline, NoticesThatItsFileGrows) {
  write(bytes_.size() / 2);
  auto timeline = watch::Timeline::open(path());
  ASSERT_TRUE(timeline) << timeline.error();
  (*timeline)->wait_until_read();
  EXPECT_EQ((*timeline)->findings().verdict, server::Playback::Verdict::cut_short);
  EXPECT_LT((*timeline)->findings().read, kTicks);
  EXPECT_FALSE((*timeline)->has_grown());
  write(bytes_.size());
  EXPECT_TRUE((*timeline)->has_grown());
}

TEST_F(Timeline, SharesTheWholeFileAndOverwritesNone) {
  auto timeline = watch::Timeline::open(path());
  ASSERT_TRUE(timeline) << timeline.error();
  const auto first = watch::share(**timeline, folder_.string());
  const auto second = watch::share(**timeline, folder_.string());
  ASSERT_TRUE(first) << first.error();
  ASSERT_TRUE(second) << second.error();
  EXPECT_NE(*first, *second);
  EXPECT_EQ(fs::file_size(*first), bytes_.size());
  EXPECT_EQ(fs::file_size(*second), bytes_.size());
  EXPECT_TRUE(watch::Timeline::open(*second));
  EXPECT_FALSE(watch::share(**timeline, (folder_ / "none").string()));
}

TEST_F(Timeline, RefusesWhatIsNoRecordingByName) {
  write(3);
  const auto timeline = watch::Timeline::open(path());
  ASSERT_FALSE(timeline);
  EXPECT_NE(timeline.error().find("match.sfr"), std::string::npos) << timeline.error();
}

}  // namespace
