// Scenes of many bodies end in the same bits on every machine: g++, clang++, WebAssembly. A change
// of a hash is a change of results and belongs in the changelog.
#include <gtest/gtest.h>

#include "scenes/catalogue.h"
#include "scenes/scene_world.h"

namespace scenes {
namespace {

std::uint64_t hash_after(Scene scene, int steps, double rate, const vp::WorldDesc& settings = {}) {
  auto world = SceneWorld::create(std::move(scene), settings);
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
  EXPECT_EQ(hash_after(towers(8, 14, 10), 30, 60.0), 18081440511936509811u);
}
TEST(GoldenScenes, APileOfBoxesSpheresAndCapsules) {
  EXPECT_EQ(hash_after(pile(120, Pour::mixed), 420, 240.0), 9890082741831788579u);
}
// In 16 regions; bodies move from region to region.
TEST(GoldenScenes, APileInRegions) {
  vp::WorldDesc settings;
  settings.region_bodies = 8;
  EXPECT_EQ(hash_after(pile(120, Pour::mixed), 420, 240.0, settings), 15328494430203290710u);
}
TEST(GoldenScenes, AWallThatIsHit) {
  EXPECT_EQ(hash_after(wall(10), 1500, 1000.0), 3577759049597656173u);
}
TEST(GoldenScenes, AHouseOfCards) {
  EXPECT_EQ(hash_after(card_house(3), 240, 240.0), 6795974188755911222u);
}
TEST(GoldenScenes, Dominoes) {
  EXPECT_EQ(hash_after(dominoes(60), 480, 240.0), 8173811389129401892u);
}
TEST(GoldenScenes, Ragdolls) {
  EXPECT_EQ(hash_after(ragdolls(2, 2, 1), 360, 240.0), 12226943192352013574u);
}
TEST(GoldenScenes, AChainUnderLoad) {
  EXPECT_EQ(hash_after(chain(50, 0.5), 500, 1000.0), 9258684393084492105u);
}
TEST(GoldenScenes, ABridgeUnderCrates) {
  EXPECT_EQ(hash_after(bridge(30, 6), 480, 240.0), 6079558368705941191u);
}

}  // namespace
}  // namespace scenes
