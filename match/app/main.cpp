// space-foosball-match: matches on the threads of this machine.
#include "options.h"
#include "run.h"

int main(int argc, char** argv) {
  const auto options = app::parse(argc, argv);
  return options ? app::run(*options, match::play_all) : app::leave(options.error());
}
