#include "characters/character_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "profile/toml_text.h"
#include "wire/read_file.h"
#include "wire/text.h"

namespace characters {
namespace {

using foosball::Character;
using foosball::CharacterField;
using foosball::Characters;
using foosball::Colour;

constexpr std::size_t kMaxBytes = 64 * 1024;

using Problem = std::optional<std::string>;  // none: success

// --- messages ------------------------------------------------------------------------------------

std::string at(std::string_view file, const toml::source_region& where, const std::string& why) {
  return fmt::format("{}:{}: {}", file, where.begin.line, why);
}

// Number of letters to insert, delete or replace (Levenshtein 1966).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[k - 1] ? 0 : 1);
      diagonal = std::exchange(row[k], std::min({row[k] + 1, row[k - 1] + 1, replaced}));
    }
  }
  return row.back();
}

// An untrusted key in a printable form: it may be long, and contain anything.
std::string shown(std::string_view key) {
  std::string text(key.substr(0, 40));
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return key.size() > 40 ? text + "..." : text;
}

std::string unknown(std::string_view key, std::span<const char* const> names,
                    const std::string& where) {
  const std::string_view short_key = key.substr(0, 40);
  const char* nearest = *std::ranges::min_element(
      names, {}, [&](const char* name) { return distance(short_key, name); });
  return fmt::format("{} has no \"{}\"; the nearest name is {}", where,
                     shown(profile::as_written(key)), nearest);
}

template <class T>
std::string range_of(const CharacterField<T>& field) {
  return fmt::format("{} to {}{}{}", field.min, field.max, *field.unit == '\0' ? "" : " ",
                     field.unit);
}

// --- values --------------------------------------------------------------------------------------

template <class Fields>
auto names_of(const Fields& fields) {
  std::array<const char*, std::tuple_size_v<Fields>> names;
  std::ranges::transform(fields, names.begin(), [](const auto& f) { return f.name; });
  return names;
}

template <class Fields, class T>
Problem take_numbers(const toml::table& table, const std::string& section, const Fields& fields,
                     std::string_view file, T& values) {
  for (const auto& [key, node] : table) {
    const auto field = std::ranges::find_if(
        fields, [&, name = key.str()](const auto& f) { return name == f.name; });
    if (field == fields.end()) {
      return at(file, key.source(), unknown(key.str(), names_of(fields), section));
    }
    const std::optional<double> value =
        node.is_number() ? node.template value<double>() : std::nullopt;
    if (!value || !foosball::in_range(*field, *value)) {
      return at(file, node.source(),
                fmt::format("{} must be a number from {}. {}", field->name, range_of(*field),
                            field->meaning));
    }
    values.*field->value = *value;
  }
  return {};
}

Problem take_text(const toml::node& node, const char* name, std::size_t min, std::size_t max,
                  std::string_view file, std::string& text) {
  const auto parsed = node.value<std::string_view>();
  const auto value = parsed ? std::optional(profile::as_written(*parsed)) : std::nullopt;
  const bool fits = value && value->size() >= min && wire::is_clean_text(*value, max);
  if (!fits) {
    return at(file, node.source(),
              fmt::format("{} must be a text of {} to {} bytes on one line; write {} = \"...\"",
                          name, min, max, name));
  }
  text = *value;
  return {};
}

// Appears on every screen, in lists and at goals: the same restrictions as for a player's name.
Problem take_name(const toml::node& node, std::string_view file, std::string& name) {
  const Problem problem = take_text(node, "name", 1, foosball::kMaxCharacterName, file, name);
  if (problem || wire::clean_name(name) == name) return problem;
  return at(file, node.source(),
            fmt::format("name must have a letter, single spaces within and nothing invisible; "
                        "write name = \"{}\"",
                        wire::clean_name(name)));
}

// "#rrggbb"
std::optional<Colour> colour_of(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  Colour colour{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string_view digits = "0123456789abcdef";
    const char c = text[i + 1];
    const std::size_t digit = digits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c + 32) : c);
    if (digit == std::string_view::npos) return std::nullopt;
    colour[i / 2] = static_cast<std::uint8_t>(16 * colour[i / 2] + digit);
  }
  return colour;
}

