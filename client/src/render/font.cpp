#include "render/font.h"

#include <stb/stb_truetype.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "draw/font_files.h"
#include "render/distance_field.h"

namespace client {
namespace {

constexpr float kGlyphSize = 40.0f;  // [px] per em in the atlas: sharp up to about four times that
constexpr int kPadding = 6;          // [px] of distance field around a glyph
constexpr int kOversize = 3;  // scale at which glyphs are rasterised before the distance transform

constexpr std::array<const char*, 2> kFiles{"DejaVuSans.ttf", "DejaVuSans-Bold.ttf"};

std::vector<unsigned char> read_all(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// The characters of the game's sentences and of people's names: Latin-1 and a few symbols.
std::vector<std::uint32_t> wanted_characters() {
  std::vector<std::uint32_t> codes;
  for (std::uint32_t c = 0x20; c < 0x7F; ++c) codes.push_back(c);
  for (std::uint32_t c = 0xA1; c <= 0xFF; ++c) codes.push_back(c);
  for (const std::uint32_t c :
       {0x2013u, 0x2014u, 0x2019u, 0x2026u, 0x2190u, 0x2191u, 0x2192u, 0x2193u, 0x21B5u, 0x25CFu,
        0x25CBu, 0x25B2u, 0x25B6u, 0x25BCu, 0x25C0u, 0x25C6u}) {
    codes.push_back(c);
  }
  return codes;
}

}  // namespace

std::uint32_t next_character(std::string_view& utf8) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(utf8[i]); };
  const std::uint8_t lead = byte(0);
  const std::size_t length = lead < 0x80             ? 1
                             : (lead & 0xE0) == 0xC0 ? 2
                             : (lead & 0xF0) == 0xE0 ? 3
                             : (lead & 0xF8) == 0xF0 ? 4
                                                     : 0;
  if (length == 0 || length > utf8.size()) {
    utf8.remove_prefix(1);
    return 0xFFFD;
  }
  std::uint32_t code = length == 1 ? lead : lead & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) {
      utf8.remove_prefix(1);
      return 0xFFFD;
    }
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  utf8.remove_prefix(length);
  return code;
}

tl::expected<Font, std::string> Font::load(const std::string& directory,
                                           const std::string& catalogue, const std::string& names) {
  auto font = load_from(draw::font_directories(directory));
  if (font && (!catalogue.empty() || !hangul_of(names).empty())) font->add_hangul(catalogue, names);
  return font;
}

