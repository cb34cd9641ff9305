// space-foosball: the renderer. Its subcommands calibrate and doctor are programs beside it.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "app/app.h"

namespace {

// Replaces this process by the named program. Returns only if the program cannot be started.
int become(const char* name, char** arguments) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  std::string program = (self.parent_path() / "space-foosball-").string() + name;
  arguments[0] = program.data();
  ::execv(program.c_str(), arguments);
  std::fprintf(stderr, "%s cannot be started (%s): build or install it with the game.\n",
               program.c_str(), std::strerror(errno));
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  for (const char* name : {"calibrate", "doctor"})
    if (argc > 1 && std::strcmp(argv[1], name) == 0) return become(name, argv + 1);
  const auto options = client::parse_options(argc, argv);
  if (!options) {
    std::fprintf(options.error().exit_code == 0 ? stdout : stderr, "%s\n",
                 options.error().text.c_str());
    return options.error().exit_code;
  }
  return client::run(*options);
}