Problem take_colour(const toml::node& node, const char* name, std::string_view file,
                    Colour& colour) {
  const auto text = node.value<std::string_view>();
  const auto value = text ? colour_of(*text) : std::nullopt;
  if (!value) {
    return at(file, node.source(),
              fmt::format("{} must be a colour from \"#000000\" to \"#ffffff\"; write {} = "
                          "\"#c89664\"",
                          name, name));
  }
  colour = *value;
  return {};
}

template <class Enum>
Problem take_choice(const toml::node& node, const char* name, std::span<const char* const> names,
                    std::string_view file, Enum& choice) {
  const auto text = node.value<std::string_view>();
  const auto found = text ? std::ranges::find(names, *text) : names.end();
  if (found == names.end()) {
    return at(file, node.source(),
              fmt::format("{} must be one of {}; write {} = \"{}\"", name, fmt::join(names, ", "),
                          name, names[0]));
  }
  choice = static_cast<Enum>(found - names.begin());
  return {};
}

Problem take_look(const toml::table& table, std::string_view file, foosball::CharacterLook& look) {
  static constexpr std::array kNames{"skin", "accent", "headgear", "face"};
  for (const auto& [key, node] : table) {
    Problem problem;
    if (key == "skin") {
      problem = take_colour(node, "skin", file, look.skin);
    } else if (key == "accent") {
      problem = take_colour(node, "accent", file, look.accent);
    } else if (key == "headgear") {
      problem = take_choice(node, "headgear", foosball::kHeadgearNames, file, look.headgear);
    } else if (key == "face") {
      problem = take_choice(node, "face", foosball::kFaceNames, file, look.face);
    } else {
      problem = at(file, key.source(), unknown(key.str(), kNames, "[look]"));
    }
    if (problem) return problem;
  }
  return {};
}

// Reads a section of the file with `take`.
Problem take_section(const toml::node& node, const char* name, std::string_view file,
                     const std::function<Problem(const toml::table&)>& take) {
  const toml::table* table = node.as_table();
  if (table != nullptr) return take(*table);
  return at(file, node.source(),
            fmt::format("{} must be a section; write [{}] in a line of its own", name, name));
}

Problem take_all(const toml::table& file_table, std::string_view file, Character& c) {
  static constexpr std::array kNames{"name", "specialty", "body", "look", "voice"};
  for (const auto& [key, node] : file_table) {
    Problem problem;
    if (key == "name") {
      problem = take_name(node, file, c.name);
    } else if (key == "specialty") {
      problem =
          take_text(node, "specialty", 0, foosball::kMaxCharacterSpecialty, file, c.specialty);
    } else if (key == "body") {
      problem = take_section(node, "body", file, [&](const toml::table& table) {
        return take_numbers(table, "[body]", foosball::kBodyFields, file, c.body);
      });
    } else if (key == "look") {
      problem = take_section(node, "look", file,
                             [&](const toml::table& t) { return take_look(t, file, c.look); });
    } else if (key == "voice") {
      problem = take_section(node, "voice", file, [&](const toml::table& table) {
        return take_numbers(table, "[voice]", foosball::kVoiceFields, file, c.voice);
      });
    } else {
      problem = at(file, key.source(), unknown(key.str(), kNames, "a character"));
    }
    if (problem) return problem;
  }
  return {};
}

// --- folders -------------------------------------------------------------------------------------

tl::expected<std::vector<std::string>, std::string> files_of(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<std::string> files;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".toml") files.push_back(it->path().string());
    if (files.size() > static_cast<std::size_t>(foosball::kMaxCharacters)) {
      return tl::unexpected(fmt::format("{} has more than {} files *.toml; move some elsewhere",
                                        folder, foosball::kMaxCharacters));
    }
  }
  if (error) {
    return tl::unexpected(fmt::format("{} cannot be read ({}); give a folder of character files",
                                      folder, error.message()));
  }
  std::ranges::sort(files);
  return files;
}

struct Loaded {
  std::string file;
  Character character;
};

tl::expected<std::vector<Loaded>, std::string> load_all(const std::string& folder) {
  const auto files = files_of(folder);
  if (!files) return tl::unexpected(files.error());
  std::vector<Loaded> all;
  for (const std::string& file : *files) {
    auto character = load_character(file);
    if (!character) return tl::unexpected(character.error());
    for (const Loaded& other : all) {
      if (other.character.name == character->name) {
        return tl::unexpected(
            fmt::format("{}: the name \"{}\" is that of {} too; give one of them "
                        "another name",
                        file, character->name, other.file));
      }
    }
    all.push_back({file, std::move(*character)});
  }
  return all;
}