std::vector<std::uint32_t> hangul_of(std::string_view utf8) {
  std::vector<std::uint32_t> codes;
  while (!utf8.empty()) {
    const std::uint32_t code = next_character(utf8);
    if (code >= 0xAC00 && code <= 0xD7A3) codes.push_back(code);
  }
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

void Font::add_hangul(const std::string& catalogue, const std::string& names) {
  const std::vector<unsigned char> bytes =
      catalogue.empty() ? std::vector<unsigned char>() : read_all(catalogue);
  const std::string text(bytes.begin(), bytes.end());
  const std::vector<std::uint32_t> codes = hangul_of(text + names + "한국어");
  const std::string directory = "/usr/share/fonts/truetype/nanum/";
  add_face(Face::regular, directory + "NanumGothic.ttf", codes);
  add_face(Face::bold, directory + "NanumGothicBold.ttf", codes);
  finish_atlas();
}

void Font::finish_atlas() {
  atlas_size_.y = cursor_.y + row_height_;
  atlas_.resize(static_cast<std::size_t>(atlas_size_.x) * static_cast<std::size_t>(atlas_size_.y));
}

tl::expected<Font, std::string> Font::load_from(const std::vector<std::string>& directories) {
  for (const std::string& place : directories) {
    Font font;
    const auto codes = wanted_characters();
    if (!font.add_face(Face::regular, place + "/" + kFiles[0], codes)) continue;
    if (!font.add_face(Face::bold, place + "/" + kFiles[1], codes)) continue;
    font.finish_atlas();
    return font;
  }
  return tl::unexpected(draw::no_font());
}

void Font::add_glyph(const stbtt_fontinfo& info, int index, float scale, Glyph& glyph) {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  stbtt_GetGlyphBitmapBox(&info, index, scale, scale, &x0, &y0, &x1, &y1);
  const auto reduced = [](int length) {
    return (length + kOversize - 1) / kOversize + 2 * kPadding;
  };
  const int w = reduced(x1 - x0), h = reduced(y1 - y0), wide = w * kOversize, high = h * kOversize;
  std::vector<std::uint8_t> large(static_cast<std::size_t>(wide * high));
  constexpr int kGlyphMargin = kPadding * kOversize;
  stbtt_MakeGlyphBitmap(&info, large.data() + kGlyphMargin * wide + kGlyphMargin, x1 - x0, y1 - y0,
                        wide, scale, scale, index);
  const std::vector<std::uint8_t> field =
      distance_field(large, wide, high, kOversize, kGlyphMargin);

  if (cursor_.x + w > atlas_size_.x) {
    cursor_ = {0, cursor_.y + row_height_ + 1};
    row_height_ = 0;
  }
  row_height_ = std::max(row_height_, h);
  const std::ptrdiff_t width = atlas_size_.x;
  atlas_.resize(
      std::max(atlas_.size(), static_cast<std::size_t>(width * (cursor_.y + row_height_ + 1))));
  for (int y = 0; y < h; ++y) {
    std::copy_n(field.begin() + y * w, w, atlas_.begin() + width * (cursor_.y + y) + cursor_.x);
  }
  glyph.uv_low = cursor_;
  glyph.uv_high = cursor_ + glm::ivec2(w, h);
  glyph.offset = glm::vec2(x0 - kGlyphMargin, y0 - kGlyphMargin) / (kOversize * kGlyphSize);
  glyph.size = glm::vec2(w, h) / kGlyphSize;
  cursor_.x += w + 1;
}

bool Font::add_face(Face face, const std::string& path, const std::vector<std::uint32_t>& codes) {
  const std::vector<unsigned char> file = read_all(path);
  stbtt_fontinfo info;
  if (file.empty() ||
      !stbtt_InitFont(&info, file.data(), stbtt_GetFontOffsetForIndex(file.data(), 0)))
    return false;
  const float scale = stbtt_ScaleForMappingEmToPixels(&info, kOversize * kGlyphSize);
  for (const std::uint32_t code : codes) {
    const int index = stbtt_FindGlyphIndex(&info, static_cast<int>(code));
    if (index == 0) continue;
    Glyph glyph;
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(&info, index, &advance, &bearing);
    glyph.advance = static_cast<float>(advance) * scale / (kOversize * kGlyphSize);
    if (!stbtt_IsGlyphEmpty(&info, index)) add_glyph(info, index, scale, glyph);
    faces_[static_cast<std::size_t>(face)].emplace(code, glyph);
  }
  return faces_[static_cast<std::size_t>(face)].contains('?');
}

const Glyph& Font::find(Face face, std::uint32_t code) const {
  const Glyphs& glyphs = faces_[static_cast<std::size_t>(face)];
  const auto found = glyphs.find(code);
  return found != glyphs.end() ? found->second : glyphs.at('?');
}

float Font::width(std::string_view utf8, const TextStyle& style) const {
  float pen = 0.0f;
  while (!utf8.empty()) {
    pen += (find(style.face, next_character(utf8)).advance + style.spacing) * style.size;
  }
  return pen > 0.0f ? pen - style.spacing * style.size : 0.0f;
}

std::vector<PlacedGlyph> Font::place(std::string_view utf8, const TextStyle& style,
                                     const glm::vec2& at) const {
  std::vector<PlacedGlyph> placed;
  glm::vec2 pen = at;
  if (style.align == Align::centre) pen.x -= 0.5f * width(utf8, style);
  if (style.align == Align::right) pen.x -= width(utf8, style);
  const glm::vec2 to_uv = 1.0f / glm::vec2(atlas_size_);
  while (!utf8.empty()) {
    const Glyph& glyph = find(style.face, next_character(utf8));
    if (glyph.size.x > 0.0f) {
      const glm::vec2 low = pen + glyph.offset * style.size;
      placed.push_back(
          {low, low + glyph.size * style.size, glyph.uv_low * to_uv, glyph.uv_high * to_uv});
    }
    pen.x += (glyph.advance + style.spacing) * style.size;
  }
  return placed;
}

float Font::softness(float size) const {
  const float field_per_pixel = 0.5f / kPadding * kGlyphSize / std::max(size, 1.0f);
  return std::min(0.7f * field_per_pixel, 0.45f);
}

}  // namespace client
