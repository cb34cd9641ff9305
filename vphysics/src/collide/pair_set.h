// Sets of pairs of indices, sets of indices, and sorting of pairs.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace vp::collide {

struct ProxyPair {
  std::uint32_t a, b;  // a < b
  // The linter mistakes the 0 that the compiler compares with for a pointer.
  constexpr auto operator<=>(const ProxyPair&) const = default;  // NOLINT(modernize-use-nullptr)

  constexpr std::uint64_t key() const { return (std::uint64_t{a} << 32) | b; }
  static constexpr ProxyPair of_key(std::uint64_t key) {
    return {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)};
  }
  static constexpr ProxyPair ordered(std::uint32_t i, std::uint32_t j) {
    return i < j ? ProxyPair{i, j} : ProxyPair{j, i};
  }
};

// A flat hash table of pair keys: linear probing, at most half full. Erasing shifts later entries
// back, without tombstones. No result depends on the table's order.
class PairSet {
 public:
  // Returns false if it was already present.
  bool insert(std::uint64_t key) {
    if (2 * (size_ + 1) > table_.size()) grow();
    std::size_t i = home(key);
    for (; table_[i] != kEmpty; i = next(i)) {
      if (table_[i] == key) return false;
    }
    table_[i] = key;
    ++size_;
    return true;
  }
  // Prefetches the key's entry.
  void prefetch(std::uint64_t key) const {
    if (!table_.empty()) __builtin_prefetch(&table_[home(key)]);
  }
  bool contains(std::uint64_t key) const {
    if (size_ == 0) return false;
    return table_[find(key)] == key;
  }
  // Returns false if it was not present.
  bool erase(std::uint64_t key) {
    if (size_ == 0) return false;
    std::size_t hole = find(key);
    if (table_[hole] != key) return false;
    for (std::size_t i = next(hole); table_[i] != kEmpty; i = next(i)) {
      const std::size_t mask = table_.size() - 1;
      // An entry stays only if its home is after the hole.
      if (((i - home(table_[i])) & mask) < ((i - hole) & mask)) continue;
      table_[hole] = table_[i];
      hole = i;
    }
    table_[hole] = kEmpty;
    --size_;
    return true;
  }
  void clear() {
    std::fill(table_.begin(), table_.end(), kEmpty);
    size_ = 0;
  }
  std::size_t size() const { return size_; }
  // Appends the keys in unspecified order. Reserves as much memory as the table can hold before it
  // grows.
  void append_keys(std::vector<std::uint64_t>& keys) const {
    keys.reserve(keys.size() + table_.size() / 2);
    for (const std::uint64_t key : table_) {
      if (key != kEmpty) keys.push_back(key);
    }
  }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  std::size_t next(std::size_t i) const { return (i + 1) & (table_.size() - 1); }
  // The high bits of the product with 2^64 over the golden ratio depend on all bits of the key.
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>(((key ^ (key >> 29)) * 0x9e3779b97f4a7c15u) >> shift_);
  }
  std::size_t find(std::uint64_t key) const {
    std::size_t i = home(key);
    while (table_[i] != key && table_[i] != kEmpty) i = next(i);
    return i;
  }
  void grow() {
    std::vector<std::uint64_t> old(std::max<std::size_t>(64, 2 * table_.size()), kEmpty);
    old.swap(table_);
    shift_ = 64 - std::countr_zero(table_.size());
    size_ = 0;
    for (const std::uint64_t key : old) {
      if (key != kEmpty) insert(key);
    }
  }

  std::vector<std::uint64_t> table_;  // its size is a power of two
  std::size_t size_ = 0;
  int shift_ = 0;
};

// A set of indices as bits; iteration is ascending.
class IndexSet {
 public:
  void resize(std::size_t indices) { words_.resize((indices + 63) / 64, 0); }
  void set(std::uint32_t i) { words_[i / 64] |= bit(i); }
  void reset(std::uint32_t i) { words_[i / 64] &= ~bit(i); }
  bool test(std::uint32_t i) const { return (words_[i / 64] & bit(i)) != 0; }
  void clear() { std::fill(words_.begin(), words_.end(), 0); }
  bool empty() const {
    return std::all_of(words_.begin(), words_.end(), [](std::uint64_t w) { return w == 0; });
  }
  void append_to(std::vector<std::uint32_t>& indices) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t b = words_[w]; b != 0; b &= b - 1) {
        indices.push_back(static_cast<std::uint32_t>(64 * w) +
                          static_cast<std::uint32_t>(std::countr_zero(b)));
      }
    }
  }

 private:
  static std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64); }
  std::vector<std::uint64_t> words_;
};

// Sorts in ascending order by the bits from `lowest` up. Precondition: keys that agree in these
// bits are in ascending order. LSD radix sort; skips digits that all keys share.
inline void sort_keys(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& scratch,
                      int lowest = 0) {
  if (keys.size() < 256) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  constexpr int kBits = 11;
  constexpr std::uint64_t kMask = (1u << kBits) - 1;
  scratch.resize(keys.size());
  std::uint64_t some = 0, every = ~std::uint64_t{0};
  for (const std::uint64_t k : keys) some |= k, every &= k;
  for (int shift = lowest; shift < 64; shift += kBits) {
    if ((((some ^ every) >> shift) & kMask) == 0) continue;
    std::array<std::uint32_t, kMask + 1> start{};
    for (const std::uint64_t k : keys) ++start[(k >> shift) & kMask];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) sum += std::exchange(s, sum);
    for (const std::uint64_t k : keys) scratch[start[(k >> shift) & kMask]++] = k;
    keys.swap(scratch);
  }
}

}  // namespace vp::collide
