// A folder tree in the form of the kernel's sysfs.
#include "cabinet/controller.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

using namespace cabinet;
namespace fs = std::filesystem;

namespace {

struct Sys {
  fs::path root = fs::path(testing::TempDir()) / ("sys_" + std::to_string(getpid()));
  Sys() { fs::create_directories(root); }
  ~Sys() { fs::remove_all(root); }
  // class/KIND/NAME is a link to the device, as in sysfs.
  void add(const std::string& kind, const std::string& name, const std::string& between,
           const std::string& serial) {
    const fs::path usb = root / "devices/usb1" / ("1-" + name);
    fs::create_directories(usb / between / name);
    fs::create_directories(root / "class" / kind / name);
    fs::create_symlink(usb / between, root / "class" / kind / name / "device");
    std::ofstream(usb / "idVendor") << "1209\n";
    std::ofstream(usb / "idProduct") << "0001\n";
    if (!serial.empty()) std::ofstream(usb / "serial") << serial << "\n";
    // A hub has a serial number too.
    std::ofstream(root / "devices/usb1/serial") << "0000:00:14.0\n";
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
  EXPECT_EQ(calibration_file("/c", "../../etc/x"), "/c/_2E_2E_2F_2E_2E_2Fetc_2Fx.json");
  EXPECT_EQ(calibration_file("/c", ""), "/c/unnumbered.json");
}

TEST(Controller, NoTwoNumbersHaveOneFile) {
  const std::vector<std::string> serials = {"A/1",        "A_1", "A.1", "A_2F1", "A_5F1", "a/1", "",
                                            "unnumbered", "_",   "__",  "_5F",   "\xff",  "?"};
  std::set<std::string> files;
  for (const std::string& serial : serials) files.insert(calibration_file("/c", serial));
  EXPECT_EQ(files.size(), serials.size());
}

TEST(Controller, AFileUnderItsNameOfBeforeIsFoundUnlessItIsAnothers) {
  const Sys folder;
  const auto write = [&](const std::string& name, const std::string& serial) {
    Calibration calibration = nominal_calibration();
    calibration.serial = serial;
    ASSERT_TRUE(save_calibration(calibration, (folder.root / name).string()));
    EXPECT_EQ(kept_calibration(folder.root, "A/1"), (folder.root / name).string()) << serial;
  };
  EXPECT_EQ(kept_calibration(folder.root, "A/1"), "");
  write("A_1.json", "");
  write("A_1.json", "A/1");
  EXPECT_EQ(kept_calibration(folder.root, "A_1"), "") << "it is that of A/1";
  write("A_2F1.json", "A/1");
  EXPECT_EQ(kept_calibration(folder.root, ""), "");
  EXPECT_EQ(kept_calibration("", "A/1"), "");
}

TEST(Controller, ACalibrationOfAnotherControllerIsTold) {
  Calibration calibration = nominal_calibration();
  EXPECT_EQ(serial_conflict(calibration, "SF-1"), "") << "it does not say whose it is";
  calibration.serial = "SF-1";
  EXPECT_EQ(serial_conflict(calibration, "SF-1"), "");
  EXPECT_EQ(serial_conflict(calibration, ""), "") << "the controller does not say";
  const std::string conflict = serial_conflict(calibration, "SF\x1b[2J");
  EXPECT_NE(conflict.find("SF-1"), std::string::npos) << conflict;
  EXPECT_NE(conflict.find("SF?[2J"), std::string::npos) << conflict;
}

}  // namespace
