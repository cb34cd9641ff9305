// The tree of AABBs against brute force.
#include "collide/bounding_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "random.h"

namespace vp::test {
namespace {

using collide::BoundingTree;
using collide::FloatBounds;
using collide::TreeItem;
using Effort = BoundingTree::Effort;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

FloatBounds box_at(const Vec3& centre, const Vec3& half) {
  return collide::rounded_outward({centre - half, centre + half});
}
FloatBounds random_box(Random& random, double world, double size) {
  const Vec3 centre = random.in_cube(world);
  const double x = random.uniform(0, size), y = random.uniform(0, size),
               z = random.uniform(0, size);
  return box_at(centre, {x, y, z});
}

// The expected items of a tree.
using Truth = std::map<std::uint32_t, FloatBounds>;

std::vector<TreeItem> items_of(const Truth& truth) {
  std::vector<TreeItem> items;
  for (const auto& [item, bounds] : truth) items.push_back({bounds, item});
  return items;
}
std::vector<std::uint32_t> overlapping(const BoundingTree& tree, const FloatBounds& box) {
  std::vector<std::uint32_t> found;
  tree.overlapping(box, [&](std::uint32_t item) { found.push_back(item); });
  std::sort(found.begin(), found.end());
  return found;
}
std::vector<std::uint32_t> overlapping(const Truth& truth, const FloatBounds& box) {
  std::vector<std::uint32_t> found;
  for (const auto& [item, bounds] : truth) {
    if (overlap(bounds, box)) found.push_back(item);
  }
  return found;
}
Pairs pairs(const BoundingTree& tree) {
  Pairs found;
  tree.overlapping_pairs([&](std::uint32_t i, std::uint32_t j) {
    found.emplace_back(std::min(i, j), std::max(i, j));
  });
  std::sort(found.begin(), found.end());
  return found;
}
Pairs pairs(const Truth& truth) {
  Pairs found;
  for (auto a = truth.begin(); a != truth.end(); ++a) {
    for (auto b = std::next(a); b != truth.end(); ++b) {
      if (overlap(a->second, b->second)) found.emplace_back(a->first, b->first);
    }
  }
  return found;
}

TEST(FloatBounds, AreNeverSmallerThanWhatTheyWereMadeOfAndHardlyLarger) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double scale = std::pow(10.0, random.uniform(-45, 14));
    const double x = random.uniform(-1, 1) * scale;
    const double low = collide::rounded_down(x), high = collide::rounded_up(x);
    ASSERT_LE(low, x);
    ASSERT_GE(high, x);
    ASSERT_LE(high - low, std::fabs(x) * 0x1p-22 + 3e-37) << x;
  }
  for (const double x : {0.0, -0.0, 1e-300, -1e-300, 1.0, -1.0, 16777217.0}) {
    EXPECT_LE(collide::rounded_down(x), x);
    EXPECT_GE(collide::rounded_up(x), x);
  }
  EXPECT_LE(collide::rounded_down(-1e300), -1e14);  // effectively unbounded, and not NaN
  EXPECT_GE(collide::rounded_up(1e300), 1e14);
}

TEST(BoundingTree, FindsWhatABruteForceSearchFinds) {
  for (const Effort effort : {Effort::quick, Effort::careful}) {
    for (const std::uint32_t n : {0u, 1u, 2u, 7u, 8u, 9u, 17u, 64u, 65u, 700u}) {
      Random random(n + 2);
      Truth truth;
      for (std::uint32_t i = 0; i < n; ++i) truth[3 * i] = random_box(random, 10.0, 1.0);
      std::vector<TreeItem> items = items_of(truth);
      BoundingTree tree;
      tree.build(items, effort);
      ASSERT_EQ(tree.size(), n);
      for (int k = 0; k < 50; ++k) {
        const FloatBounds box = random_box(random, 10.0, 3.0);
        ASSERT_EQ(overlapping(tree, box), overlapping(truth, box));
      }
      ASSERT_EQ(pairs(tree), pairs(truth));
    }
  }
}

