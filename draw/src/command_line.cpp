#include "draw/command_line.h"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace draw {
namespace {

bool read_length(std::string_view text, int min, int& value) {
  constexpr int kMax = 16384;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= min && value <= kMax;
}

}  // namespace

Leave refuse(const std::string& sentence) {
  return {2, sentence + " See --help."};
}

tl::expected<void, Leave> parse(CLI::App& cli, int argc, const char* const* argv) {
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) return tl::unexpected(refuse(std::string(e.what()) + "."));
    std::ostringstream out, err;
    cli.exit(e, out, err);
    return tl::unexpected(Leave{0, out.str()});
  }
  return {};
}

CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = std::nan("");
        const bool number = CLI::detail::lexical_cast(text, value);
        if (number && value >= low && value <= high) return std::string();
        std::ostringstream sentence;
        sentence << "\"" << text << "\" is not a number from " << low << " to " << high;
        return sentence.str();
      },
      "NUMBER");
}

// Only an attempt shows it: permissions say nothing for /proc or a read-only file system.
tl::expected<void, std::string> can_be_written(const char* option, const std::string& path) {
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  const bool there = std::filesystem::exists(status);
  if (path.empty() || (there && !std::filesystem::is_regular_file(status) &&
                       !std::filesystem::is_directory(status)))
    return {};  // a device or a pipe: opening it may have an effect
  errno = 0;
  const bool good = std::ofstream(path, std::ios::app).is_open();
  const std::string why = std::strerror(errno);
  if (good && !there) std::filesystem::remove(path, none);
  if (good) return {};
  return tl::unexpected(std::string(option) + " cannot write to \"" + path + "\" (" + why +
                        "): name a file in a folder that can be written to.");
}

tl::expected<glm::ivec2, std::string> parse_size(const std::string& text) {
  const auto x = text.find('x');
  glm::ivec2 size{0, 0};
  if (x == std::string::npos || !read_length(std::string_view(text).substr(0, x), 160, size.x) ||
      !read_length(std::string_view(text).substr(x + 1), 120, size.y)) {
    return tl::unexpected("--size wants WxH in pixels, at least 160x120, not \"" + text + "\".");
  }
  return size;
}

}  // namespace draw
