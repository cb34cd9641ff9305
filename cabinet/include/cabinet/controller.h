// Which controller a device's address is, and where its calibration is kept.
#pragma once

#include <string>

namespace cabinet {

// The serial number that the controller of "serial:/dev/ttyACM0" or "hid:/dev/hidraw0" tells over
// USB; empty: it has none, it is not there, or the address is a recording. sys: where the kernel
// tells of devices.
std::string controller_serial(const std::string& address, const std::string& sys = "/sys");

// The file of that controller's calibration: FOLDER/SERIAL.json, where any but letters, digits, "-"
// and "_" are "_"; controllers without a serial number share one, "unnumbered".
std::string calibration_file(const std::string& folder, const std::string& serial);

// $XDG_DATA_HOME/space-foosball/calibrations or the same in ~/.local/share; empty: there is no
// home.
std::string calibrations_folder();

}  // namespace cabinet
