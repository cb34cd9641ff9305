#include "wire/characters.h"

#include "codec.h"
#include "layouts.h"
#include "wire/characters_description.h"

namespace wire {

Layout characters_layout() {
  return list_layout<Characters>([](Lister& l, auto& c) { describe_characters(l, c.characters); });
}

std::vector<std::byte> encode_characters(const Characters& characters) {
  static const std::size_t max = max_bits(characters_layout()) / 8 + 1;
  std::vector<std::byte> bytes(max);
  Encoder encoder(bytes, 0);
  describe_characters(encoder, characters.characters);
  bytes.resize(encoder.finish());
  return bytes;
}

bool decode_characters(std::span<const std::byte> bytes, Characters& characters) {
  Decoder decoder(bytes, 0);
  describe_characters(decoder, characters.characters);
  return decoder.at_end() && !characters.characters.empty();
}

}  // namespace wire
