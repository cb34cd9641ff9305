// The encoded bytes of every message. If one of these tests fails, peers of the previous version no
// longer understand this one: increase the message's version, then update the constant.
#include <gtest/gtest.h>

#include <map>

#include "golden.h"
#include "samples.h"
#include "seeds.h"
#include "wire/read_file.h"

namespace wire::test {
namespace {

using samples::encoded;
using samples::from_hex;
using samples::hex;

TEST(Golden, Snapshot) {
  EXPECT_EQ(hex(encoded(samples::snapshot())), golden::kSnapshot);
  Snapshot decoded;
  ASSERT_TRUE(decode_snapshot(from_hex(golden::kSnapshot), decoded));
  EXPECT_EQ(decoded.men.size(), 2U);
  EXPECT_EQ(decoded.tick, 1'000'000U);
}

TEST(Golden, Input) {
  EXPECT_EQ(hex(encoded(samples::input())), golden::kInput);
  InputDatagram decoded;
  ASSERT_TRUE(decode_input(from_hex(golden::kInput), decoded));
  EXPECT_EQ(decoded.sequence, 4242U);
}

TEST(Golden, Control) {
  for (const auto& [name, message] : samples::control()) {
    const std::string& bytes = golden::kControl.at(name);
    EXPECT_EQ(hex(encoded(message)), bytes) << name;
    ControlReader reader;
    reader.push(from_hex(bytes));
    ControlMessage decoded;
    ASSERT_EQ(reader.next(decoded), ControlReader::Status::message) << name;
    EXPECT_TRUE(samples::same(decoded, message)) << name;
  }
}

TEST(Golden, Journal) {
  const auto entries = samples::journal();
  EXPECT_EQ(hex(encoded(entries)), golden::kJournal);
  const auto file = from_hex(golden::kJournal);
  JournalReader reader(file);
  for (const JournalEntry& entry : entries) {
    const auto decoded = reader.next();
    ASSERT_TRUE(decoded.has_value()) << reader.problem();
    EXPECT_TRUE(samples::same(*decoded, entry));
  }
  EXPECT_FALSE(reader.next().has_value());
  EXPECT_EQ(reader.problem(), "");
}

TEST(Golden, Phone) {
  const auto check = [](const auto& named, auto decoded) {
    for (const auto& [name, message] : named) {
      EXPECT_EQ(hex(encoded(message)), golden::kPhone.at(name)) << name;
      EXPECT_TRUE(decode_phone(from_hex(golden::kPhone.at(name)), decoded)) << name;
      EXPECT_TRUE(samples::same(decoded, message)) << name;
    }
  };
  check(samples::phone_requests(), PhoneRequest{});
  check(samples::phone_replies(), PhoneReply{});
}

TEST(Golden, DeviceFrame) {
  EXPECT_EQ(hex(encoded(samples::device_frame())), golden::kDeviceFrame);
  EXPECT_EQ(hex(samples::encoded_version_1(samples::device_frame())), golden::kDeviceFrameVersion1);
  EXPECT_EQ(hex(samples::encoded_cobs(samples::device_frame())), golden::kDeviceCobs);
}

TEST(FuzzCorpus, IsMadeOfTheMessagesAsTheyAreNow) {
  for (const samples::Seed& seed : samples::seeds()) {
    const auto kept =
        read_file(std::string(WIRE_FUZZ_CORPUS) + "/" + seed.target + "/" + seed.name, 1 << 20);
    EXPECT_TRUE(kept.has_value() && *kept == seed.bytes)
        << seed.target << "/" << seed.name << " is out of date. Renew it:\n"
        << "  ninja -C build/release wire_fuzz_corpus && "
           "build/release/bin/wire_fuzz_corpus wire/fuzz/corpus";
  }
}

}  // namespace
}  // namespace wire::test
