// Stores settings in a memory that takes milliseconds to write a byte, such as an AVR's EEPROM: one
// byte per step, without blocking. The version, byte 0, is erased first and written last, and a CRC
// covers all bytes. After a power failure during a save, the next start reads the default or the
// previous settings.
#ifndef FIRMWARE_CORE_SETTINGS_STORE_H
#define FIRMWARE_CORE_SETTINGS_STORE_H

#include "core/settings.h"

namespace firmware {

// Memory: static bool ready(); uint8_t read(uint8_t at); void write(uint8_t at, uint8_t value),
// which starts a write. read() and write() require ready().
template <typename Memory>
class SettingsStore {
 public:
  // False, with settings unchanged, if no valid settings are stored.
  static bool load(wire::DeviceSettings& settings) {
    uint8_t bytes[kKeptBytes];
    for (uint8_t at = 0; at < kKeptBytes; ++at) bytes[at] = Memory::read(at);
    return decode_kept(bytes, settings);
  }
  // Starts a save and abandons one in progress.
  void save(const wire::DeviceSettings& settings) {
    encode_kept(settings, bytes_);
    at_ = kErase;
  }
  bool saving() const { return at_ != kDone; }
  // Starts to write the next byte if the previous one is complete.
  void step() {
    if (at_ == kDone || !Memory::ready()) return;
    if (at_ == kErase) {
      at_ = 1;
      put(0, 0xFF);
    } else if (at_ < kKeptBytes) {
      put(at_, bytes_[at_]);
      ++at_;
    } else {
      at_ = kDone;
      put(0, bytes_[0]);
    }
  }

 private:
  static const uint8_t kErase = 0, kDone = 255;  // values of at_ besides the index of a byte

  static void put(uint8_t at, uint8_t value) {
    if (Memory::read(at) != value) Memory::write(at, value);
  }

  uint8_t bytes_[kKeptBytes] = {};
  uint8_t at_ = kDone;
};

}  // namespace firmware

#endif
