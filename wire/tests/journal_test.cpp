#include "wire/journal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "crc32.h"
#include "samples.h"
#include "wire/description.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::encoded;

struct Read {
  std::vector<JournalEntry> entries;
  std::string problem;
};

Read read_all(std::span<const std::byte> file) {
  JournalReader reader(file);
  Read read;
  while (auto entry = reader.next()) read.entries.push_back(std::move(*entry));
  read.problem = reader.problem();
  return read;
}

void expect_prefix(const std::vector<JournalEntry>& part, const std::vector<JournalEntry>& whole) {
  ASSERT_LE(part.size(), whole.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    ASSERT_TRUE(samples::same(part[i], whole[i])) << "entry " << i;
  }
}

std::size_t record_size(const Bytes& file, std::size_t at) {
  std::size_t size = 8;
  for (std::size_t i = 0; i < 4; ++i) size += static_cast<std::size_t>(file[at + i]) << 8 * i;
  return size;
}

TEST(Journal, RoundTripIsExact) {
  std::mt19937_64 random(21);
  for (const int ticks : {0, 1, 63, 64, 65, 500}) {
    const auto entries = samples::random_journal(random, ticks);
    const Read read = read_all(encoded(entries));
    EXPECT_EQ(read.problem, "");
    EXPECT_EQ(read.entries.size(), entries.size());
    expect_prefix(read.entries, entries);
  }
}

TEST(Journal, ATickInWhichNothingChangesTakesTwoBytes) {
  JournalEncoder encoder;
  Bytes out;
  ASSERT_TRUE(encoder.add(JournalHeader{}, out));
  out.clear();
  for (std::uint64_t tick = 0; tick < 64; ++tick) {
    ASSERT_TRUE(encoder.add(JournalTick{tick, {}, {}}, out));
    EXPECT_EQ(out.empty(), tick < 63) << "a record is closed by its 64th tick";
  }
  EXPECT_EQ(out.size(), 8 + 3 + 64 * 2U);
}

// SF_TRUNCATED_EVERY=N: only every N-th truncation, and those between two records.
TEST(Journal, EveryTruncationGivesAllBeforeItAndSaysWhere) {
  const char* wanted = std::getenv("SF_TRUNCATED_EVERY");
  const std::size_t every = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
  std::mt19937_64 random(22);
  const auto entries = samples::random_journal(random, 150);
  const Bytes whole = encoded(entries);
  std::size_t record = 0, next = record_size(whole, 0);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    if (size == next) {
      record = next;
      next += record_size(whole, record);
    }
    if (size != record && size % every != 0) continue;
    const Read read = read_all(std::span(whole).first(size));
    expect_prefix(read.entries, entries);
    EXPECT_LT(read.entries.size(), entries.size());
    if (size == record && size > 0) {
      EXPECT_EQ(read.problem, "") << "between two records";
    } else {
      EXPECT_TRUE(read.problem.starts_with("record at byte " + std::to_string(record) + ":"))
          << read.problem;
    }
  }
}

TEST(Journal, EverySingleBitFlipStopsTheReaderThereAndKeepsAllBefore) {
  const auto entries = samples::journal();
  const Bytes whole = encoded(entries);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    std::size_t record = 0;
    while (record + record_size(whole, record) <= bit / 8) record += record_size(whole, record);
    const Read read = read_all(bytes);
    expect_prefix(read.entries, entries);
    EXPECT_TRUE(read.problem.starts_with("record at byte " + std::to_string(record) + ":"))
        << read.problem;
  }
}

TEST(Journal, TheTailTellsHowTheMatchStoodFromWhateverByteItBegins) {
  const Bytes whole = encoded(samples::journal());
  const auto [standing, end] = read_journal_tail(whole);
  ASSERT_TRUE(standing && end);
  EXPECT_EQ(standing->score, (std::array<std::uint8_t, 2>{5, 3}));
  EXPECT_EQ(end->ticks, 3u);
  const JournalTail cut = read_journal_tail(std::span(whole).first(whole.size() - 1));
  ASSERT_TRUE(cut.standing) << "a recording that was cut off tells it too";
  EXPECT_FALSE(cut.end);
  for (std::size_t from = 0; from <= whole.size(); ++from) {
    const JournalTail part = read_journal_tail(std::span(whole).subspan(from));
    if (part.standing) {
      EXPECT_EQ(*part.standing, *standing) << from;
    }
  }
  EXPECT_FALSE(read_journal_tail({}).standing);
}

