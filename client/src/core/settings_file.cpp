// The file of the settings.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "client/settings.h"
#include "os/user_folder.h"

namespace client {
namespace {

constexpr std::size_t kLongestFile = 64 * 1024;  // bytes; a longer file is no settings file

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  text.resize(kLongestFile);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

bool write_all(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return false;
  bool good = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  good = std::fflush(file) == 0 && good;
  good = ::fsync(::fileno(file)) == 0 && good;
  return std::fclose(file) == 0 && good;
}

}  // namespace

std::string settings_path() {
  const std::string config = os::config_folder();
  return config.empty() ? "" : config + "/space-foosball/client.conf";
}

ReadSettings load_settings(const std::string& path) {
  std::error_code error;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return {};
  ReadSettings read = parse_settings(read_text(path));
  for (std::string& problem : read.problems) problem.insert(0, path + ", ").push_back('.');
  return read;
}

tl::expected<void, std::string> save_settings(const Settings& settings, const std::string& path) {
  if (path.empty()) {
    return tl::unexpected(
        std::string("Settings are not kept: set HOME or XDG_CONFIG_HOME to a directory of yours."));
  }
  const tl::unexpected<std::string> failed("Cannot write the settings to " + path +
                                           ": make its directory writable.");
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  if (!load_settings(path).problems.empty())
    std::filesystem::copy_file(path, path + ".bad",
                               std::filesystem::copy_options::overwrite_existing, error);
  if (error) return failed;
  const std::string beside = path + ".new";
  if (!write_all(beside, format_settings(settings))) return failed;
  std::filesystem::rename(beside, path, error);
  if (error) return failed;
  return {};
}

}  // namespace client
