// Which controller a device's address is, and where its calibration is kept.
#pragma once

#include <string>

#include "cabinet/calibration.h"

namespace cabinet {

// What a device tells over USB; empty: nothing, it is not there, or it is no USB device.
struct UsbIdentity {
  std::string id;  // vendor and product, as in "2341:0042"
  std::string serial, product;
};

// Of a node by its name among those of a class: "tty" and "ttyACM0", "hidraw" and "hidraw0". sys:
// where the kernel tells of devices.
UsbIdentity usb_identity(const std::string& device_class, const std::string& node,
                         const std::string& sys = "/sys");
// Of "serial:/dev/ttyACM0" or "hid:/dev/hidraw0"; nothing of a recording.
UsbIdentity usb_identity_at(const std::string& address, const std::string& sys = "/sys");
std::string controller_serial(const std::string& address, const std::string& sys = "/sys");

// The file of that controller's calibration: FOLDER/SERIAL.json, where any byte but letters, digits
// and "-" is "_" and two hexadecimal digits; controllers without a serial number share one,
// "unnumbered".
std::string calibration_file(const std::string& folder, const std::string& serial);

// The one that is kept there, also under the name that a version before gave it; empty: none is.
std::string kept_calibration(const std::string& folder, const std::string& serial);

// Empty, or that the calibration is of another controller than this one: a sentence without its
// full stop. What has no serial number agrees with all.
std::string serial_conflict(const Calibration& calibration, const std::string& serial);

// $XDG_DATA_HOME/space-foosball/calibrations or the same in ~/.local/share; empty: there is no
// home.
std::string calibrations_folder();

}  // namespace cabinet
