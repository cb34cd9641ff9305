// A tree as the kernel shows it, made in a folder.
#include "cabinet/controller.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace cabinet;
namespace fs = std::filesystem;

namespace {

struct Sys {
  fs::path root = fs::path(testing::TempDir()) / ("sys_" + std::to_string(getpid()));
  Sys() { fs::create_directories(root); }
  ~Sys() { fs::remove_all(root); }
  // class/KIND/NAME is a link into the devices, as in sysfs.
  void add(const std::string& kind, const std::string& name, const std::string& between,
           const std::string& serial) {
    const fs::path usb = root / "devices/usb1" / ("1-" + name);
    fs::create_directories(usb / between / name);
    fs::create_directories(root / "class" / kind / name);
    fs::create_symlink(usb / between, root / "class" / kind / name / "device");
    if (!serial.empty()) std::ofstream(usb / "serial") << serial << "\n";
  }
};

TEST(Controller, ItsSerialNumberIsThatOfItsUsbDevice) {
  Sys sys;
  sys.add("tty", "ttyACM0", "1-1:1.0", "SF-0042");
  sys.add("tty", "ttyUSB3", "1-1:1.0/ttyUSB3", "A9007");
  sys.add("hidraw", "hidraw1", "1-2:1.0/0003:1209:0001.0002", "E660D4A0A7");
  sys.add("hidraw", "hidraw2", "1-2:1.0/0003:1209:0001.0003", "");
  EXPECT_EQ(controller_serial("serial:/dev/ttyACM0", sys.root), "SF-0042");
  EXPECT_EQ(controller_serial("serial:/dev/ttyUSB3", sys.root), "A9007");
  EXPECT_EQ(controller_serial("hid:/dev/hidraw1", sys.root), "E660D4A0A7");
  EXPECT_EQ(controller_serial("hid:/dev/hidraw2", sys.root), "") << "it tells none";
  EXPECT_EQ(controller_serial("hid:/dev/hidraw9", sys.root), "") << "it is not there";
  EXPECT_EQ(controller_serial("serial:/dev/hidraw1", sys.root), "");
  EXPECT_EQ(controller_serial("file:/dev/ttyACM0", sys.root), "");
  EXPECT_EQ(controller_serial("ttyACM0", sys.root), "");
}

TEST(Controller, ANumberOfAnyBytesNamesAFileInTheFolder) {
  EXPECT_EQ(calibration_file("/c", "SF-0042"), "/c/SF-0042.json");
  EXPECT_EQ(calibration_file("/c", "../../etc/x"), "/c/______etc_x.json");
  EXPECT_EQ(calibration_file("/c", ""), "/c/unnumbered.json");
}

}  // namespace
