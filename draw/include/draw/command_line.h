// What the command lines of programs with a window have in common: a bad value is refused at the
// start, in one sentence.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace draw {

// What to print, and the exit code, when there is nothing to run: --help, or a bad value.
struct Leave {
  int exit_code;
  std::string text;
};

Leave refuse(const std::string& sentence);
// Leave: of --help and of what does not parse.
tl::expected<void, Leave> parse(CLI::App& cli, int argc, const char* const* argv);

// A number within the range; unlike CLI::Range it does not take "nan" for one.
CLI::Validator within(double low, double high);
// What is written at the end is refused at the start where it cannot be; an empty path is not.
tl::expected<void, std::string> can_be_written(const char* option, const std::string& path);
// "WxH" in pixels.
tl::expected<glm::ivec2, std::string> parse_size(const std::string& text);

}  // namespace draw