TEST(Journal, AReaderGoesOnWhenItsFileHasGrown) {
  std::mt19937_64 random(24);
  const auto entries = samples::random_journal(random, 300);
  const Bytes whole = encoded(entries);
  for (std::size_t size = 1; size < whole.size(); size += 37) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    JournalReader reader(part);
    std::size_t read = 0;
    while (const auto entry = reader.next()) {
      ASSERT_TRUE(samples::same(*entry, entries[read++]));
      if (read % 7 == 0) reader = reader.over(whole);  // also within a record of ticks
      if (read % 7 == 3) break;
    }
    reader = reader.over(whole);
    while (const auto entry = reader.next()) ASSERT_TRUE(samples::same(*entry, entries[read++]));
    ASSERT_EQ(read, entries.size()) << size << reader.problem();
  }
}

TEST(Journal, RecordsOutOfOrderAreRefused) {
  const Bytes whole = encoded(samples::journal());
  const std::size_t header = record_size(whole, 0), ticks = record_size(whole, header);
  const auto piece = [&](std::size_t from, std::size_t size) {
    return std::span(whole).subspan(from, size);
  };
  const auto joined = [](std::initializer_list<std::span<const std::byte>> pieces) {
    Bytes bytes;
    for (const auto p : pieces) bytes.insert(bytes.end(), p.begin(), p.end());
    return bytes;
  };
  const auto head = piece(0, header), tick = piece(header, ticks);
  const auto rest = piece(header + ticks, whole.size() - header - ticks);
  EXPECT_NE(read_all(joined({tick, head})).problem.find("without a header"), std::string::npos);
  EXPECT_NE(read_all(joined({head, head})).problem.find("second header"), std::string::npos);
  EXPECT_NE(read_all(joined({head, tick, tick})).problem.find("tick 3 is the next"),
            std::string::npos);
  EXPECT_NE(read_all(joined({head, rest})).problem.find("says tick 3 after 0 ticks"),
            std::string::npos);
  EXPECT_NE(read_all(joined({whole, tick})).problem.find("after the end"), std::string::npos);
}

TEST(Journal, AnEmptyFileAndAForeignFileAreSaidSo) {
  EXPECT_NE(read_all({}).problem.find("empty"), std::string::npos);
  const std::string text = "This is no recording but a page of text that happens to be here.";
  EXPECT_NE(read_all(std::as_bytes(std::span(text))).problem.find("cannot be"), std::string::npos);
}

TEST(Journal, AHugeLengthIsRefusedWithoutReadingOn) {
  Bytes bytes(64, std::byte{0xFF});
  EXPECT_NE(read_all(bytes).problem.find("4294967295"), std::string::npos);
}

TEST(Journal, AFileOfAnotherReleaseIsToldByItsFormat) {
  samples::Bytes file = samples::encoded({JournalHeader{}});
  file[8 + 5] = std::byte{1};  // the version, after the record's head, kind and magic
  const std::uint32_t crc = crc32(std::span(file).subspan(8));
  for (std::size_t i = 0; i < 4; ++i) file[4 + i] = static_cast<std::byte>(crc >> 8 * i);
  JournalReader reader(file);
  EXPECT_FALSE(reader.next().has_value());
  EXPECT_EQ(reader.other_version(), 1U);
  EXPECT_EQ(reader.problem(), "record at byte 0: recorded by another release");
}

