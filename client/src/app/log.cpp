#include "app/log.h"

#include <cstdio>

namespace client {

void log_info(const std::string& sentence) {
  std::fprintf(stderr, "space-foosball: %s\n", sentence.c_str());
}
void log_warning(const std::string& sentence) {
  std::fprintf(stderr, "space-foosball: warning: %s\n", sentence.c_str());
}

}  // namespace client
