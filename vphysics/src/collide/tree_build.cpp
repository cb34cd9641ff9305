// Builds a bounding tree top down: each node's items are divided in two until there are eight
// parts, the largest part first; a part that fits into one node is not divided further.
//
// Quick: the items are sorted by Morton codes of their centres (the bits of x, y and z
// interleaved), and divided at the highest bit that is not the same for all. The grid of the codes
// spans four times the middle half of a sample, so that one remote box does not make it coarse.
// Items of one cell are divided at the middle of their centres.
//
// Careful: uses the planes between kBins equal bins of the centres, along the axis of their largest
// extent, and takes the one with the minimum of (area left * count left + area right * count
// right). Source: Wald 2007, section 3.
#include <algorithm>
#include <array>
#include <bit>

#include "collide/bounding_tree.h"
#include "collide/pair_set.h"

namespace vp::collide {
namespace {

constexpr int kBins = 16;
constexpr int kCodeBits = 12;         // per axis
constexpr std::size_t kSample = 128;  // centres that determine the grid
// Below this depth the items are divided at the median, which ends within as many levels as the
// number of items has bits. Only an adversarial scene reaches it.
constexpr unsigned kBinnedDepth = 24;

// The lowest `kCodeBits` bits of x with two zeros before each.
std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t b = x;
  b = (b | (b << 16)) & 0x0000ff0000ffu;
  b = (b | (b << 8)) & 0x00f00f00f00fu;
  b = (b | (b << 4)) & 0x0c30c30c30c3u;
  return (b | (b << 2)) & 0x249249249249u;
}

Lanes4 doubled_centre(const TreeItem& i) {
  return i.bounds.lower + i.bounds.upper;
}

int widest(const FloatBounds& b) {
  const Lanes4 d = b.upper - b.lower;
  const int axis = d[1] > d[0] ? 1 : 0;
  return d[2] > d[axis] ? 2 : axis;
}

FloatBounds bounds_of_centres(std::span<const TreeItem> items) {
  FloatBounds b;
  for (const TreeItem& i : items) {
    const Lanes4 c = doubled_centre(i);
    b = merged(b, {c, c});
  }
  return b;
}

std::size_t median_cut(std::span<TreeItem> items, int axis) {
  const auto centre = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
  std::nth_element(items.begin(), centre, items.end(), [&](const TreeItem& a, const TreeItem& b) {
    const float ca = doubled_centre(a)[axis], cb = doubled_centre(b)[axis];
    return ca < cb || (ca == cb && a.item < b.item);
  });
  return items.size() / 2;
}

struct Bin {
  FloatBounds bounds;
  float count = 0.0f;

  float cost() const { return half_area(bounds) * count; }
  void add(const Bin& b) {
    bounds = merged(bounds, b.bounds);
    count += b.count;
  }
};

// The last bin of the left side at the cheapest plane.
int cheapest_plane(const std::array<Bin, kBins>& bins) {
  std::array<float, kBins> cost_right{};
  Bin right, left;
  for (int k = kBins - 1; k > 0; --k) {
    right.add(bins[static_cast<std::size_t>(k)]);
    cost_right[static_cast<std::size_t>(k - 1)] = right.cost();
  }
  int best = 0;
  float smallest = 0.0f;
  for (int k = 0; k + 1 < kBins; ++k) {
    left.add(bins[static_cast<std::size_t>(k)]);
    const float cost = left.cost() + cost_right[static_cast<std::size_t>(k)];
    if (k == 0 || cost < smallest) {
      best = k;
      smallest = cost;
    }
  }
  return best;
}

struct Grid {
  float from[3] = {0.0f, 0.0f, 0.0f};
  float scale = 0.0f;  // cells are cubes

  explicit Grid(std::span<const TreeItem> items) {
    std::array<float, kSample> sample{};
    const std::size_t n = std::min(items.size(), kSample);
    float centre[3], widest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < n; ++k) {
        sample[k] = doubled_centre(items[k * items.size() / n])[axis];
      }
      std::sort(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(n));
      centre[axis] = sample[n / 2];
      widest = std::max(widest, sample[n - 1 - n / 4] - sample[n / 4]);
    }
    const float side = 4.0f * widest;
    for (int axis = 0; axis < 3; ++axis) from[axis] = centre[axis] - 0.5f * side;
    if (side > 0.0f) scale = static_cast<float>(1 << kCodeBits) / side;
    if (!(scale < 1e30f)) scale = 0.0f;
  }

  std::uint64_t code(const TreeItem& i) const {
    constexpr float kLast = static_cast<float>((1 << kCodeBits) - 1);
    std::uint32_t cell[3];
    const Lanes4 c = doubled_centre(i);
    for (int axis = 0; axis < 3; ++axis) {
      const float x = (c[axis] - from[axis]) * scale;
      cell[axis] = static_cast<std::uint32_t>(std::min(std::max(x, 0.0f), kLast));
    }
    return spread_bits(cell[0]) | (spread_bits(cell[1]) << 1) | (spread_bits(cell[2]) << 2);
  }
};

