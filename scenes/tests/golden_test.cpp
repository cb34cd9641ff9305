// Scenes of many bodies end in the same bits on every machine: g++, clang++, WebAssembly. A change
// of a hash is a change of results and belongs into the changelog.
#include <gtest/gtest.h>

#include "scenes/catalogue.h"
#include "scenes/scene_world.h"

namespace scenes {
namespace {

std::uint64_t hash_after(Scene scene, int steps, double rate) {
  auto world = SceneWorld::create(std::move(scene));
  if (!world) {
    ADD_FAILURE() << world.error().message;
    return 0;
  }
  for (int i = 0; i < steps; ++i) {
    const auto status = world->step(1.0 / rate);
    if (!status) ADD_FAILURE() << "step " << i << ": " << status.error().message;
  }
  return world->world().state_hash();
}

TEST(GoldenScenes, TowersOf1120Boxes) {
  EXPECT_EQ(hash_after(towers(8, 14, 10), 30, 60.0), 13624868886401590540u);
}
TEST(GoldenScenes, APileOfBoxesSpheresAndCapsules) {
  EXPECT_EQ(hash_after(pile(120, Pour::mixed), 420, 240.0), 16249433810458961651u);
}
TEST(GoldenScenes, AWallThatIsHit) {
  EXPECT_EQ(hash_after(wall(10), 1500, 1000.0), 6116854734050008468u);
}
TEST(GoldenScenes, AHouseOfCards) {
  EXPECT_EQ(hash_after(card_house(3), 240, 240.0), 11295703475661033643u);
}
TEST(GoldenScenes, Dominoes) {
  EXPECT_EQ(hash_after(dominoes(60), 480, 240.0), 16088562242959538401u);
}
TEST(GoldenScenes, Ragdolls) {
  EXPECT_EQ(hash_after(ragdolls(2, 2, 1), 360, 240.0), 6959675265913142676u);
}
TEST(GoldenScenes, AChainUnderLoad) {
  EXPECT_EQ(hash_after(chain(50, 0.5), 500, 1000.0), 3331215895161894638u);
}
TEST(GoldenScenes, ABridgeUnderCrates) {
  EXPECT_EQ(hash_after(bridge(30, 6), 480, 240.0), 17350939147760605157u);
}

}  // namespace
}  // namespace scenes
