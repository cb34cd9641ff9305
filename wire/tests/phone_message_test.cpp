#include "wire/phone_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "layouts.h"
#include "samples.h"
#include "wire/description.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::encoded;

template <class Check>
void for_each_phone_message(Check check) {
  for (const auto& [name, message] : samples::phone_requests()) check(name, message);
  for (const auto& [name, message] : samples::phone_replies()) check(name, message);
}

TEST(PhoneMessages, TheLongestFitTheirCapsAndAllFieldsAreOfWholeBytes) {
  for (const NamedLayout& part : phone_layouts()) {
    const bool reply = std::string(part.name) == "state" || std::string(part.name) == "notice" ||
                       std::string(part.name) == "pulse";
    EXPECT_LE((max_bits(part.layout) + 7) / 8, reply ? kMaxPhoneReply : kMaxPhoneRequest)
        << part.name;
    for (const LayoutRow& row : part.layout) {
      if (row.kind == "text") continue;
      EXPECT_EQ(row.bits % 8, 0u) << part.name << " " << row.path;
    }
  }
}

TEST(PhoneMessages, EveryTruncationAndEveryLongerOneIsRefused) {
  for_each_phone_message([](const std::string& name, const auto& message) {
    Bytes whole = encoded(message);
    auto received = message;
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_FALSE(decode_phone(std::span(whole).first(size), received)) << name << " " << size;
    EXPECT_TRUE(decode_phone(whole, received)) << name;
    whole.push_back(std::byte{0});
    EXPECT_FALSE(decode_phone(whole, received)) << name;
  });
}

TEST(PhoneMessages, WhatAnyBitFlipLeavesReadableComesBackTheSame) {
  for_each_phone_message([](const std::string& name, const auto& message) {
    const Bytes whole = encoded(message);
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      Bytes bytes = whole;
      bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
      auto once = message, twice = message;
      if (!decode_phone(bytes, once)) continue;
      EXPECT_GE(bit, 8u) << name << ": of another version";
      EXPECT_EQ(encoded(once), bytes) << name << " " << bit;
      ASSERT_TRUE(decode_phone(encoded(once), twice)) << name << " " << bit;
      EXPECT_TRUE(samples::same(once, twice)) << name << " " << bit;
    }
  });
}

TEST(PhoneMessages, NoPhoneSaysWhatIsTheServersToSay) {
  PhoneRequest request;
  for (const auto& [name, reply] : samples::phone_replies())
    EXPECT_FALSE(decode_phone(encoded(reply), request)) << name;
  PhoneReply reply;
  for (const auto& [name, asked] : samples::phone_requests())
    EXPECT_FALSE(decode_phone(encoded(asked), reply)) << name;
}

TEST(PhoneMessages, WhatIsOutOfRangeIsClampedAndWhatIsNotFiniteIsZero) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PhoneInput sent;
  sent.rods[0] = {true, nan, std::numeric_limits<double>::infinity(), nan, nan};
  sent.rods[1] = {true, 1e30F, 0.0, -1e30F, 1e30F};
  PhoneRequest received;
  ASSERT_TRUE(decode_phone(encoded(PhoneRequest(sent)), received));
  const auto& rods = std::get<PhoneInput>(received).rods;
  EXPECT_EQ(rods[0].slide, 0.0F);
  EXPECT_EQ(rods[0].angle, 0.0);
  EXPECT_NEAR(rods[1].slide, 2.0, 1e-3);
  EXPECT_NEAR(rods[1].slide_rate, -64.0, 1e-2);
}

}  // namespace
}  // namespace wire::test