TEST(Journal, TheEncoderRefusesWhatTheReaderWould) {
  JournalEncoder encoder;
  Bytes out;
  EXPECT_FALSE(encoder.add(JournalTick{}, out)) << "no header";
  EXPECT_FALSE(encoder.add(JournalHeader{1}, out)) << "version";
  EXPECT_FALSE(encoder.add(JournalHeader{2, 7}, out)) << "layout";
  EXPECT_TRUE(out.empty());
  EXPECT_TRUE(encoder.add(JournalHeader{}, out));
  EXPECT_FALSE(encoder.add(JournalHeader{}, out)) << "a second header";
  EXPECT_FALSE(encoder.add(JournalTick{1, {}, {}}, out)) << "not the next";
  JournalTick tick;
  tick.commands.resize(65);
  EXPECT_FALSE(encoder.add(tick, out)) << "too many commands";
  tick.commands = {{10, 0, 0}};
  EXPECT_FALSE(encoder.add(tick, out)) << "an unknown command";
  tick.commands = {{9, 0, 0, 0, {.goals = 100}}};
  EXPECT_FALSE(encoder.add(tick, out)) << "more goals than a set has";
  tick.commands = {{3, 0, 0, 0, {.goals = 1}}};
  EXPECT_FALSE(encoder.add(tick, out)) << "a setup that is none";
  tick.commands.clear();
  tick.rods[0].angle_urad = kJournalAngleLimit + 1;
  EXPECT_FALSE(encoder.add(tick, out)) << "an angle out of range";
  EXPECT_FALSE(encoder.add(JournalHash{1, 0}, out)) << "of ticks to come";
  EXPECT_FALSE(encoder.add(JournalKeyframe{0, Bytes(kMaxKeyframe + 1)}, out)) << "too large";
  const std::size_t before = out.size();
  EXPECT_TRUE(encoder.add(JournalEnd{0, 1}, out));
  EXPECT_GT(out.size(), before);
  EXPECT_FALSE(encoder.add(JournalTick{}, out)) << "after the end";
  EXPECT_EQ(read_all(out).problem, "");
}

TEST(Journal, TheLargestKeyframeAndTheExtremeRodsPass) {
  JournalTick low, high;
  low.rods.fill({std::numeric_limits<std::int32_t>::min(), -kJournalAngleLimit,
                 std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min(),
                 true});
  high.rods.fill({std::numeric_limits<std::int32_t>::max(), kJournalAngleLimit,
                  std::numeric_limits<std::int32_t>::max(),
                  std::numeric_limits<std::int32_t>::max(), false});
  low.commands.assign(kMaxJournalCommands, {8, 1, 255, ~std::uint64_t{0}});
  high.commands = low.commands;
  high.tick = 1;
  const std::vector<JournalEntry> entries{JournalHeader{}, low, high,
                                          JournalKeyframe{2, Bytes(kMaxKeyframe, std::byte{7})}};
  const Read read = read_all(encoded(entries));
  EXPECT_EQ(read.problem, "");
  EXPECT_EQ(read.entries.size(), entries.size());
  expect_prefix(read.entries, entries);
}

TEST(JournalGrid, NearestPointOfTheGridWithinHalfAUnit) {
  std::mt19937_64 random(23);
  for (int i = 0; i < 10'000; ++i) {
    const auto uniform = [&](double limit) {
      return limit * (static_cast<double>(random() >> 11) * 0x1p-52 - 1.0);
    };
    const RodTargetValues v{uniform(0.5), uniform(1e4), uniform(60), uniform(500), true};
    const JournalRod rod = quantise_rod(v);
    const RodTargetValues back = dequantise_rod(rod);
    EXPECT_NEAR(back.slide, v.slide, 0.5001e-7);
    EXPECT_NEAR(back.angle, v.angle, 0.5001e-6);
    EXPECT_NEAR(back.slide_rate, v.slide_rate, 0.5001e-6);
    EXPECT_NEAR(back.angle_rate, v.angle_rate, 0.5001e-3);
    EXPECT_EQ(quantise_rod(back), rod) << "a value on the grid stays";
  }
}

TEST(JournalGrid, SaturatesAndTheEndsStay) {
  const JournalRod high = quantise_rod({1e300, 1e300, 1e300, 1e300, true});
  EXPECT_EQ(high.slide_100nm, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(high.angle_urad, kJournalAngleLimit);
  EXPECT_TRUE(high.live);
  EXPECT_EQ(quantise_rod(dequantise_rod(high)), high);
  const JournalRod low = quantise_rod({-1e300, -1e300, -1e300, -1e300, false});
  EXPECT_EQ(low.slide_100nm, -std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(low.angle_urad, -kJournalAngleLimit);
  EXPECT_EQ(quantise_rod(dequantise_rod(low)), low);
}

TEST(JournalGrid, ARodThatIsNotFiniteIsNotLive) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(quantise_rod({nan, 1, 1, 1, true}), JournalRod{});
  EXPECT_EQ(quantise_rod({1, inf, 1, 1, true}), JournalRod{});
  EXPECT_EQ(quantise_rod({1, 1, -inf, 1, true}), JournalRod{});
  EXPECT_EQ(quantise_rod({1, 1, 1, nan, true}), JournalRod{});
}

}  // namespace
}  // namespace wire::test
