#include "client/qr_code.h"

#include <qrencode.h>

#include <memory>

#include "wire/control.h"

namespace client {

QrCode qr_code_of(std::string_view text) {
  if (text.empty() || text.size() > wire::kMaxUrl) return {};
  const std::vector<unsigned char> bytes(text.begin(), text.end());
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> made(
      QRcode_encodeData(static_cast<int>(bytes.size()), bytes.data(), 0, QR_ECLEVEL_M),
      QRcode_free);
  if (!made) return {};
  QrCode out{made->width, {}};
  const auto modules = static_cast<std::size_t>(out.size * out.size);
  out.dark.reserve(modules);
  for (std::size_t i = 0; i < modules; ++i) out.dark.push_back((made->data[i] & 1) != 0);
  return out;
}

}  // namespace client
