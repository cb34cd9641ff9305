#include "timeline.h"

#include <fcntl.h>
#include <sys/file.h>

#include <fstream>

#include "os/file_descriptor.h"
#include "recorded_match.h"
#include "share.h"

namespace watch {
namespace {

class TimelineTest : public RecordedMatch {
 protected:
  std::unique_ptr<Timeline> open(const std::string& name) const {
    auto timeline = Timeline::open(path(name));
    EXPECT_TRUE(timeline) << timeline.error();
    return timeline ? std::move(*timeline) : nullptr;
  }
};

TEST_F(TimelineTest, GoesToAnyTickBothWaysToTheBit) {
  const auto timeline = open("match.sfr");
  timeline->wait_until_read();
  for (const std::uint64_t tick : {8'999u, 1u, 4'001u, 4'000u, 3'999u, 7'345u, 2'000u, 9'000u}) {
    ASSERT_TRUE(timeline->seek(tick));
    EXPECT_EQ(timeline->scene().ticks(), tick);
    EXPECT_EQ(timeline->scene().state_hash(), hashes_[tick - 1]) << tick;
  }
  ASSERT_TRUE(timeline->seek(3'000));
  timeline->play_to(3'500);
  EXPECT_EQ(timeline->scene().state_hash(), hashes_[3'499]);
}

TEST_F(TimelineTest, FindsTheGoalsAndThatTheReplayIsTheMatchThatWasPlayed) {
  const auto timeline = open("match.sfr");
  timeline->wait_until_read();
  const Findings findings = timeline->findings();
  EXPECT_TRUE(findings.done);
  EXPECT_FALSE(findings.being_made);
  EXPECT_EQ(findings.verdict, server::Playback::Verdict::same) << findings.sentence;
  EXPECT_EQ(findings.read, kTicks);
  EXPECT_EQ(findings.total, kTicks);
  ASSERT_EQ(findings.goals.size(), goals_.size());
  ASSERT_FALSE(goals_.empty()) << "the match has no goal to find";
  for (std::size_t i = 0; i < goals_.size(); ++i) {
    EXPECT_GE(findings.goals[i].tick, goals_[i]);
    EXPECT_LE(findings.goals[i].tick, goals_[i] + 20);
  }
}

TEST_F(TimelineTest, SaysThatARecordingStopsEarly) {
  write("cut.sfr", without_end_);
  const auto timeline = open("cut.sfr");
  timeline->wait_until_read();
  EXPECT_EQ(timeline->findings().verdict, server::Playback::Verdict::cut_short);
  EXPECT_FALSE(timeline->findings().being_made);
  ASSERT_TRUE(timeline->seek(kTicks + 5));
  EXPECT_EQ(timeline->scene().ticks(), kTicks);
}

TEST_F(TimelineTest, FollowsAFileThatGrowsToItsEndToTheBit) {
  write("growing.sfr", bytes_.size() / 3);
  const os::FileDescriptor writer(::open(path("growing.sfr").c_str(), O_WRONLY | O_APPEND));
  ASSERT_EQ(::flock(writer.get(), LOCK_EX), 0) << "as a server does";
  const auto timeline = open("growing.sfr");
  timeline->wait_until_read();
  Findings findings = timeline->findings();
  EXPECT_TRUE(findings.being_made);
  EXPECT_LT(findings.total, kTicks);
  ASSERT_TRUE(timeline->seek(1'500));
  for (const std::size_t size : {bytes_.size() / 2, bytes_.size()}) {
    const auto had = static_cast<std::size_t>(::lseek(writer.get(), 0, SEEK_END));
    ASSERT_EQ(::write(writer.get(), bytes_.data() + had, size - had),
              static_cast<ssize_t>(size - had));
    const std::uint64_t before = timeline->findings().total;
    timeline->look_now();
    ASSERT_GT(timeline->findings().total, before);
    timeline->wait_until_read();
    EXPECT_EQ(timeline->scene().ticks(), 1'500u) << "what is watched stays where it is";
    const std::uint64_t last = timeline->findings().total;
    ASSERT_TRUE(timeline->seek(last - 3));
    timeline->play_to(last);
    EXPECT_EQ(timeline->scene().state_hash(), hashes_[last - 1]);
    ASSERT_TRUE(timeline->seek(1'500));
    EXPECT_EQ(timeline->scene().state_hash(), hashes_[1'499]);
  }
  findings = timeline->findings();
  EXPECT_EQ(findings.total, kTicks);
  EXPECT_EQ(findings.verdict, server::Playback::Verdict::same) << findings.sentence;
  EXPECT_FALSE(findings.being_made);
}

// Bytes that the process has read so far, as the kernel counts them.
std::uint64_t bytes_read() {
  std::ifstream file("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  file >> name >> bytes;
  EXPECT_EQ(name, "rchar:");
  return bytes;
}

TEST_F(TimelineTest, OfAFileThatGrowsOnlyWhatIsNewIsRead) {
  const std::size_t half = bytes_.size() / 2;
  ASSERT_GT(half, 30'000u);
  write("growing.sfr", half);
  const os::FileDescriptor writer(::open(path("growing.sfr").c_str(), O_WRONLY | O_APPEND));
  const auto timeline = open("growing.sfr");
  timeline->wait_until_read();
  const std::uint64_t before = bytes_read(), total = timeline->findings().total;
  ASSERT_EQ(::write(writer.get(), bytes_.data() + half, 8'000), 8'000);
  timeline->look_now();
  ASSERT_GT(timeline->findings().total, total);
  EXPECT_LT(bytes_read() - before, 20'000u) << "8000 are new, of " << half + 8'000;
}

TEST_F(TimelineTest, AnotherFileOfTheSameNameIsNotTakenForMoreOfIt) {
  write("a.sfr", bytes_.size() / 3);
  const auto timeline = open("a.sfr");
  timeline->wait_until_read();
  const std::uint64_t total = timeline->findings().total;
  write("b.sfr", bytes_.size());
  std::filesystem::rename(path("b.sfr"), path("a.sfr"));
  timeline->look_now();
  EXPECT_EQ(timeline->findings().total, total);
  // Overwritten in place, as `cat b.sfr > a.sfr` does, the file has its earlier data and more.
  write("c.sfr", bytes_.size() / 3);
  const auto growing = open("c.sfr");
  growing->wait_until_read();
  write("c.sfr", bytes_.size());
  growing->look_now();
  EXPECT_EQ(growing->findings().total, kTicks);
}

// Another match, longer than the data read before: the same inode, other bytes.
TEST_F(TimelineTest, AFileThatIsWrittenAnewIsNotTakenForMoreOfIt) {
  write("a.sfr", bytes_.size() / 3);
  const auto timeline = open("a.sfr");
  timeline->wait_until_read();
  const std::uint64_t total = timeline->findings().total;
  const std::vector<std::byte> other = play(12'345).bytes;
  ASSERT_GT(other.size(), bytes_.size() / 2);
  const os::FileDescriptor writer(::open(path("a.sfr").c_str(), O_WRONLY | O_TRUNC));
  timeline->look_now();
  EXPECT_EQ(timeline->findings().total, total) << "shorter than before";
  ASSERT_EQ(::write(writer.get(), other.data(), other.size()), static_cast<ssize_t>(other.size()));
  timeline->look_now();
  EXPECT_EQ(timeline->findings().total, total);
  ASSERT_TRUE(timeline->seek(total));
  EXPECT_EQ(timeline->scene().state_hash(), hashes_[total - 1]) << "what was read stays";
}

TEST_F(TimelineTest, ALookAtAWholeRecordingReturnsAtOnce) {
  const auto timeline = open("match.sfr");
  timeline->wait_until_read();
  timeline->look_now();
  EXPECT_EQ(timeline->findings().total, kTicks);
}

// Any damage gives an error sentence or a recording that stops early; never a crash.
TEST_F(TimelineTest, ADamagedFileIsASentenceOrStopsEarly) {
  const std::vector<std::byte> whole = bytes_;
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 23) {
    bytes_ = whole;
    bytes_[at] ^= std::byte{0x10};
    write("bad.sfr", bytes_.size());
    const auto timeline = Timeline::open(path("bad.sfr"));
    if (!timeline) {
      EXPECT_NE(timeline.error().find(path("bad.sfr")), std::string::npos) << timeline.error();
      continue;
    }
    (*timeline)->wait_until_read();
    EXPECT_EQ((*timeline)->findings().verdict, server::Playback::Verdict::cut_short);
    ASSERT_TRUE((*timeline)->seek(0));
  }
  for (const char* name : {"/dev/null", "/dev/zero", "/proc/self/mem", "/no/such.sfr"}) {
    const auto timeline = Timeline::open(name);
    ASSERT_FALSE(timeline) << name;
    EXPECT_NE(timeline.error().find(name), std::string::npos) << timeline.error();
  }
}

TEST_F(TimelineTest, SharesTheWholeFileOverwritesNoneAndKeepsTheOriginal) {
  const std::string shared = path("shared/here");
  const auto first = share(path("match.sfr"), shared);
  const auto second = share(path("match.sfr"), shared);
  ASSERT_TRUE(first) << first.error();
  ASSERT_TRUE(second) << second.error();
  EXPECT_NE(*first, *second);
  EXPECT_NE(first->find("Space Foosball 20"), std::string::npos) << *first;
  EXPECT_EQ(std::filesystem::file_size(*first), bytes_.size());
  EXPECT_TRUE(server::summarise_recording(path("match.sfr")).kept);
  const auto none = share(path("match.sfr"), "/proc/no");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().find("/proc/no"), std::string::npos) << none.error();
  EXPECT_FALSE(share(path("nothing.sfr"), shared));
}

TEST_F(TimelineTest, ATellingNameIsOneThatEveryFileSystemTakes) {
  server::RecordingSummary recording;
  recording.characters = {"a/b:c*?", "../.."};
  recording.standing.score = {5, 3};
  const std::string name = telling_name(recording);
  EXPECT_EQ(name.find_first_of("/:*?"), std::string::npos) << name;
  EXPECT_NE(name.find("5-3"), std::string::npos) << name;
}

}  // namespace
}  // namespace watch