TEST(BoundingTree, KeepsFindingAfterTenThousandInsertionsRemovalsAndMoves) {
  Random random(3);
  BoundingTree tree;
  Truth truth;
  long rebuilds = 0;
  const auto rebuild = [&] {
    std::vector<TreeItem> items = items_of(truth);
    tree.build(items);
    ++rebuilds;
  };
  for (int k = 0; k < 10000; ++k) {
    const auto item = static_cast<std::uint32_t>(random.word() % 300);
    const FloatBounds box = random_box(random, random.word() % 2 ? 10.0 : 100.0, 1.5);
    const bool there = truth.count(item) > 0;
    ASSERT_EQ(tree.contains(item), there);
    if (there && random.word() % 3 == 0) {
      tree.remove(item);
      truth.erase(item);
    } else {
      truth[item] = box;
      if (!(there ? tree.move(item, box) : tree.insert(item, box))) rebuild();
      ASSERT_TRUE(tree.bounds_of(item) == box);
    }
    ASSERT_EQ(tree.size(), truth.size());
    if (k % 10 == 0) {
      const FloatBounds query = random_box(random, 20.0, 5.0);
      ASSERT_EQ(overlapping(tree, query), overlapping(truth, query));
      FloatBounds all;
      for (const auto& [i, b] : truth) all = merged(all, b);
      ASSERT_TRUE(tree.bounds() == all);
    }
    if (k % 200 == 0) {
      ASSERT_EQ(pairs(tree), pairs(truth));
    }
  }
  EXPECT_EQ(rebuilds, 0);
}

TEST(BoundingTree, PairsOfTwoTreesAreThoseOfBruteForce) {
  Random random(4);
  for (const std::uint32_t n : {1u, 40u, 500u}) {
    Truth a, b;
    for (std::uint32_t i = 0; i < n; ++i) a[i] = random_box(random, 5.0, 1.0);
    for (std::uint32_t i = 0; i < 100; ++i) b[i] = random_box(random, 6.0, 3.0);
    std::vector<TreeItem> items_a = items_of(a), items_b = items_of(b);
    BoundingTree tree_a, tree_b;
    tree_a.build(items_a);
    tree_b.build(items_b);
    Pairs found, truth;
    tree_a.overlapping_pairs(tree_b,
                             [&](std::uint32_t i, std::uint32_t j) { found.emplace_back(i, j); });
    std::sort(found.begin(), found.end());
    for (const auto& [i, bounds] : a) {
      for (const auto& [j, other] : b) {
        if (overlap(bounds, other)) truth.emplace_back(i, j);
      }
    }
    EXPECT_EQ(found, truth);
    EXPECT_GT(truth.size(), n / 2);
  }
}

// Degenerate boxes: identical, coplanar, points, and sizes that grow like powers of two.
TEST(BoundingTree, TakesDegenerateBounds) {
  const auto identical = [](std::uint32_t) { return box_at({1, 2, 3}, {1, 1, 1}); };
  const auto points = [](std::uint32_t i) {
    return box_at({static_cast<double>(i % 10), 0, 0}, {0, 0, 0});
  };
  const auto doubling = [](std::uint32_t i) {
    const double size = std::pow(2.0, static_cast<double>(i % 60) - 20.0);
    return box_at({size, 0, 0}, {0.1 * size, 0.1 * size, 0.1 * size});
  };
  const auto one_far = [](std::uint32_t i) {
    return box_at({i == 0 ? 1e9 : static_cast<double>(i), 0, 0}, {0.6, 0.6, 0.6});
  };
  for (const Effort effort : {Effort::quick, Effort::careful}) {
    for (int kind = 0; kind < 4; ++kind) {
      Truth truth;
      for (std::uint32_t i = 0; i < 600; ++i) {
        truth[i] = kind == 0   ? identical(i)
                   : kind == 1 ? points(i)
                   : kind == 2 ? doubling(i)
                               : one_far(i);
      }
      std::vector<TreeItem> items = items_of(truth);
      BoundingTree tree;
      tree.build(items, effort);
      EXPECT_EQ(pairs(tree), pairs(truth)) << kind;
      EXPECT_EQ(overlapping(tree, truth[7]), overlapping(truth, truth[7]));
    }
  }
}

TEST(BoundingTree, SaysWhenIdenticalBoxesPutInOneByOneHaveMadeItTooDeep) {
  BoundingTree tree;
  const FloatBounds box = box_at({0, 0, 0}, {1, 1, 1});
  std::uint32_t taken = 0;
  while (taken < 10000 && tree.insert(taken, box)) ++taken;
  EXPECT_LT(taken, 10000u);
  EXPECT_FALSE(tree.contains(taken));
  EXPECT_EQ(tree.size(), taken);
  EXPECT_EQ(overlapping(tree, box).size(), taken);
  EXPECT_EQ(pairs(tree).size(), std::size_t{taken} * (taken - 1) / 2);
}

