#include "files/read_file.h"

#include <fstream>

namespace vp::detail {

Expected<std::string> read_file(const std::string& path, std::size_t max_bytes) {
  std::string bytes;
  std::ifstream file(path, std::ios::binary);
  constexpr std::size_t kPiece = 65536;
  while (file && bytes.size() <= max_bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kPiece);
    file.read(bytes.data() + before, kPiece);
    bytes.resize(before + static_cast<std::size_t>(file.gcount()));
  }
  if (bytes.size() > max_bytes) {
    return tl::make_unexpected(
        Error{Errc::unsupported, path + ": more than " + std::to_string(max_bytes >> 20) + " MiB"});
  }
  if (!file.eof()) {
    return tl::make_unexpected(
        Error{Errc::bad_data, path + ": it cannot be read; is it there, and a file?"});
  }
  return bytes;
}

}  // namespace vp::detail
