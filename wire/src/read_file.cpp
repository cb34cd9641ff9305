#include "wire/read_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace wire {

tl::expected<std::vector<std::byte>, std::string> read_file(const std::string& path,
                                                            std::size_t max_bytes) {
  const auto error = [&](const std::string& what) { return tl::unexpected(path + ": " + what); };
  const auto system_error = [&](const char* verb) {
    return error(std::string("cannot be ") + verb + " (" + std::strerror(errno) +
                 "); check its name and permissions.");
  };
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "rb"), close);
  if (!file) return system_error("opened");

  // Read until the end rather than ask for the size: a pipe or a device has none.
  constexpr std::size_t kChunk = 1 << 16;
  std::vector<std::byte> bytes;
  for (std::size_t got = 1; got > 0;) {
    const std::size_t size = bytes.size();
    bytes.resize(size + kChunk);
    got = std::fread(bytes.data() + size, 1, kChunk, file.get());
    bytes.resize(size + got);
    if (bytes.size() > max_bytes) {
      return error("larger than " + std::to_string(max_bytes) +
                   " bytes; it is not what is expected here.");
    }
  }
  if (std::ferror(file.get())) return system_error("read");
  return bytes;
}

}  // namespace wire
