#include "profile/toml_text.h"

#include <cstddef>
#include <cstdint>

namespace profile {
namespace {

constexpr std::uint32_t kFirst = 0x80, kLast = 0xFEFF, kMoved = 0xF0000;

struct Letter {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: not UTF-8, or end of the text
};

// The UTF-8 letter (RFC 3629) that begins here.
Letter letter_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) {
    return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u;
  };
  const std::uint32_t lead = byte(0);
  const std::size_t bytes = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (lead < 0x80) return {lead, at < text.size() ? bytes : 0};
  if (lead < 0xC2 || lead > 0xF4) return {};
  std::uint32_t code = lead & (0x7Fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0u) != 0x80u) return {};
    code = code << 6 | (byte(k) & 0x3Fu);
  }
  constexpr std::uint32_t kMin[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (code < kMin[bytes] || surrogate) return {};
  return {code, bytes};
}

void append(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  const auto more = [&](int shift) { put(0x80 | (code >> shift & 0x3F)); };
  if (code < 0x800) {
    put(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    more(6);
  } else {
    put(0xF0 | code >> 18);
    more(12);
    more(6);
  }
  more(0);
}

// Moves the letters first..last by this distance. Invalid UTF-8 stays unchanged; toml++ rejects it.
std::string with_moved(std::string_view text, std::uint32_t first, std::uint32_t last,
                       std::uint32_t by) {
  std::string moved;
  moved.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Letter letter = letter_at(text, at);
    const std::size_t bytes = letter.bytes == 0 ? 1 : letter.bytes;
    if (letter.code >= first && letter.code <= last) {
      append(moved, letter.code + by);
    } else {
      moved += text.substr(at, bytes);
    }
    at += bytes;
  }
  return moved;
}

// Each dot of a key (a.b.c) opens a nested table, which toml++ follows by recursion: 20000 levels
// overflow a stack of 8 MiB. Numbers, strings and comments do not need that many either.
constexpr std::size_t kMaxDots = 2000;

// The line in which the number of dots exceeds kMaxDots; 0: none. A row of dots counts as one: a
// key has no adjacent dots.
toml::source_index line_with_too_many_dots(std::string_view text) {
  std::size_t dots = 0;
  toml::source_index line = 1;
  char before = 0;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (c == '.' && before != '.' && ++dots > kMaxDots) return line;
    before = c;
  }
  return 0;
}

}  // namespace

toml::parse_result parse_toml(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (const auto line = line_with_too_many_dots(text); line != 0) {
    return toml::parse_result(
        toml::parse_error("more than 2000 dots", toml::source_region{{line, 1}, {line, 1}, {}}));
  }
  return toml::parse(with_moved(text, kFirst, kLast, kMoved));
}

std::string as_written(std::string_view parsed) {
  return with_moved(parsed, kMoved + kFirst, kMoved + kLast, 0u - kMoved);
}

}  // namespace profile
