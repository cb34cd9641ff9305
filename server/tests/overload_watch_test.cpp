#include "overload_watch.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using Change = OverloadWatch::Change;

TEST(OverloadWatch, TellsOnceWhenMoreTicksAreMissedInASecondThanAreToleratedAndOnceWhenItIsOver) {
  OverloadWatch watch;
  const std::uint64_t second = OverloadWatch::kWindow;
  std::uint64_t missed = 0;
  EXPECT_EQ(watch.look(second - 1, 500), Change::none) << "the second is not over";
  EXPECT_EQ(watch.look(second, missed += OverloadWatch::kTolerated), Change::none) << "as many";
  EXPECT_EQ(watch.look(2 * second, missed += OverloadWatch::kTolerated + 1), Change::overloaded);
  EXPECT_EQ(watch.look(3 * second, missed += 200), Change::none) << "told already";
  EXPECT_EQ(watch.look(4 * second - 1, missed), Change::none);
  EXPECT_EQ(watch.look(4 * second, missed += OverloadWatch::kTolerated), Change::keeps_up_again);
  EXPECT_EQ(watch.look(5 * second, missed), Change::none);
}

}  // namespace
}  // namespace server
