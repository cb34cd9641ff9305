#include "wire/input_datagram.h"

#include "codec.h"
#include "layouts.h"
#include "wire/input_description.h"

namespace wire {

Layout input_layout() {
  return list_layout<InputDatagram>([](Lister& l, InputDatagram& i) { describe_input(l, i); });
}

std::uint32_t input_layout_hash() {
  static const std::uint32_t hash = layout_hash(input_layout());
  return hash;
}

std::size_t encode_input(const InputDatagram& input, std::span<std::byte> out) {
  Encoder encoder(out, input_layout_hash());
  describe_input(encoder, input);
  return encoder.finish();
}

bool decode_input(std::span<const std::byte> in, InputDatagram& input) {
  Decoder decoder(in, input_layout_hash());
  describe_input(decoder, input);
  return decoder.at_end();
}

}  // namespace wire
