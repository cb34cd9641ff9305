#include <cstdio>

#include "app/app.h"

int main(int argc, char** argv) {
  const auto options = sandbox::parse_options(argc, argv);
  if (!options) {
    std::fprintf(options.error().exit_code == 0 ? stdout : stderr, "%s\n",
                 options.error().text.c_str());
    return options.error().exit_code;
  }
  return sandbox::run(*options);
}
