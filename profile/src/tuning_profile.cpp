#include "profile/tuning_profile.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "profile/toml_text.h"

namespace profile {
namespace {

using foosball::kTuningFields;
using foosball::Tuning;
using foosball::TuningField;

constexpr std::size_t kMostBytes = 64 * 1024;

tl::unexpected<std::string> refuse(std::string_view file, const toml::source_region& where,
                                   const std::string& why) {
  return tl::unexpected(fmt::format("{}:{}: {}", file, where.begin.line, why));
}

std::string unit_of(const TuningField& field) {
  return *field.unit == '\0' ? "" : fmt::format(" {}", field.unit);
}

std::string range_of(const TuningField& field) {
  return fmt::format("{} to {}{}", field.least, field.most, unit_of(field));
}

}  // namespace

tl::expected<Tuning, std::string> parse_tuning(std::string_view text, std::string_view name) {
  const toml::parse_result parsed = parse_toml(text);
  if (!parsed) {
    return refuse(name, parsed.error().source(),
                  fmt::format("not TOML ({}); write one `name = value` a line",
                              as_written(parsed.error().description())));
  }
  Tuning tuning;
  for (const auto& [key, node] : parsed.table()) {
    const int index = foosball::tuning_index(key.str());
    if (index < 0) {
      return refuse(name, key.source(),
                    fmt::format("no tuning value is named {}; "
                                "space-foosball-server --list-tuning shows their names",
                                as_written(key.str())));
    }
    const TuningField& field = kTuningFields[static_cast<std::size_t>(index)];
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !foosball::in_range(field, *value)) {
      return refuse(name, node.source(),
                    fmt::format("{} must be a number from {}", field.name, range_of(field)));
    }
    tuning.*field.value = *value;
  }
  return tuning;
}

tl::expected<Tuning, std::string> load_tuning(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return tl::unexpected(path + " cannot be read; check its name and permissions.");
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || text.size() > kMostBytes) {
    return tl::unexpected(path + " is no tuning profile: it is a folder or longer than 64 KiB.");
  }
  return parse_tuning(text, path);
}

std::string format_tuning(const Tuning& tuning) {
  std::string text =
      "# Tuning values of Space Foosball. Lines may be left out: then the default counts.\n";
  visit_fields(tuning, [&](const TuningField& field, double value) {
    text += fmt::format("\n# {}\n# {}; default {}\n{} = {}{}\n", field.meaning, range_of(field),
                        Tuning{}.*field.value, field.name, value,
                        value == static_cast<double>(static_cast<long>(value)) ? ".0" : "");
  });
  return text;
}

tl::expected<void, std::string> save_tuning(const Tuning& tuning, const std::string& path) {
  namespace fs = std::filesystem;
  const auto failed =
      tl::unexpected("Cannot write the profile " + path + ": make its folder writable.");
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  if (fs::exists(path, error) && !fs::is_regular_file(path, error))
    return tl::unexpected(path + " is no file: choose another name for the profile.");
  if (fs::exists(path, error) && !load_tuning(path))
    fs::copy_file(path, path + ".bad", fs::copy_options::overwrite_existing, error);
  const std::string beside = path + ".new";
  {
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    file << format_tuning(tuning);
    file.close();
    if (!file) return failed;
  }
  fs::rename(beside, path, error);
  if (error) return failed;
  return {};
}

}  // namespace profile
