// Conversion of computer players from and to text.
#include <algorithm>
#include <charconv>
#include <utility>

#include "foosball/computer_player.h"
#include "random.h"

namespace foosball {
namespace {

using Kind = PlayerSpec::Kind;

constexpr std::array<const char*, kPlayStyles> kStyleNames{"wall", "shooter", "passer", "gambler"};

constexpr std::string_view kClassic = "classic";

auto unknown(std::string_view text) {
  std::string message = "\"";
  message.append(text.substr(0, 40));
  message.append(
      "\" is no computer player: use a level 1 to 5, with a style if you like (wall, shooter, "
      "passer, gambler), as in 3:shooter; or the "
      "reference classic:0.9; a skill is a number from 0 to 1.");
  return tl::unexpected(vp::Error{vp::Errc::invalid_argument, std::move(message)});
}

// Digits with at most one point; no sign, exponent, space or locale.
bool read_skill(std::string_view text, double& skill) {
  double value = 0.0, unit = 1.0;
  bool point = false, digits = false;
  for (const char c : text) {
    if (c == '.' && !point) {
      point = true;
    } else if (c >= '0' && c <= '9') {
      digits = true;
      if (point) unit *= 10.0;
      value = 10.0 * value + (c - '0');
    } else {
      return false;
    }
  }
  skill = value / unit;
  return digits && text.size() <= 12 && skill <= 1.0;
}

}  // namespace

const char* name_of(PlayStyle style) {
  return kStyleNames.at(static_cast<std::size_t>(style));
}

PlayStyle style_of_level(int level) {
  constexpr std::array<PlayStyle, kLevels> kStyles{PlayStyle::shooter, PlayStyle::wall,
                                                   PlayStyle::passer, PlayStyle::passer,
                                                   PlayStyle::gambler};
  return kStyles.at(static_cast<std::size_t>(level - 1));
}

PlayerSpec challenge_opponent(std::uint64_t challenge) {
  Random random(challenge ^ 0x6f70706f6e656e74u);  // "opponent": unlike the match's sequence
  const int level = 1 + random.below(kLevels);
  return {.level = level, .style = static_cast<PlayStyle>(random.below(kPlayStyles))};
}

vp::Expected<PlayerSpec> parse_player(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const bool has_detail = colon != std::string_view::npos;
  const std::string_view detail = has_detail ? text.substr(colon + 1) : std::string_view{};
  PlayerSpec spec;
  if (name == kClassic) {
    spec.kind = Kind::classic;
    if (has_detail && !read_skill(detail, spec.skill)) return unknown(text);
    return spec;
  }
  if (name.size() != 1 || name[0] < '1' || name[0] > '0' + kLevels) return unknown(text);
  spec.level = name[0] - '0';
  spec.style = style_of_level(spec.level);
  if (!has_detail) return spec;
  const auto* style = std::find(kStyleNames.begin(), kStyleNames.end(), detail);
  if (style == kStyleNames.end()) return unknown(text);
  spec.style = static_cast<PlayStyle>(style - kStyleNames.begin());
  return spec;
}

std::string to_text(const PlayerSpec& spec) {
  if (spec.kind == Kind::level) {
    std::string text = std::to_string(spec.level);
    if (spec.style != style_of_level(spec.level)) text.append(":").append(name_of(spec.style));
    return text;
  }
  char skill[32];
  const auto end = std::to_chars(skill, skill + sizeof skill, spec.skill).ptr;
  return std::string(kClassic).append(":").append(skill, end);
}

}  // namespace foosball
