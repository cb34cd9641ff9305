// wire_protocol_doc [FILE]: writes the protocol documentation to FILE, or to standard output.
#include <cstdio>
#include <fstream>

#include "protocol_doc.h"

int main(int argc, char** argv) {
  const std::string text = wire::protocol_document();
  if (argc < 2) return std::fputs(text.c_str(), stdout) < 0 ? 1 : 0;
  std::ofstream file(argv[1], std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    std::fprintf(stderr, "%s cannot be written; check that its folder exists.\n", argv[1]);
    return 1;
  }
  return 0;
}