std::string toml_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

template <class Fields, class T>
std::string format_numbers(const Fields& fields, const T& values) {
  std::string text;
  for (const auto& field : fields) {
    text += fmt::format("\n# {}\n# {}\n{} = {}\n", field.meaning, range_of(field), field.name,
                        number(values.*field.value));
  }
  return text;
}

std::string hex(const Colour& colour) {
  return fmt::format("\"#{:02x}{:02x}{:02x}\"", colour[0], colour[1], colour[2]);
}

}  // namespace

tl::expected<Character, std::string> parse_character(std::string_view text, std::string_view name) {
  const toml::parse_result parsed = profile::parse_toml(text);
  if (!parsed) {
    return tl::unexpected(at(name, parsed.error().source(),
                             fmt::format("not TOML ({}); write one `name = value` a line",
                                         profile::as_written(parsed.error().description()))));
  }
  Character character;
  const toml::table& table = parsed.table();
  if (auto problem = take_all(table, name, character)) return tl::unexpected(std::move(*problem));
  if (character.name.empty()) {
    return tl::unexpected(
        fmt::format("{}:1: the character has no name; write name = \"...\"", name));
  }
  if (!foosball::foot_clears(character.body)) {
    const toml::node* reach = table["body"]["foot_reach"].node();
    const toml::node* node = reach != nullptr ? reach : table["body"]["foot_depth"].node();
    return tl::unexpected(
        at(name, node->source(),
           fmt::format(
               "the foot's corner is more than {} m from the rod and would meet the next rod's "
               "men; foot_reach squared and half of foot_depth squared may be {} squared at "
               "most: lower one",
               foosball::kFootCorner, foosball::kFootCorner)));
  }
  return character;
}

tl::expected<Character, std::string> load_character(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return tl::unexpected(path + " is a folder, a pipe or a device; give a file of a character");
  }
  auto bytes = wire::read_file(path, kMaxBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_character({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path);
}

tl::expected<Characters, std::string> load_characters(const std::string& folder) {
  auto all = load_all(folder);
  if (!all) return tl::unexpected(all.error());
  if (all->empty()) {
    return tl::unexpected(folder + " has no file *.toml; put at least one character there");
  }
  Characters characters;
  for (Loaded& one : *all) characters.push_back(std::move(one.character));
  return characters;
}

tl::expected<Characters, std::string> load_more_characters(Characters base,
                                                           const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return base;
  auto all = load_all(folder);
  if (!all) return tl::unexpected(all.error());
  for (Loaded& one : *all) {
    const auto same = std::ranges::find(base, one.character.name, &Character::name);
    if (same != base.end()) {
      *same = std::move(one.character);
    } else {
      base.push_back(std::move(one.character));
    }
  }
  if (base.size() > static_cast<std::size_t>(foosball::kMaxCharacters)) {
    return tl::unexpected(
        fmt::format("{} makes {} characters with those of the game, {} at most; "
                    "move some elsewhere",
                    folder, base.size(), foosball::kMaxCharacters));
  }
  return base;
}

std::string format_character(const Character& c) {
  std::string text =
      "# A character of Space Foosball. Lines may be omitted: then the average is used.\n";
  text += fmt::format("name = {}\nspecialty = {}\n", toml_text(c.name), toml_text(c.specialty));
  text += "\n[body]" + format_numbers(foosball::kBodyFields, c.body);
  text += fmt::format(
      "\n[look]\nskin = {}\naccent = {}\n# {}\nheadgear = \"{}\"\n# {}\nface = \"{}\"\n",
      hex(c.look.skin), hex(c.look.accent), fmt::join(foosball::kHeadgearNames, ", "),
      foosball::kHeadgearNames[static_cast<std::size_t>(c.look.headgear)],
      fmt::join(foosball::kFaceNames, ", "),
      foosball::kFaceNames[static_cast<std::size_t>(c.look.face)]);
  text += "\n[voice]" + format_numbers(foosball::kVoiceFields, c.voice);
  return text;
}

}  // namespace characters
