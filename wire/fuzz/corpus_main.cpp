// wire_fuzz_corpus DIRECTORY: writes the seeds of the fuzz targets there, each as TARGET/NAME.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: wire_fuzz_corpus DIRECTORY\n", stderr);
    return 2;
  }
  for (const auto& seed : wire::samples::seeds()) {
    const auto folder = std::filesystem::path(argv[1]) / seed.target;
    std::filesystem::create_directories(folder);
    std::ofstream file(folder / seed.name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.bytes.data()),
               static_cast<std::streamsize>(seed.bytes.size()));
    file.close();
    if (!file) {
      std::fprintf(stderr, "%s cannot be written.\n", (folder / seed.name).c_str());
      return 1;
    }
  }
  return 0;
}
