// Identifies the controller at a device's address and finds its stored calibration.
#pragma once

#include <string>

#include "cabinet/calibration.h"

namespace cabinet {

// USB identity of a device. Empty: not reported, not connected, or not a USB device.
struct UsbIdentity {
  std::string id;  // vendor and product, as in "2341:0042"
  std::string serial, product;
};

// The USB identity of a node by its name in a device class: "tty" and "ttyACM0", "hidraw" and
// "hidraw0". sys: mount point of the kernel's sysfs.
UsbIdentity usb_identity(const std::string& device_class, const std::string& node,
                         const std::string& sys = "/sys");
// The USB identity of the device at "serial:/dev/ttyACM0" or "hid:/dev/hidraw0". A recording has
// none.
UsbIdentity usb_identity_at(const std::string& address, const std::string& sys = "/sys");
std::string controller_serial(const std::string& address, const std::string& sys = "/sys");

// The path of that controller's calibration: FOLDER/SERIAL.json. Every byte except letters, digits
// and "-" becomes "_" and two hexadecimal digits. Controllers without a serial number share one
// file, "unnumbered".
std::string calibration_file(const std::string& folder, const std::string& serial);

// The calibration stored there, also under the name that an earlier version used; empty: none.
std::string kept_calibration(const std::string& folder, const std::string& serial);

// Empty, or a sentence without its full stop: the calibration belongs to another controller. A
// missing serial number matches any.
std::string serial_conflict(const Calibration& calibration, const std::string& serial);

// $XDG_DATA_HOME/space-foosball/calibrations or the same in ~/.local/share; empty: no home
// directory.
std::string calibrations_folder();

}  // namespace cabinet
