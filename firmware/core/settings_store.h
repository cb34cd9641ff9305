// Settings in a memory whose bytes take milliseconds each to be written, as an AVR's EEPROM: one
// byte a step, none waited for. The version, byte 0, is erased first and written last, and all is
// under a CRC: when power fails between, what is read at the next start is the default settings, or
// those of before.
#ifndef FIRMWARE_CORE_SETTINGS_STORE_H
#define FIRMWARE_CORE_SETTINGS_STORE_H

#include "core/settings.h"

namespace firmware {

// Memory: static bool ready(); uint8_t read(uint8_t at); void write(uint8_t at, uint8_t value),
// which begins to write. read() and write() only while ready().
template <typename Memory>
class SettingsStore {
 public:
  // False, and settings untouched, if there are none that hold.
  static bool load(wire::DeviceSettings& settings) {
    uint8_t bytes[kKeptBytes];
    for (uint8_t at = 0; at < kKeptBytes; ++at) bytes[at] = Memory::read(at);
    return decode_kept(bytes, settings);
  }
  // Those of a save under way are given up.
  void save(const wire::DeviceSettings& settings) {
    encode_kept(settings, bytes_);
    at_ = kErase;
  }
  bool saving() const { return at_ != kDone; }
  // Begins to write the next byte, if one is left and the one before is written.
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
  static const uint8_t kErase = 0, kDone = 255;  // of at_, besides the bytes behind the version

  static void put(uint8_t at, uint8_t value) {
    if (Memory::read(at) != value) Memory::write(at, value);
  }

  uint8_t bytes_[kKeptBytes] = {};
  uint8_t at_ = kDone;
};

}  // namespace firmware

#endif