struct Met {
  std::uint32_t item;
  double entry;
};

// The fraction at which the moving box first overlaps the other; negative if it never does.
double entry_of(const collide::Sweep& sweep, const FloatBounds& bounds) {
  double in = 0.0, out = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(bounds.lower[axis]) - sweep.start.upper[axis];
    const double high = static_cast<double>(bounds.upper[axis]) - sweep.start.lower[axis];
    const double d = sweep.displacement[axis];
    if (d == 0.0) {
      if (low > 0.0 || high < 0.0) return -1.0;
      continue;
    }
    in = std::max(in, std::min(low / d, high / d));
    out = std::min(out, std::max(low / d, high / d));
  }
  return in <= out ? in : -1.0;
}

void expect_cast_is_right(const Truth& truth, const BoundingTree& tree, const collide::Sweep& sweep,
                          double error) {
  collide::CastScratch scratch;
  std::vector<Met> found;
  tree.cast(sweep, 1.0, scratch, [&](std::uint32_t item, float entry) {
    found.push_back({item, static_cast<double>(entry)});
    return 1.0;
  });
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const Met& a, const Met& b) {
    return a.entry < b.entry || (a.entry == b.entry && a.item < b.item);
  }));
  std::map<std::uint32_t, double> entries;
  for (const Met& met : found) {
    ASSERT_TRUE(entries.emplace(met.item, met.entry).second);
  }
  double first = 2.0;
  for (const auto& [item, bounds] : truth) {
    const double entry = entry_of(sweep, bounds);
    if (entry >= 0.0) {
      ASSERT_EQ(entries.count(item), 1u);  // no item is missed
      ASSERT_NEAR(entries[item], entry, error);
      first = std::min(first, entry);
    } else if (entries.count(item) > 0) {  // extra items are within the error
      FloatBounds larger = bounds;
      for (int axis = 0; axis < 3; ++axis) {
        const double by = error * (1.0 + std::fabs(sweep.displacement[axis]) +
                                   std::fabs(static_cast<double>(bounds.lower[axis])));
        larger.lower[axis] -= static_cast<float>(by);
        larger.upper[axis] += static_cast<float>(by);
      }
      ASSERT_GE(entry_of(sweep, larger), 0.0);
    }
  }
  // A limit reduced at the first hit ends the search there.
  int calls = 0;
  tree.cast(sweep, 1.0, scratch, [&](std::uint32_t item, float) {
    ++calls;
    return std::max(0.0, entry_of(sweep, truth.at(item)));
  });
  if (first <= 1.0) {
    EXPECT_GE(calls, 1);
    int not_later = 0;
    for (const Met& met : found) not_later += met.entry <= first + error ? 1 : 0;
    EXPECT_LE(calls, not_later);
  }
}

TEST(BoundingTree, CastsMeetInOrderOfEntryWhatBruteForceMeets) {
  Random random(5);
  Truth truth;
  for (std::uint32_t i = 0; i < 500; ++i) truth[i] = random_box(random, 10.0, 0.7);
  std::vector<TreeItem> items = items_of(truth);
  BoundingTree tree;
  tree.build(items);
  for (int k = 0; k < 400; ++k) {
    const Vec3 from = random.in_cube(15.0);
    const Vec3 half = k % 2 ? Vec3{} : Vec3{0.3, 0.2, 0.1};
    Vec3 way = random.in_cube(20.0);
    if (k % 5 == 0) way[k % 3] = 0.0;
    if (k % 7 == 0) way[(k + 1) % 3] = -1e-40;
    if (k % 11 == 0) way = {};
    expect_cast_is_right(truth, tree, {{from - half, from + half}, way}, 1e-5);
  }
}

TEST(BoundingTree, CastsMissNothingFarFromTheOrigin) {
  Random random(6);
  const Vec3 far{1e6, -2e6, 5e5};
  Truth truth;
  for (std::uint32_t i = 0; i < 200; ++i) truth[i] = box_at(far + random.in_cube(20.0), {1, 1, 1});
  std::vector<TreeItem> items = items_of(truth);
  BoundingTree tree;
  tree.build(items);
  for (int k = 0; k < 200; ++k) {
    const Vec3 from = far + random.in_cube(30.0);
    // Floats there have a spacing of an eighth of a metre, less than a hundredth of the
    // displacement.
    expect_cast_is_right(truth, tree, {{from, from}, 30.0 * random.direction()}, 0.15);
  }
}

}  // namespace
}  // namespace vp::test
