// STL. Binary: 80 arbitrary bytes, the number of triangles, and 50 bytes for each: a normal and
// three corners as float, and two more bytes, all little-endian. Text: words; "vertex" with three
// numbers and "endloop" define the triangles. Many binary files begin with "solid" as text files
// do, so the length decides.
#include <bit>
#include <vector>

#include "mesh_file/reader.h"

namespace vp::detail {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12;

std::uint32_t u32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  }
  return value;
}

std::uint64_t binary_size(std::string_view bytes) {
  return kHeader + kFacet * std::uint64_t{u32_at(bytes, kHeader - 4)};
}

void read_binary(std::string_view bytes, MeshBuilder& builder) {
  const std::uint32_t count = u32_at(bytes, kHeader - 4);
  for (std::uint32_t facet = 0; facet < count && !builder.full(); ++facet) {
    const std::size_t first = kHeader + kFacet * facet + kNormal;
    std::array<std::int64_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 v;
      for (std::size_t i = 0; i < 3; ++i) {
        v[static_cast<int>(i)] = std::bit_cast<float>(u32_at(bytes, first + 12 * k + 4 * i));
      }
      corners[k] = builder.vertex(v);
    }
    builder.polygon(corners);
  }
}

void read_text(std::string_view text, MeshBuilder& builder) {
  std::vector<std::int64_t> loop;
  while (!builder.full()) {
    const std::string_view token = take_token(text);
    if (token.empty()) return;
    if (token == "outer") loop.clear();
    if (token == "vertex") loop.push_back(builder.vertex(take_vec3(text)));
    if (token == "endloop") {
      builder.polygon(loop);
      loop.clear();
    }
  }
}

}  // namespace

void read_stl(std::string_view bytes, MeshBuilder& builder, std::string& fault) {
  const bool has_header = bytes.size() >= kHeader;
  if (has_header && binary_size(bytes) == bytes.size()) return read_binary(bytes, builder);
  std::string_view begin = bytes;
  if (take_token(begin) == "solid") read_text(bytes, builder);
  if (!builder.mesh.triangles.empty() || builder.full()) return;
  builder.mesh = {};
  if (!has_header || binary_size(bytes) > bytes.size()) {
    fault = "not an STL file, or cut short";
    return;
  }
  read_binary(bytes, builder);
}

}  // namespace vp::detail
