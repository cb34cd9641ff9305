# Run by the build: cmake -DDIR=... -DOUT=... -DHEADER=... -DNAMESPACE=... -P embed_shaders.cmake. Writes
# one .cpp in which every shader is a raw string, found by its file name: shader_source() of HEADER.
file(GLOB shaders "${DIR}/*.glsl" "${DIR}/*.vert" "${DIR}/*.frag")
list(SORT shaders)
set(body "")
foreach(path IN LISTS shaders)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" text)
  string(APPEND body "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
endforeach()
file(WRITE "${OUT}.new" "// Written by draw/cmake/embed_shaders.cmake.
#include \"${HEADER}\"

#include <array>
#include <utility>

namespace ${NAMESPACE} {
namespace {
using Entry = std::pair<std::string_view, std::string_view>;
const auto kShaders = std::to_array<Entry>({
${body}});
}  // namespace

std::string_view shader_source(std::string_view name) {
  for (const auto& [key, text] : kShaders) {
    if (key == name) return text;
  }
  return {};
}

}  // namespace ${NAMESPACE}
")
file(COPY_FILE "${OUT}.new" "${OUT}" ONLY_IF_DIFFERENT)
