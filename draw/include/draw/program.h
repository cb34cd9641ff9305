// A linked shader program, with its uniforms by name.
#pragma once

#include <glm/fwd.hpp>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "draw/gl_handle.h"
#include "draw/quality.h"

namespace draw {

// Source text of the named shader file; empty if there is none. Each module has a separate
// function.
using ShaderSource = std::string_view (*)(std::string_view file);

class Program {
 public:
  // Concatenates the named shader files of each stage, shared parts first. The error is the
  // driver's log with the files' names.
  static tl::expected<Program, std::string> build(ShaderSource source,
                                                  std::initializer_list<std::string_view> vertex,
                                                  std::initializer_list<std::string_view> fragment,
                                                  Quality quality);

  void use() const { glUseProgram(handle_.get()); }
  // Each sets a uniform of the program in use. A name that the shader lacks is ignored, because the
  // compiler may have optimised it away.
  void set(std::string_view name, int value) const;
  void set(std::string_view name, float value) const;
  void set(std::string_view name, const glm::vec2& value) const;
  void set(std::string_view name, const glm::vec3& value) const;
  void set(std::string_view name, const glm::vec4& value) const;
  void set(std::string_view name, const glm::mat3& value) const;
  void set(std::string_view name, const glm::mat4& value) const;

 private:
  GLint location(std::string_view name) const;

  GlProgram handle_;
  std::vector<std::pair<std::string, GLint>> uniforms_;
};

}  // namespace draw
