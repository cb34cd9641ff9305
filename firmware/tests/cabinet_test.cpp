// The real .elf of each board in simavr, with eight mice on its pins.
#include "cabinet_fixture.h"

namespace firmware_sim {
namespace {

constexpr unsigned kAll = 0xFF;

class OnEachBoard : public testing::TestWithParam<Board> {};
INSTANTIATE_TEST_SUITE_P(Boards, OnEachBoard, testing::Values(Board::mega32u4, Board::mega2560),
                         [](const auto& chosen) {
                           return chosen.param == Board::mega32u4 ? "Mega32u4" : "Mega2560";
                         });

TEST_P(OnEachBoard, SetsUpAllMiceAtRate200And8CountsPerMillimetre) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  for (int rod = 0; rod < kMice; ++rod) {
    EXPECT_TRUE(cabinet.sim.mouse(rod).enabled());
    EXPECT_EQ(cabinet.sim.mouse(rod).rate(), 200);
    EXPECT_EQ(cabinet.sim.mouse(rod).counts_per_mm(), 8);
  }
}

TEST_P(OnEachBoard, EachMouseCountsExactlyAndAlone) {
  Cabinet cabinet(GetParam());
  ASSERT_TRUE(cabinet.wait_for_present(kAll));
  Moved moved;
  for (int rod = 0; rod < kMice; ++rod) {
    moved.move(cabinet.sim, rod, 320 + rod, -90 * (rod + 1));
    ASSERT_TRUE(cabinet.settle());
    cabinet.take();
    expect_counts(cabinet.last(), moved);
  }
}

}  // namespace
}  // namespace firmware_sim
