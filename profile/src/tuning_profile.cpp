#include "profile/tuning_profile.h"

#include <filesystem>
#include <fstream>

#include "field_file.h"

namespace profile {

using foosball::kTuningFields;
using foosball::Tuning;

tl::expected<Tuning, std::string> parse_tuning(std::string_view text, std::string_view name) {
  return read_fields(text, name, Tuning{}, kTuningFields, "tuning value",
                     "space-foosball-server --list-tuning");
}

tl::expected<Tuning, std::string> load_tuning(const std::string& path) {
  const auto text = read_text(path, "tuning profile");
  if (!text) return tl::unexpected(text.error());
  return parse_tuning(*text, path);
}

std::string format_tuning(const Tuning& tuning) {
  return "# Tuning values of Space Foosball. Lines may be omitted: then the default is used.\n" +
         write_fields(tuning, Tuning{}, kTuningFields);
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
