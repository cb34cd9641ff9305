// Sealed datagrams and streams, and the password exchange against the draft's test vectors.
#include "wire/seal.h"

#include <gtest/gtest.h>

#include <random>

#include "samples.h"
#include "wire/password_exchange.h"

namespace wire::test {
namespace {

using samples::Bytes;
using samples::from_hex;

SealKey key_of(unsigned first) {
  SealKey key;
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::byte>(first + i);
  return key;
}

Bytes sealed(std::uint64_t counter, const Bytes& plain, const SealKey& key = key_of(1),
             std::uint32_t id = 7) {
  Bytes out(plain.size() + kSealBytes);
  EXPECT_EQ(seal_datagram(key, id, counter, plain, out), out.size());
  return out;
}

struct Opening : testing::Test {
  SealVerdict open(const Bytes& datagram) { return opener.open(datagram, plain, size); }
  DatagramOpener opener{key_of(1), 7};
  Bytes plain = Bytes(1400);
  std::size_t size = 0;
  const Bytes text = from_hex("00112233445566778899");
};

TEST_F(Opening, GivesBackWhatWasSealedAndHidesItOnTheWay) {
  const Bytes datagram = sealed(5, text);
  EXPECT_EQ(std::search(datagram.begin(), datagram.end(), text.begin(), text.end()),
            datagram.end());
  ASSERT_EQ(open(datagram), SealVerdict::good);
  EXPECT_EQ(Bytes(plain.begin(), plain.begin() + static_cast<long>(size)), text);
}

TEST_F(Opening, RefusesEveryTurnedBitAndEveryTruncation) {
  const Bytes datagram = sealed(5, text);
  for (std::size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
    Bytes turned = datagram;
    turned[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    EXPECT_NE(open(turned), SealVerdict::good) << bit;
  }
  for (std::size_t cut = 0; cut < datagram.size(); ++cut) {
    EXPECT_NE(open({datagram.begin(), datagram.begin() + static_cast<long>(cut)}),
              SealVerdict::good);
  }
  EXPECT_EQ(open(datagram), SealVerdict::good) << "what was refused moved nothing";
}

TEST_F(Opening, RefusesAnotherKeyAnotherIdAndWhatIsTooLong) {
  EXPECT_EQ(open(sealed(1, text, key_of(2))), SealVerdict::forged);
  EXPECT_EQ(open(sealed(1, text, key_of(1), 8)), SealVerdict::foreign);
  EXPECT_EQ(open(sealed(1, Bytes(1401))), SealVerdict::malformed);
  EXPECT_EQ(DatagramOpener().open(sealed(1, text), plain, size), SealVerdict::foreign);
}

TEST_F(Opening, TakesEachCounterOnceInAnyOrderWithinTheWindow) {
  std::mt19937_64 random(5);
  std::vector<std::uint64_t> counters(DatagramOpener::kWindow);
  for (std::size_t i = 0; i < counters.size(); ++i) counters[i] = 100 + i;
  std::shuffle(counters.begin(), counters.end(), random);
  for (const std::uint64_t counter : counters)
    ASSERT_EQ(open(sealed(counter, text)), SealVerdict::good) << counter;
  for (const std::uint64_t counter : counters)
    ASSERT_EQ(open(sealed(counter, text)), SealVerdict::replayed) << counter;
  EXPECT_EQ(open(sealed(100 + DatagramOpener::kWindow + 5, text)), SealVerdict::good);
  EXPECT_EQ(open(sealed(105, text)), SealVerdict::replayed) << "behind the window";
  EXPECT_EQ(open(sealed(100 + DatagramOpener::kWindow + 1, text)), SealVerdict::good);
}

TEST_F(Opening, AForgedFarFutureCounterMovesNothing) {
  ASSERT_EQ(open(sealed(10, text)), SealVerdict::good);
  EXPECT_EQ(open(sealed(~std::uint64_t{0}, text, key_of(9))), SealVerdict::forged);
  EXPECT_EQ(open(sealed(11, text)), SealVerdict::good);
}

// A client that returns to a multicast group gets the same key again.
TEST_F(Opening, WhatWasTakenStaysTakenWhenTheSameKeyIsUsedAgain) {
  ASSERT_EQ(open(sealed(10, text)), SealVerdict::good);
  opener.use(key_of(1), 7);
  EXPECT_EQ(open(sealed(10, text)), SealVerdict::replayed);
  EXPECT_EQ(open(sealed(9, text)), SealVerdict::good) << "in the window, and not taken yet";
  opener.use(key_of(2), 7);
  EXPECT_EQ(open(sealed(10, text, key_of(2))), SealVerdict::good) << "another key's counters";
  opener.use(key_of(2), 8);
  EXPECT_EQ(open(sealed(10, text, key_of(2), 8)), SealVerdict::good);
}

TEST(SealedStream, ComesOutOfAnyPieces) {
  StreamSealer sealer(key_of(3));
  std::mt19937_64 random(1);
  Bytes plain, stream;
  for (int i = 0; i < 50; ++i) {
    Bytes part(1 + random() % 300);
    for (std::byte& b : part) b = static_cast<std::byte>(random());
    plain.insert(plain.end(), part.begin(), part.end());
    sealer.seal(part, stream);
  }
  Bytes large(200'000, std::byte{7});
  plain.insert(plain.end(), large.begin(), large.end());
  sealer.seal(large, stream);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{77}, stream.size()}) {
    StreamOpener opener(key_of(3));
    Bytes opened;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      ASSERT_TRUE(
          opener.open(std::span(stream).subspan(at, std::min(piece, stream.size() - at)), opened));
    }
    EXPECT_EQ(opened, plain);
  }
}

TEST(SealedStream, BreaksForGoodOnATurnedBitAnOmittedOrARepeatedFrame) {
  StreamSealer sealer(key_of(3));
  Bytes first, second;
  sealer.seal(from_hex("0011"), first);
  sealer.seal(from_hex("2233"), second);
  Bytes opened;
  for (std::size_t bit = 0; bit < 8 * first.size(); ++bit) {
    Bytes turned = first;
    turned[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    StreamOpener opener(key_of(3));
    opener.open(turned, opened);
    EXPECT_TRUE(opened.empty()) << bit;
  }
  StreamOpener omitted(key_of(3)), repeated(key_of(3));
  EXPECT_FALSE(omitted.open(second, opened));
  EXPECT_FALSE(omitted.open(first, opened));
  EXPECT_TRUE(repeated.open(first, opened));
  EXPECT_FALSE(repeated.open(first, opened));
}

// The draft's appendix "Test vector for CPace using group ristretto255 and hash SHA-512".
TEST(PasswordExchange, IsCPaceAsTheDraftsVectorsHaveIt) {
  const auto array = [](const std::string& hex, auto& out) {
    const Bytes bytes = from_hex(hex);
    ASSERT_EQ(bytes.size(), out.size());
    std::copy(bytes.begin(), bytes.end(), out.begin());
  };
  ExchangeSid sid;
  std::array<std::byte, 32> ya, yb;
  array("7e4b4791d6a8ef019b936c79fb7f2c57", sid);
  array("da3d23700a9e5699258aef94dc060dfda5ebb61f02a5ea77fad53f4ff0976d08", ya);
  array("d2316b454718c35362d83d69df6320f38578ed5984651435e2949762d900b80d", yb);
  const std::string channel = "\nAinitiator\nBresponder";
  using Side = PasswordExchange::Side;
  const PasswordExchange a(Side::client, "Password", channel, sid, ya);
  const PasswordExchange b(Side::server, "Password", channel, sid, yb);
  const auto text = [](const auto& bytes) { return samples::hex({bytes.begin(), bytes.end()}); };
  EXPECT_EQ(text(a.share()), "383a85dd236978f17f8c8545b50dabc52a39fcdab2cf8bc531ce040ff77ca82d");
  EXPECT_EQ(text(b.share()), "a6206309c0e8e5f579295e35997ac4300ab3fecec3c17f7b604f3e698fa1383c");
  const auto key_a = a.secret(b.share(), "ADa", "ADb"), key_b = b.secret(a.share(), "ADa", "ADb");
  ASSERT_TRUE(key_a && key_b);
  EXPECT_EQ(text(*key_a),
            "e91ccb2c0f5e0d0993a33956e3be59754f3f2b07db57631f5394452ea2e7b435"
            "4674eb1f5686c078462bf83bec72e8743df440108e638f3526d9b90e85be096f");
  EXPECT_EQ(*key_a, *key_b);

  // The draft's invalid shares: not a group element, and the neutral element.
  ExchangeShare invalid;
  array("2b3c6b8c4f3800e7aef6864025b4ed79bd599117e427c41bd47d93d654b4a51c", invalid);
  EXPECT_FALSE(a.secret(invalid));
  EXPECT_FALSE(a.secret(ExchangeShare{}));
}

TEST(PasswordExchange, GivesOneKeyForOnePasswordAndChannelAndElseAnother) {
  using Side = PasswordExchange::Side;
  const ExchangeSid sid = random_sid();
  const PasswordExchange client(Side::client, "right", "player", sid);
  const auto key_with = [&](const char* password, const char* channel) {
    const PasswordExchange server(Side::server, password, channel, sid);
    const auto mine = client.secret(server.share()), theirs = server.secret(client.share());
    EXPECT_TRUE(mine && theirs);
    return *mine == *theirs;
  };
  EXPECT_TRUE(key_with("right", "player"));
  EXPECT_FALSE(key_with("wrong", "player"));
  EXPECT_FALSE(key_with("right", "host"));
  EXPECT_NE(random_sid(), random_sid());
  const StreamKeys keys = stream_keys(*client.secret(client.share()));
  EXPECT_NE(keys.to_server, keys.to_client);
}

}  // namespace
}  // namespace wire::test
