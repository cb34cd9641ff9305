// Shared parts of the command lines of programs with a window. An invalid value is rejected at the
// start, with one sentence.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace draw {

// The text to print and the exit code if the program does not run: --help, or an invalid value.
struct Leave {
  int exit_code;
  std::string text;
};

Leave refuse(const std::string& sentence);
// The error: the text of --help, or the parse error.
tl::expected<void, Leave> parse(CLI::App& cli, int argc, const char* const* argv);

// A number within the range; unlike CLI::Range it rejects "nan".
CLI::Validator within(double low, double high);
// Checks at the start that a file to be written at the end can be written. An empty path is valid.
tl::expected<void, std::string> can_be_written(const char* option, const std::string& path);
// "WxH" in pixels.
tl::expected<glm::ivec2, std::string> parse_size(const std::string& text);

}  // namespace draw
