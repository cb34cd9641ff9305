#include "draw/program.h"

#include <glm/gtc/type_ptr.hpp>

namespace draw {
namespace {

tl::expected<GLuint, std::string> compile(ShaderSource source, GLenum stage,
                                          std::initializer_list<std::string_view> files,
                                          Quality quality) {
  std::string text = "#version 300 es\nprecision highp float;\nprecision highp int;\n";
  if (quality == Quality::low) text += "#define LOW_QUALITY 1\n";
  std::string names;
  for (const std::string_view file : files) {
    text += source(file);
    names += std::string(file) + " ";
  }
  const GLuint shader = glCreateShader(stage);
  const char* joined = text.c_str();
  glShaderSource(shader, 1, &joined, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char log[2048] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  return tl::unexpected("The OpenGL driver refuses the shader " + names + ": " + log);
}

}  // namespace

tl::expected<Program, std::string> Program::build(ShaderSource source,
                                                  std::initializer_list<std::string_view> vertex,
                                                  std::initializer_list<std::string_view> fragment,
                                                  Quality quality) {
  const auto v = compile(source, GL_VERTEX_SHADER, vertex, quality);
  if (!v) return tl::unexpected(v.error());
  const auto f = compile(source, GL_FRAGMENT_SHADER, fragment, quality);
  if (!f) {
    glDeleteShader(*v);
    return tl::unexpected(f.error());
  }
  Program program;
  program.handle_ = GlProgram::make();
  const GLuint name = program.handle_.get();
  glAttachShader(name, *v);
  glAttachShader(name, *f);
  glLinkProgram(name);
  glDeleteShader(*v);
  glDeleteShader(*f);
  GLint good = 0;
  glGetProgramiv(name, GL_LINK_STATUS, &good);
  if (!good) {
    char log[2048] = "";
    glGetProgramInfoLog(name, sizeof log, nullptr, log);
    return tl::unexpected(std::string("The OpenGL driver cannot link ") +
                          std::string(*(fragment.end() - 1)) + ": " + log);
  }
  GLint count = 0;
  glGetProgramiv(name, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    char uniform[128] = "";
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(name, static_cast<GLuint>(i), sizeof uniform, nullptr, &size, &type,
                       uniform);
    for (GLint element = 0; element < size; ++element) {
      std::string key = uniform;
      if (const auto bracket = key.find("[0]"); bracket != std::string::npos) {
        key = key.substr(0, bracket) + "[" + std::to_string(element) + "]";
      }
      program.uniforms_.emplace_back(key, glGetUniformLocation(name, key.c_str()));
    }
  }
  return program;
}

GLint Program::location(std::string_view name) const {
  for (const auto& [key, place] : uniforms_) {
    if (key == name) return place;
  }
  return -1;
}

void Program::set(std::string_view name, int value) const {
  glUniform1i(location(name), value);
}
void Program::set(std::string_view name, float value) const {
  glUniform1f(location(name), value);
}
void Program::set(std::string_view name, const glm::vec2& value) const {
  glUniform2fv(location(name), 1, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::vec3& value) const {
  glUniform3fv(location(name), 1, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::vec4& value) const {
  glUniform4fv(location(name), 1, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::mat3& value) const {
  glUniformMatrix3fv(location(name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(std::string_view name, const glm::mat4& value) const {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, glm::value_ptr(value));
}

}  // namespace draw
