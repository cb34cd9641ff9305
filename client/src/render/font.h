// Two faces of one typeface as a distance field, and the layout of a line's glyphs. No OpenGL here.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <unordered_map>
#include <vector>

struct stbtt_fontinfo;

namespace client {

enum class Face : std::uint8_t { regular, bold };
enum class Align : std::uint8_t { left, centre, right };

struct Glyph {
  glm::vec2 uv_low{0.0f}, uv_high{0.0f};  // in the atlas [px]
  glm::vec2 offset{0.0f}, size{0.0f};     // of the quad from the pen on the baseline, y down [em]
  float advance = 0.0f;                   // [em]
};

struct PlacedGlyph {
  glm::vec2 low, high;  // [px], y down
  glm::vec2 uv_low, uv_high;
};

struct TextStyle {
  Face face = Face::regular;
  float size = 16.0f;    // [px] per em
  float spacing = 0.0f;  // added between glyphs [em]
  Align align = Align::left;
};

class Font {
 public:
  // Searches for DejaVu Sans in `directory`, if not empty, then in the directories of Debian, of
  // other systems and of the page. The error says which package to install. catalogue: file of a
  // translation. Its Hangul and that of the names come from Nanum Gothic, and show as '?' if that
  // is not installed.
  static tl::expected<Font, std::string> load(const std::string& directory = {},
                                              const std::string& catalogue = {},
                                              const std::string& names = {});
  // The same, in these directories only.
  static tl::expected<Font, std::string> load_from(const std::vector<std::string>& directories);

  float width(std::string_view utf8, const TextStyle& style) const;
  // A line with its baseline at `at`. Bytes that are not UTF-8, and characters that the face lacks,
  // show as '?'.
  std::vector<PlacedGlyph> place(std::string_view utf8, const TextStyle& style,
                                 const glm::vec2& at) const;

  const std::vector<std::uint8_t>& atlas() const { return atlas_; }
  const glm::ivec2& atlas_size() const { return atlas_size_; }
  // Fraction of the distance field's range that one screen pixel covers at that text size.
  float softness(float size) const;

 private:
  using Glyphs = std::unordered_map<std::uint32_t, Glyph>;
  const Glyph& find(Face face, std::uint32_t code) const;
  void add_glyph(const stbtt_fontinfo& info, int index, float scale, Glyph& glyph);
  bool add_face(Face face, const std::string& path, const std::vector<std::uint32_t>& codes);
  void add_hangul(const std::string& catalogue, const std::string& names);
  void finish_atlas();

  std::array<Glyphs, 2> faces_;
  std::vector<std::uint8_t> atlas_;
  glm::ivec2 atlas_size_{1024, 0};
  glm::ivec2 cursor_{0, 0};
  int row_height_ = 0;
};

// The Hangul syllables of a text, each once, sorted.
std::vector<std::uint32_t> hangul_of(std::string_view utf8);

// Removes and returns the first character of UTF-8 text. Returns 0xFFFD for an invalid byte.
// Precondition: the text is not empty.
std::uint32_t next_character(std::string_view& utf8);

}  // namespace client
