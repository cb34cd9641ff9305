#include "os/user_folder.h"

#include <cstdlib>

namespace os {
namespace {

// The XDG specification requires that a path that is not absolute is ignored.
std::string absolute(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && value[0] == '/' ? value : "";
}

std::string folder(const char* variable, const char* below_home) {
  if (std::string named = absolute(variable); !named.empty()) return named;
  const std::string home = absolute("HOME");
  return home.empty() ? "" : home + below_home;
}

}  // namespace

std::string data_folder() {
  return folder("XDG_DATA_HOME", "/.local/share");
}

std::string config_folder() {
  return folder("XDG_CONFIG_HOME", "/.config");
}

}  // namespace os
