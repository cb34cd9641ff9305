#include "wire/text.h"

#include <algorithm>
#include <cstdint>

#include "wire/control.h"

namespace wire {
namespace {

constexpr std::uint32_t kInvalid = 0xFFFFFFFF;

std::size_t length_from_lead(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead < 0xE0) return 2;
  if (lead >= 0xE0 && lead < 0xF0) return 3;
  if (lead >= 0xF0 && lead < 0xF5) return 4;
  return 0;
}

// Decodes the first character of text and its length [bytes]. kInvalid has length 1 (RFC 3629:
// overlong form, surrogate, above U+10FFFF, or not UTF-8).
std::uint32_t first_character(std::string_view text, std::size_t& length) {
  const auto byte_at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  length = length_from_lead(byte_at(0));
  std::uint32_t character = kInvalid;
  if (length == 1) {
    character = byte_at(0);
  } else if (length != 0 && length <= text.size()) {
    character = byte_at(0) & (0x7FU >> length);
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte_at(i) & 0xC0) != 0x80) character = kInvalid;
      if (character != kInvalid) character = character << 6 | (byte_at(i) & 0x3FU);
    }
    constexpr std::uint32_t kMin[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = character >= 0xD800 && character < 0xE000;
    if (character < kMin[length] || surrogate || character > 0x10FFFF) character = kInvalid;
  }
  if (character == kInvalid) length = 1;
  return character;
}

bool is_control(std::uint32_t character) {
  return character < 0x20 || (character >= 0x7F && character < 0xA0);
}

struct Range {
  std::uint32_t first, last;
};

bool is_in(const auto& ranges, std::uint32_t character) {
  return std::ranges::any_of(
      ranges, [=](const Range& r) { return character >= r.first && character <= r.last; });
}

// Default_Ignorable_Code_Point of Unicode 15 (DerivedCoreProperties.txt), and U+2028, U+2029,
// U+2800.
bool is_unseen(std::uint32_t character) {
  static constexpr Range kUnseen[] = {
      {0xAD, 0xAD},       {0x34F, 0x34F},     {0x61C, 0x61C},   {0x115F, 0x1160},
      {0x17B4, 0x17B5},   {0x180B, 0x180F},   {0x200B, 0x200F}, {0x2028, 0x202E},
      {0x2060, 0x206F},   {0x2800, 0x2800},   {0x3164, 0x3164}, {0xFE00, 0xFE0F},
      {0xFEFF, 0xFEFF},   {0xFFA0, 0xFFA0},   {0xFFF0, 0xFFF8}, {0x1BCA0, 0x1BCA3},
      {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF},
  };
  return is_in(kUnseen, character);
}

// Space_Separator (Zs).
bool is_space(std::uint32_t character) {
  static constexpr Range kSpaces[] = {{0x20, 0x20},     {0xA0, 0xA0},     {0x1680, 0x1680},
                                      {0x2000, 0x200A}, {0x202F, 0x202F}, {0x205F, 0x205F},
                                      {0x3000, 0x3000}};
  return is_in(kSpaces, character);
}

}  // namespace

std::string clean_text(std::string_view text, std::size_t max_bytes) {
  std::string clean;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    const std::uint32_t character = first_character(text.substr(at), length);
    const bool shown = character != kInvalid && !is_control(character);
    const std::string_view piece = shown ? text.substr(at, length) : std::string_view("?");
    if (clean.size() + piece.size() > max_bytes) break;
    clean += piece;
  }
  return clean;
}

bool is_clean_text(std::string_view text, std::size_t max_bytes) {
  return text.size() <= max_bytes && clean_text(text, max_bytes) == text;
}

std::string clean_name(std::string_view name) {
  const std::string text = clean_text(name, kMaxName);
  std::string clean;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    const std::string_view rest = std::string_view(text).substr(at);
    const std::uint32_t character = first_character(rest, length);
    if (is_unseen(character)) continue;
    if (!is_space(character)) {
      clean += rest.substr(0, length);
    } else if (!clean.empty() && clean.back() != ' ') {
      clean += ' ';
    }
  }
  if (!clean.empty() && clean.back() == ' ') clean.pop_back();
  return clean.empty() ? "unnamed" : clean;
}

}  // namespace wire
