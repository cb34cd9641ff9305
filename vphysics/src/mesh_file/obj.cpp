// Wavefront OBJ: one statement for each line. Supported: v (a vertex); f (a face, with corners i,
// i/t, i//n or i/t/n, counted from 1, or negative, counted back from the last vertex); o and g
// (start of an object). A backslash at the end of a line continues it on the next.
#include <vector>

#include "mesh_file/reader.h"

namespace vp::detail {
namespace {

// Returns a negative number if there is no valid index.
std::int64_t take_index(std::string_view token, std::size_t vertices) {
  std::int64_t index = 0;
  const auto [end, failed] = std::from_chars(token.data(), token.data() + token.size(), index);
  const bool is_whole = end == token.data() + token.size() || *end == '/';
  if (failed != std::errc() || !is_whole || index == 0) return -1;
  return index > 0 ? index - 1 : static_cast<std::int64_t>(vertices) + index;
}

void read_statement(std::string_view line, MeshBuilder& builder, std::vector<std::int64_t>& face) {
  const std::string_view what = take_token(line);
  if (what == "v") {
    builder.vertex(take_vec3(line));
  } else if (what == "f") {
    face.clear();
    for (;;) {
      const std::string_view corner = take_token(line);
      if (corner.empty() || corner[0] == '#') break;
      face.push_back(take_index(corner, builder.mesh.vertices.size()));
    }
    builder.polygon(face);
  } else if (what == "o" || what == "g") {
    builder.begin_object();
  }
}

}  // namespace

void read_obj(std::string_view text, MeshBuilder& builder) {
  std::vector<std::int64_t> face;
  std::string joined;
  while (!text.empty() && !builder.full()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (!line.empty() && line.back() == '\\') {
      line.remove_suffix(1);
      joined += line;
      joined += ' ';
    } else if (joined.empty()) {
      read_statement(line, builder, face);
    } else {
      joined += line;
      read_statement(joined, builder, face);
      joined.clear();
    }
  }
  if (!joined.empty()) read_statement(joined, builder, face);
}

}  // namespace vp::detail
