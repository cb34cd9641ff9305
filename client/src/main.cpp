#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "app/app.h"

namespace {

// Programs beside this one that are also reached as "space-foosball NAME". Returns only if the
// program is not there.
void become(const char* name, char** arguments) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string path = self.parent_path() / ("space-foosball-" + std::string(name));
  ::execv(path.c_str(), arguments);
  std::perror(path.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  for (const char* name : {"calibrate", "doctor"}) {
    if (argc < 2 || std::string_view(argv[1]) != name) continue;
    become(name, argv + 1);
    return 1;
  }
  const auto options = client::parse_options(argc, argv);
  if (!options) {
    std::fprintf(options.error().exit_code == 0 ? stdout : stderr, "%s\n",
                 options.error().text.c_str());
    return options.error().exit_code;
  }
  return client::run(*options);
}
