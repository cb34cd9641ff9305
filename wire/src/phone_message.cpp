#include "wire/phone_message.h"

#include "codec.h"
#include "layouts.h"
#include "wire/phone_description.h"

namespace wire {
namespace {

// Selects the description by the message type.
template <class Codec, class M>
void describe(Codec& codec, M& message) {
  using T = std::remove_const_t<M>;
  if constexpr (std::is_same_v<T, PhoneHello>) describe_phone_hello(codec, message);
  if constexpr (std::is_same_v<T, PhoneClaim>) describe_phone_claim(codec, message);
  if constexpr (std::is_same_v<T, PhoneInput>) describe_phone_input(codec, message);
  if constexpr (std::is_same_v<T, PhoneState>) describe_phone_state(codec, message);
  if constexpr (std::is_same_v<T, PhoneNotice>) describe_phone_notice(codec, message);
  if constexpr (std::is_same_v<T, PhonePulse>) describe_phone_pulse(codec, message);
}

constexpr std::uint32_t kNoHash = 0;  // no layout hash: the version identifies the layout

template <class Variant>
std::size_t encode(const Variant& message, std::span<std::byte> out) {
  Encoder encoder(out, kNoHash);
  std::visit([&](const auto& m) { describe(encoder, m); }, message);
  return encoder.finish();
}

template <class M, class Variant>
bool decode_as(std::span<const std::byte> in, Variant& message) {
  Decoder decoder(in, kNoHash);
  describe(decoder, message.template emplace<M>());
  return decoder.at_end();
}

template <class M>
Layout layout_of() {
  return list_layout<M>([](Lister& l, M& m) { describe(l, m); });
}

std::uint8_t kind_of(std::span<const std::byte> in) {
  return in.size() < 2 ? std::uint8_t{0} : static_cast<std::uint8_t>(in[1]);
}

}  // namespace

std::vector<NamedLayout> phone_layouts() {
  return {
      {"hello", "Phone to server, first, within 5 s.", layout_of<PhoneHello>()},
      {"claim", "Phone to server: these rods from now on.", layout_of<PhoneClaim>()},
      {"input", "Phone to server, on every change and at least 20 a second.",
       layout_of<PhoneInput>()},
      {"state", "Server to phone: the assignment of rods, after each change.",
       layout_of<PhoneState>()},
      {"notice", "Server to phone: a message for a person.", layout_of<PhoneNotice>()},
      {"pulse", "Server to phone: a man of the rod has hit the ball.", layout_of<PhonePulse>()}};
}

std::size_t encode_phone(const PhoneRequest& request, std::span<std::byte> out) {
  return encode(request, out);
}

std::size_t encode_phone(const PhoneReply& reply, std::span<std::byte> out) {
  return encode(reply, out);
}

bool decode_phone(std::span<const std::byte> in, PhoneRequest& request) {
  switch (static_cast<PhoneKind>(kind_of(in))) {
    case PhoneKind::hello:
      return decode_as<PhoneHello>(in, request);
    case PhoneKind::claim:
      return decode_as<PhoneClaim>(in, request);
    case PhoneKind::input:
      return decode_as<PhoneInput>(in, request);
    default:
      return false;
  }
}

bool decode_phone(std::span<const std::byte> in, PhoneReply& reply) {
  switch (static_cast<PhoneKind>(kind_of(in))) {
    case PhoneKind::state:
      return decode_as<PhoneState>(in, reply);
    case PhoneKind::notice:
      return decode_as<PhoneNotice>(in, reply);
    case PhoneKind::pulse:
      return decode_as<PhonePulse>(in, reply);
    default:
      return false;
  }
}

}  // namespace wire
