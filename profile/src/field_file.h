// Files with one `name = value` per line, for values described by an array of fields: name, unit,
// value, least, most, meaning.
#pragma once

#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "profile/toml_text.h"

namespace profile {

template <class Field>
std::string range_of(const Field& field) {
  return fmt::format("{} to {}{}{}", field.min, field.max, *field.unit == '\0' ? "" : " ",
                     field.unit);
}

// Returns values, changed by the text. kind: of value, as in "no tuning value is named". command:
// the one that lists the names.
template <class Values, class Fields>
tl::expected<Values, std::string> read_fields(std::string_view text, std::string_view file,
                                              Values values, const Fields& fields,
                                              std::string_view kind, std::string_view command) {
  const auto refuse = [&](const toml::source_region& where, const std::string& why) {
    return tl::unexpected(fmt::format("{}:{}: {}", file, where.begin.line, why));
  };
  const toml::parse_result parsed = parse_toml(text);
  if (!parsed) {
    return refuse(parsed.error().source(),
                  fmt::format("not TOML ({}); write one `name = value` a line",
                              as_written(parsed.error().description())));
  }
  for (const auto& [key, node] : parsed.table()) {
    const auto* field = fields.begin();
    while (field != fields.end() && key.str() != field->name) ++field;
    if (field == fields.end()) {
      return refuse(key.source(), fmt::format("no {} is named {}; {} shows their names", kind,
                                              as_written(key.str()), command));
    }
    const std::optional<double> value =
        node.is_number() ? node.template value<double>() : std::nullopt;
    if (!value || !in_range(*field, *value)) {
      return refuse(node.source(),
                    fmt::format("{} must be a number from {}", field->name, range_of(*field)));
    }
    values.*field->value = *value;
  }
  return values;
}

// Reads a file of at most 64 KiB. what: the expected kind, such as "tuning profile".
inline tl::expected<std::string, std::string> read_text(const std::string& path,
                                                        std::string_view what) {
  constexpr std::size_t kMaxBytes = 64 * 1024;
  std::ifstream file(path, std::ios::binary);
  if (!file) return tl::unexpected(path + " cannot be read; check its name and permissions.");
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || text.size() > kMaxBytes) {
    return tl::unexpected(
        fmt::format("{} is no {}: it is a folder or longer than 64 KiB.", path, what));
  }
  return text;
}

// Writes each value with its range and meaning as a comment. read_fields() restores the same values
// bit for bit.
template <class Values, class Fields>
std::string write_fields(const Values& values, const Values& defaults, const Fields& fields) {
  std::string text;
  for (const auto& field : fields) {
    const double value = values.*field.value;
    const bool whole = value == static_cast<double>(static_cast<long>(value));
    text += fmt::format("\n# {}\n# {}; default {}\n{} = {}{}\n", field.meaning, range_of(field),
                        defaults.*field.value, field.name, value, whole ? ".0" : "");
  }
  return text;
}

}  // namespace profile
