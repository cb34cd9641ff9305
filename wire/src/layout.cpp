#include "layout.h"

#include <cinttypes>
#include <cmath>
#include <cstdio>

namespace wire {
namespace {

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

std::string up_to(std::uint64_t max) {
  const int bits = max == ~std::uint64_t{0} ? 64 : std::ilogb(static_cast<double>(max) + 1);
  const bool whole = bits == 64 || max == (std::uint64_t{1} << bits) - 1;
  return whole && bits > 16 ? "0..2^" + std::to_string(bits) + "-1" : "0.." + std::to_string(max);
}

std::uint64_t varint_bits(std::uint64_t max) {
  std::uint64_t groups = 1;
  for (; max >= 0x80; max >>= 7) ++groups;
  return 8 * groups;
}

}  // namespace

std::uint32_t layout_hash(const Layout& layout) {
  std::uint32_t hash = 0x811C9DC5U;
  const auto mix = [&](const std::string& text) {
    for (const char c : text + '\n') hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193U;
  };
  for (const LayoutRow& row : layout) {
    mix(row.path);
    mix(row.kind);
    mix(std::to_string(row.bits));
    mix(std::to_string(row.count));
    mix(row.range);
    mix(row.unit);
  }
  return hash;
}

std::uint64_t max_bits(const Layout& layout) {
  std::uint64_t sum = 0;
  for (const LayoutRow& row : layout) sum += row.bits * row.count;
  return sum;
}

void Lister::add(const char* name, const char* kind, std::uint64_t bits, std::string range,
                 const char* unit, const char* meaning) {
  rows_.push_back({prefix_ + name, kind, bits, count_, std::move(range), unit, meaning});
}

void Lister::constant(const Constant& f) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), f.bits > 16 ? "0x%08" PRIX64 : "%" PRIu64, f.value);
  add(f.name, "constant", static_cast<std::uint64_t>(f.bits), text.data(), "", f.meaning);
}

void Lister::layout_hash(const LayoutHash& f) {
  add(f.name, "hash", 32, "", "", f.meaning);
}

void Lister::add_integer(const Integer& f) {
  add(f.name, "integer", static_cast<std::uint64_t>(f.bits), up_to(f.max), f.unit, f.meaning);
}

void Lister::flag(const Flag& f, bool) {
  add(f.name, "flag", 1, "0, 1", "", f.meaning);
}

void Lister::add_fixed(const Fixed& f, int components) {
  const std::string range =
      number(f.low()) + ".." + number(f.high()) + " by 2^" + std::to_string(std::ilogb(f.step));
  const std::string kind = std::string(f.is_signed ? "fixed" : "unsigned fixed") +
                           (components > 1 ? " x" + std::to_string(components) : "");
  add(f.name, kind.c_str(),
      static_cast<std::uint64_t>(f.bits) * static_cast<std::uint64_t>(components), range, f.unit,
      f.meaning);
}

void Lister::wrapped(const Wrapped& f, double) {
  add(f.name, "wrapped", static_cast<std::uint64_t>(f.bits),
      "modulo 2^" + std::to_string(f.bits - 16) + " turns by 2^-16 turn", "rad", f.meaning);
}

void Lister::rotation(const Rotation& f, const std::array<float, 4>&) {
  add(f.name, "rotation", 2 + 3 * static_cast<std::uint64_t>(f.bits), "by " + number(f.step()), "",
      f.meaning);
}

void Lister::add_varint(const Varint& f) {
  add(f.name, "varint", varint_bits(f.max), up_to(f.max), f.unit, f.meaning);
}

void Lister::delta(const Delta& f, std::int64_t) {
  add(f.name, "delta", varint_bits(2 * static_cast<std::uint64_t>(f.limit)),
      "+-" + std::to_string(f.limit), f.unit, f.meaning);
}

void Lister::bytes(const Bytes& f, const std::vector<std::byte>&) {
  add(f.name, "bytes", varint_bits(f.max) + 8 * f.max, "0.." + std::to_string(f.max) + " bytes", "",
      f.meaning);
}

void Lister::text(const Text& f, const std::string&) {
  add(f.name, "text", varint_bits(f.max) + 8 * f.max + 7, "0.." + std::to_string(f.max) + " bytes",
      "", f.meaning);
}

void Lister::align() {
  add("(padding)", "padding", 7, "0", "", "to the next byte");
}

void Lister::checksum(const Checksum& f) {
  align();
  add(f.name, "checksum", 32, "", "", f.meaning);
}

void Lister::add_condition(const Group& f) {
  add(f.name, "condition", 0, "", "", f.meaning);
}

void Lister::add_array(const Group& f, std::size_t n) {
  add(f.name, "array", 0, std::to_string(n) + " elements", "", f.meaning);
}

void Lister::add_list(const List& f) {
  add(f.name, "list", static_cast<std::uint64_t>(f.bits),
      "0.." + std::to_string(f.max) + " elements", "", f.meaning);
}

}  // namespace wire