// For items sorted by code: the number of those whose highest differing bit is 0.
std::size_t cut_by_code(std::span<const TreeItem> items) {
  const std::uint64_t last = items.back().code;
  const std::uint64_t high = std::bit_floor(items.front().code ^ last);
  const auto is_left = [&](const TreeItem& i) { return (i.code & high) == 0; };
  return static_cast<std::size_t>(std::partition_point(items.begin(), items.end(), is_left) -
                                  items.begin());
}

// Moves the items for which is_left is true to the front and returns their number.
template <class F>
std::size_t divide(std::span<TreeItem> items, const F& is_left) {
  std::size_t left = 0, right = items.size();
  while (left < right) {
    if (is_left(items[left])) {
      ++left;
    } else {
      std::swap(items[left], items[--right]);
    }
  }
  return left;
}

// Divides the items and returns the number on the left; neither side is empty.
std::size_t cut(std::span<TreeItem> items, unsigned depth, bool quick) {
  if (quick && items.front().code != items.back().code) return cut_by_code(items);
  const FloatBounds centres = bounds_of_centres(items);
  const int axis = widest(centres);
  const float from = centres.lower[axis], width = centres.upper[axis] - from;
  const float scale = (static_cast<float>(kBins) * 0.99999f) / width;
  if (!(width > 0.0f) || !(scale < 1e30f)) return items.size() / 2;  // all at one position
  if (depth > kBinnedDepth) return median_cut(items, axis);
  if (quick) {
    const float centre = from + 0.5f * width;
    const auto is_left = [&](const TreeItem& i) { return doubled_centre(i)[axis] < centre; };
    const std::size_t left = divide(items, is_left);
    // The middle of two adjacent floats is one of them.
    return left > 0 && left < items.size() ? left : items.size() / 2;
  }
  const auto bin_of = [&](const TreeItem& i) {
    return static_cast<int>((doubled_centre(i)[axis] - from) * scale);
  };
  std::array<Bin, kBins> bins;
  for (const TreeItem& i : items) {
    Bin& bin = bins[static_cast<std::size_t>(bin_of(i))];
    bin.bounds = merged(bin.bounds, i.bounds);
    bin.count += 1.0f;
  }
  // The lowest and the highest centre are in the first and the last bin, so neither side is empty.
  const int plane = cheapest_plane(bins);
  return divide(items, [&](const TreeItem& i) { return bin_of(i) <= plane; });
}

}  // namespace

FloatBounds BoundingTree::build_node(std::span<TreeItem> items, std::uint32_t node, unsigned depth,
                                     Effort effort) {
  std::array<std::span<TreeItem>, 8> parts;
  std::size_t count = 1;
  parts[0] = items;
  const auto smaller = [](const std::span<TreeItem>& a, const std::span<TreeItem>& b) {
    return a.size() < b.size();
  };
  const std::size_t one_node = items.size() <= 8 ? 1 : 8;
  while (count < 8) {
    const auto end = parts.begin() + static_cast<std::ptrdiff_t>(count);
    std::span<TreeItem>& largest = *std::max_element(parts.begin(), end, smaller);
    if (largest.size() <= one_node) break;
    const std::size_t left = items.size() <= 8 ? 1 : cut(largest, depth, effort == Effort::quick);
    parts[count++] = largest.subspan(left);
    largest = largest.first(left);
  }
  FloatBounds all;
  for (std::size_t i = 0; i < count; ++i) {
    const auto slot = 8 * node + static_cast<std::uint32_t>(i);
    const std::span<TreeItem> part = parts[i];
    FloatBounds bounds = part[0].bounds;
    if (part.size() == 1) {
      set_child(slot, kLeaf | part[0].item, bounds);
    } else {
      const std::uint32_t made = new_node(slot);
      bounds = build_node(part, made, depth + 1, effort);
      set_child(slot, made, bounds);
    }
    all = merged(all, bounds);
  }
  return all;
}

std::span<TreeItem> BoundingTree::sort_by_code(std::span<TreeItem> items) {
  const Grid grid(items);
  // One word to sort: the code above the item's index.
  constexpr int kIndexBits = 64 - 3 * kCodeBits;
  keys_.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    keys_[i] = (grid.code(items[i]) << kIndexBits) | i;
  }
  sort_keys(keys_, key_scratch_, kIndexBits);
  sorted_.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    sorted_[i] = items[keys_[i] & ((std::uint64_t{1} << kIndexBits) - 1)];
    sorted_[i].code = keys_[i] >> kIndexBits;
  }
  return sorted_;
}

void BoundingTree::build(std::span<TreeItem> items, Effort effort) {
  clear();
  size_ = items.size();
  if (items.empty()) return;
  std::uint32_t highest = 0;
  for (const TreeItem& i : items) highest = std::max(highest, i.item);
  if (highest >= slot_of_.size()) slot_of_.resize(highest + 1, kNone);
  if (effort == Effort::quick) items = sort_by_code(items);
  build_node(items, new_node(kNone), 1, effort);
}

}  // namespace vp::collide
