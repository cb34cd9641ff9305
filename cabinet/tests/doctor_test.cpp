// Each trouble once, in a file tree in place of /dev and /sys, with ptys for controllers.
#include "cabinet/doctor.h"

#include <gtest/gtest.h>
#include <linux/input.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "cabinet/calibration.h"
#include "os/file_descriptor.h"
#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMade = 1'795'348'800;  // 2026-11-22T12:00:00Z

// A machine to which tests connect devices.
class Doctor : public testing::Test {
 protected:
  Doctor() {
    std::string made = testing::TempDir() + "sf_doctor_XXXXXX";
    EXPECT_NE(::mkdtemp(made.data()), nullptr);
    root_ = made;
    for (const char* folder : {"dev/input", "sys/class/hidraw", "sys/class/input"}) {
      fs::create_directories(root_ / folder);
    }
    fs::permissions(root_, fs::perms::all);
    options.dev = (root_ / "dev").string();
    options.sys = (root_ / "sys").string();
    options.seconds = 0.5;
    // A frame every millisecond, once the line is open.
    options.next_poll = [this] {
      now_us_ += 1'000;
      if (++polls_ > 2 && line_.master.fd >= 0) frame();
      if (before_poll) before_poll();
      return now_us_;
    };
    write("table.json", "");
    fs::copy_file(fs::path(CABINET_DIR) / "calibration.example.json", root_ / "table.json",
                  fs::copy_options::overwrite_existing);
    options.calibration = (root_ / "table.json").string();
    options.now_s = kMade + 86'400;
    date_calibration("table.json", "2026-11-22T12:00:00Z");
  }
  ~Doctor() override {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  // A calibration with this file name, dated kMade, for the controller with this serial number.
  void date_calibration(const fs::path& path, const char* made, const char* serial = "") const {
    Calibration calibration = nominal_calibration();
    calibration.made = made;
    calibration.serial = serial;
    fs::create_directories((root_ / path).parent_path());
    ASSERT_TRUE(save_calibration(calibration, (root_ / path).string()));
  }
  // The kernel's files for the USB device of a node.
  void describe_usb(const std::string& kind, const std::string& node, const std::string& vendor,
                    const std::string& product, const std::string& serial = "") const {
    const fs::path usb = fs::path("sys/devices/usb1") / ("1-" + node), part = usb / "1-1:1.0";
    write(usb / "idVendor", vendor + "\n");
    write(usb / "idProduct", product + "\n");
    write(usb / "product", "A board\n");
    if (!serial.empty()) write(usb / "serial", serial + "\n");
    fs::create_directories(root_ / part);
    fs::create_directories(root_ / "sys/class" / kind / node);
    fs::create_symlink(root_ / part, root_ / "sys/class" / kind / node / "device");
  }
  void plug_serial(const std::string& serial = "") {
    line_.plug();
    fs::create_symlink(line_.path, root_ / "dev/ttyACM0");
    describe_usb("tty", "ttyACM0", "2341", "0042", serial);
  }
  // Another line, silent until the test writes to it.
  SerialLine& plug_line(const fs::path& node) {
    SerialLine& line = *others_.emplace_back(std::make_unique<SerialLine>());
    line.plug();
    fs::create_symlink(line.path, root_ / node);
    return line;
  }
  void describe_hid(const char* id = "0003:00001209:00000001", int number = 3,
                    int interface = 0) const {
    write("sys/class/hidraw/hidraw" + std::to_string(number) + "/device/uevent",
          std::string("DRIVER=hid-generic\nHID_ID=") + id +
              "\nHID_NAME=Space Foosball cabinet\nHID_PHYS=usb-0000:00:14.0-1/input" +
              std::to_string(interface) + "\n");
  }
  void plug_hid() {
    describe_hid();
    line_.plug();
    report = true;
    fs::create_symlink(line_.path, root_ / "dev/hidraw3");
  }
  SerialLine& plug_input(const std::string& event, const std::string& axes, const std::string& keys,
                         const std::string& name) {
    const fs::path folder = fs::path("sys/class/input") / event / "device";
    write(folder / "capabilities/rel", axes + "\n");
    write(folder / "capabilities/key", keys + "\n");
    write(folder / "name", name + "\n");
    return plug_line("dev/input/" + event);
  }
  SerialLine& plug_mouse() { return plug_input("event7", "1943", "1f0000 0 0 0 0", "A mouse"); }
  SerialLine& plug_gamepad() {
    return plug_input("event9", "0", "7fdb000000000000 0 0 0 0", "A pad");
  }
  // An event this long before now.
  void happen(const SerialLine& line, std::uint16_t type, std::uint16_t code, int value,
              std::int64_t ago_us = 300) const {
    input_event made{};
    made.input_event_sec = (now_us_ - ago_us) / 1'000'000;
    made.input_event_usec = (now_us_ - ago_us) % 1'000'000;
    made.type = type;
    made.code = code;
    made.value = value;
    Bytes bytes(sizeof made);
    std::memcpy(bytes.data(), &made, sizeof made);
    (void)line.master.send_what_fits(bytes);
  }

  void frame() {
    if (before_frame) before_frame();
    wire::DeviceFrame made = device.frame(1'000);
    if (change) change(made);
    const Bytes bytes = report ? cabinet_test::report(made) : cobs(made);
    if (polls_ % every == 0) (void)line_.master.send_what_fits(bytes);
  }

  // The cure of the only trouble.
  void expect_trouble(const std::string& what, const std::string& cure) const {
    const Diagnosis diagnosis = examine(options);
    ASSERT_EQ(diagnosis.troubles.size(), 1u) << diagnosis_text(diagnosis);
    const Trouble& trouble = diagnosis.troubles[0];
    EXPECT_NE(trouble.what.find(what), std::string::npos) << trouble.what;
    EXPECT_NE(trouble.cure.find(cure), std::string::npos) << trouble.cure;
    EXPECT_NE(diagnosis_text(diagnosis).find("do: " + trouble.cure), std::string::npos);
  }

  DoctorOptions options;
  SimulatedDevice device;
  bool report = false;
  int every = 1;
  std::function<void()> before_frame, before_poll;
  std::function<void(wire::DeviceFrame&)> change;
  fs::path root_;
  SerialLine line_;

 private:
  std::vector<std::unique_ptr<SerialLine>> others_;
  int polls_ = 0;
  std::int64_t now_us_ = 1'000'000;
};

TEST_F(Doctor, NothingConnectedIsATrouble) {
  expect_trouble("no controller, mouse or gamepad is connected", "plug one in");
}

TEST_F(Doctor, AControllerThatDoesAllRightIsWell) {
  plug_serial();
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  ASSERT_EQ(diagnosis.devices.size(), 1u);
  const FoundDevice& found = diagnosis.devices[0];
  EXPECT_EQ(found.state, DeviceState::live);
  EXPECT_NEAR(static_cast<double>(found.counters.frames) / found.seconds, 1'000, 10);
  EXPECT_NE(diagnosis_text(diagnosis).find("no fault found"), std::string::npos);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_TRUE(json["healthy"]);
  EXPECT_EQ(json["devices"][0]["kind"], "serial");
  EXPECT_EQ(json["devices"][0]["rods"].size(), 8u);
  EXPECT_EQ(json["calibrations"][0]["days"], 1.0);
}

TEST_F(Doctor, AHidControllerIsFoundByItsId) {
  plug_hid();
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  ASSERT_EQ(diagnosis.devices.size(), 1u);
  EXPECT_EQ(diagnosis.devices[0].kind, DeviceKind::hid_controller);
  EXPECT_EQ(diagnosis.devices[0].name, "Space Foosball cabinet");
  describe_hid("0003:0000046D:0000C077");
  EXPECT_TRUE(examine(options).devices.empty());
}

// Its gamepads mirror its rods and rest where those do.
TEST_F(Doctor, AControllerThatIsGamepadsTooIsFoundOnce) {
  plug_hid();
  for (int interface = 0; interface < 5; ++interface)
    describe_hid("0003:00001209:00000002", 3 + interface, interface);
  SerialLine& line = plug_gamepad();
  write("sys/class/input/event9/device/id/vendor", "1209\n");
  write("sys/class/input/event9/device/id/product", "0002\n");
  happen(line, EV_ABS, ABS_Y, 30'000);
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  ASSERT_EQ(diagnosis.devices.size(), 1u);
  EXPECT_EQ(diagnosis.devices[0].kind, DeviceKind::hid_controller);
  EXPECT_TRUE(diagnosis.devices[0].path.ends_with("hidraw3"));
  write("sys/class/input/event9/device/id/product", "0001\n");
  EXPECT_EQ(examine(options).devices.size(), 2u) << "another gamepad is one";
}

TEST_F(Doctor, MiceAndGamepadsAreToldFromTheRest) {
  plug_mouse();
  plug_input("event2", "0", "402000007 ff803078f800d001 feffffdfffefffff fffffffffffffffe",
             "Keyboard");
  plug_gamepad();
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  ASSERT_EQ(diagnosis.devices.size(), 2u);
  EXPECT_EQ(diagnosis.devices[0].kind, DeviceKind::mouse);
  EXPECT_EQ(diagnosis.devices[0].name, "A mouse");
  EXPECT_EQ(diagnosis.devices[1].kind, DeviceKind::gamepad);
  EXPECT_NE(diagnosis_text(diagnosis).find("evdev:" + options.dev + "/input/event7"),
            std::string::npos);
}

TEST_F(Doctor, WhatMayNotBeReadIsSaidWithItsCure) {
  if (::getuid() != 0) GTEST_SKIP() << "needs root, to be another user for a moment";
  plug_mouse();
  fs::permissions(fs::canonical(root_ / "dev/input/event7"), fs::perms::none);
  ASSERT_EQ(::setresuid(65'534, 65'534, 0), 0);
  const Diagnosis diagnosis = examine(options);
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  ASSERT_EQ(diagnosis.troubles.size(), 1u);
  EXPECT_NE(diagnosis.troubles[0].what.find("the mouse cannot be read"), std::string::npos);
  EXPECT_NE(diagnosis.troubles[0].cure.find("70-space-foosball.rules"), std::string::npos);
}

TEST_F(Doctor, AControllerWithoutANodeNeedsUdev) {
  describe_hid();
  expect_trouble("has no device file", "start udev");
}

TEST_F(Doctor, AControllerInUseIsSaid) {
  plug_serial();
  const os::FileDescriptor server(::open(line_.path.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC));
  ASSERT_EQ(::flock(server.get(), LOCK_EX), 0);
  expect_trouble("the controller is in use", "end the server");
}

TEST_F(Doctor, SilenceIsSaid) {
  plug_serial();
  every = 1'000'000;
  expect_trouble("sends nothing", "flash our firmware");
}

TEST_F(Doctor, WhatIsNoFrameIsSaid) {
  plug_serial();
  every = 1'000'000;
  before_frame = [this] { (void)line_.master.send_what_fits(Bytes(40, 0x55)); };
  expect_trouble("sends no valid frames", "flash our firmware");
}

TEST_F(Doctor, TooFewFramesAreSaid) {
  plug_hid();
  every = 2;
  change = [this](wire::DeviceFrame& frame) {
    frame.sequence = static_cast<std::uint16_t>(device.sequence / 2);
  };
  expect_trouble("frames a second arrive, of 1000", "not into a hub");
}

TEST_F(Doctor, LostFramesAreSaid) {
  plug_serial();
  change = [this](wire::DeviceFrame& frame) {
    device.sequence = static_cast<std::uint16_t>(device.sequence + device.sequence % 2);
    frame.sequence = device.sequence;
  };
  expect_trouble("were lost", "another cable");
}

TEST_F(Doctor, PiecesThatAreNoFramesAreSaid) {
  plug_serial();
  before_frame = [this, sent = 0]() mutable {
    if (++sent == 100) (void)line_.master.send_what_fits({1, 2, 3, 0});
  };
  expect_trouble("1 received pieces are not frames", "shorter cable");
}

TEST_F(Doctor, ErrorsOnTheSensorsLinesAreSaid) {
  plug_serial();
  change = [](wire::DeviceFrame& frame) { frame.quality = frame.sequence % 100 == 0 ? 1 : 0; };
  expect_trouble("errors on the lines between sensors and controller", "pull-ups");
}

TEST_F(Doctor, AnOverflowIsSaid) {
  plug_serial();
  change = [](wire::DeviceFrame& frame) { frame.overflow = frame.sequence == 50 ? 4 : 0; };
  expect_trouble("1 reports of a sensor that overflowed", "coarser resolution");
}

TEST_F(Doctor, MotionsThatNoRodCanMakeAreSaid) {
  plug_serial();
  before_frame = [this] { device.slide[2] += device.sequence == 60 ? 20'000 : 0; };
  expect_trouble("1 impossible motions of a rod", "distance of the sensor");
}

// A person turns the rod to and fro during the examination, past a mark that comes a third of a
// turn later the second time: its collar has slipped.
TEST_F(Doctor, AnIndexMarkThatDisagreesIsSaid) {
  plug_serial();
  Calibration calibration = nominal_calibration();
  calibration.rods[2].index = IndexMark{0, 0.4, 0};
  ASSERT_TRUE(save_calibration(calibration, options.calibration).has_value());
  options.seconds = 1.5;
  int ms = 0;
  const auto counts = [](double angle) { return std::lround(angle / 0.015625); };
  change = [&](wire::DeviceFrame& frame) {
    const double angle = 0.005 * (ms < 600 ? ms - 300 : 900 - ms);
    device.spin[2] = counts(angle);
    const double mark = ms < 600 ? 0 : -2;
    frame.spin[2] = static_cast<std::uint16_t>(device.spin[2]);
    frame.index = std::abs(angle - mark) < 0.2 ? 4 : 0;
    ms = std::min(ms + 1, 1400);
  };
  const Diagnosis diagnosis = examine(options);
  const auto said = std::ranges::find_if(diagnosis.troubles, [](const Trouble& trouble) {
    return trouble.what.find("the index mark of rod 3 disagrees") != std::string::npos;
  });
  ASSERT_NE(said, diagnosis.troubles.end()) << diagnosis_text(diagnosis);
  EXPECT_NE(said->cure.find("calibrate that rod again"), std::string::npos);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_EQ(json["devices"][0]["rods"][2]["index_disagreements"], 1);
  EXPECT_EQ(json["devices"][0]["rods"][1]["index_disagreements"], 0);
}

TEST_F(Doctor, ARodThatMovesByItselfIsSaid) {
  plug_serial();
  before_frame = [this] { device.spin[5] += device.sequence % 20 == 0 ? 1 : 0; };
  expect_trouble("rod 6 moved", "leave the rods alone");
}

TEST_F(Doctor, ACountOfNoiseIsNoTrouble) {
  plug_serial();
  before_frame = [this] { device.spin[5] = device.sequence / 7 % 2; };
  EXPECT_TRUE(examine(options).troubles.empty());
}

TEST_F(Doctor, ASensorThatDoesNotAnswerIsSaid) {
  plug_serial();
  device.present = 0b1110'1101;
  expect_trouble("no sensor answers for rod 2, 5", "supply");
}

TEST_F(Doctor, AControllerThatGoesAwayIsSaid) {
  plug_serial();
  before_frame = [this, sent = 0]() mutable {
    if (++sent == 100) line_.unplug();
  };
  expect_trouble("disappeared", "change the cable");
}

TEST_F(Doctor, AnotherSerialDeviceIsNoTroubleBesideAController) {
  plug_serial();
  plug_line("dev/ttyUSB0");
  describe_usb("tty", "ttyUSB0", "1a86", "7523");
  EXPECT_TRUE(examine(options).troubles.empty());
}

TEST_F(Doctor, ALineThatIsNotKnownAsOursIsNotOpenedUnlessItIsNamed) {
  plug_serial();
  const SerialLine& modem = plug_line("dev/ttyUSB0");
  describe_usb("tty", "ttyUSB0", "0403", "6001");
  // Opening a locked line reports the lock.
  const os::FileDescriptor owner(modem.open());
  ASSERT_EQ(::flock(owner.get(), LOCK_EX), 0);
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  EXPECT_NE(diagnosis_text(diagnosis).find("add --device serial:" + options.dev + "/ttyUSB0"),
            std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(diagnosis_json(diagnosis))["devices"][1]["opened"], false);
  options.devices = {*parse_doctor_address("serial:" + options.dev + "/ttyUSB0")};
  expect_trouble("the controller is in use", "end the server");
}

TEST_F(Doctor, OnlyLinesThatAreNotOpenedIsATroubleThatSaysHowToNameThem) {
  plug_line("dev/ttyUSB0");
  describe_usb("tty", "ttyUSB0", "0403", "6001");
  expect_trouble("no controller, mouse or gamepad is connected", "give it with --device");
}

TEST_F(Doctor, WhatIsNamedIsLookedAtWhereverItIs) {
  line_.plug();
  options.devices = {*parse_doctor_address("serial:" + line_.path)};
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  ASSERT_EQ(diagnosis.devices.size(), 1u);
  EXPECT_EQ(diagnosis.devices[0].state, DeviceState::live);
}

TEST_F(Doctor, AnAddressOfNoDeviceIsRefusedWithASentence) {
  for (const char* text :
       {"", "ttyACM0", "serial:", "hid:", "file:x", "evdev:", "evdev:/dev/x:9"}) {
    const auto address = parse_doctor_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().back(), '.') << address.error();
  }
}

TEST_F(Doctor, WhatIsNamedAndNotThereOrNoDeviceIsSaid) {
  options.devices = {*parse_doctor_address("serial:" + options.dev + "/ttyACM7")};
  expect_trouble("the controller is not connected", "plug it in");
  ASSERT_EQ(::mkfifo((root_ / "pipe").c_str(), 0600), 0);
  for (const char* path : {"pipe", "table.json", "dev"}) {
    options.devices = {*parse_doctor_address("hid:" + (root_ / path).string())};
    expect_trouble("this is no HID device", "give one that is");
  }
  options.devices = {*parse_doctor_address("evdev:/dev/null")};
  expect_trouble("this is no mouse", "give one that is");
}

TEST_F(Doctor, ALineThatHangsUpAtOnceIsSaid) {
  options.calibration.clear();  // none needed for a line that is not a controller
  options.devices = {*parse_doctor_address("serial:/dev/null")};
  expect_trouble("disconnected before it sent a frame", "plug it in again");
}

TEST_F(Doctor, AFloodOfGarbageIsSaid) {
  plug_serial();
  every = 1'000'000;
  before_frame = [this, x = std::uint32_t{1}]() mutable {
    Bytes bytes(1'000);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>((x = x * 1'664'525 + 1) >> 24);
    (void)line_.master.send_what_fits(bytes);
  };
  expect_trouble("sends no valid frames", "flash our firmware");
}

TEST_F(Doctor, NoCalibrationABadOneAndAnOldOneAreSaid) {
  plug_serial();
  options.now_s = kMade + std::int64_t{201} * 86'400;
  expect_trouble("201 days old", "calibrate again");
  options.now_s = kMade - std::int64_t{2} * 86'400;
  expect_trouble("date is in the future", "clock");
  write("table.json", "{}");
  expect_trouble("table.json", "give another file");
  EXPECT_EQ(diagnosis_text(examine(options)).find(".."), std::string::npos);
  options.calibration.clear();
  expect_trouble("there is no calibration", "space-foosball calibrate --device ");
}

TEST_F(Doctor, ACalibrationIsAsOldAsItSaysElseAsItsFile) {
  plug_serial();
  EXPECT_EQ(examine(options).calibrations.at(0).days, 1.0) << "its file is of now";
  fs::copy_file(fs::path(CABINET_DIR) / "calibration.example.json", root_ / "table.json",
                fs::copy_options::overwrite_existing);
  struct stat about {};
  ::stat(options.calibration.c_str(), &about);
  options.now_s = about.st_mtime + std::int64_t{3} * 86'400;
  EXPECT_EQ(examine(options).calibrations.at(0).days, 3.0);
}

TEST_F(Doctor, EachControllerHasItsOwnCalibration) {
  options.calibration.clear();
  options.calibrations = (root_ / "kept").string();
  plug_serial("SF-1");
  plug_line("dev/ttyACM1");
  describe_usb("tty", "ttyACM1", "2341", "0042", "SF-2");
  options.devices = {*parse_doctor_address("serial:" + options.dev + "/ttyACM1")};
  date_calibration("kept/SF-1.json", "2026-11-22T12:00:00Z", "SF-1");
  date_calibration("kept/SF-2.json", "2026-11-21T12:00:00Z", "SF-2");
  const Diagnosis diagnosis = examine(options);
  ASSERT_EQ(diagnosis.calibrations.size(), 2u) << diagnosis_text(diagnosis);
  EXPECT_EQ(diagnosis.calibrations[0].path, options.calibrations + "/SF-1.json");
  EXPECT_EQ(diagnosis.calibrations[0].days, 1.0);
  EXPECT_EQ(diagnosis.calibrations[1].path, options.calibrations + "/SF-2.json");
  EXPECT_EQ(diagnosis.calibrations[1].device, "serial:" + options.dev + "/ttyACM1");
  EXPECT_EQ(diagnosis.calibrations[1].days, 2.0);
  ASSERT_EQ(diagnosis.troubles.size(), 1u) << "the second is silent, no more";
  EXPECT_NE(diagnosis.troubles[0].what.find("sends nothing"), std::string::npos);
}

TEST_F(Doctor, ACalibrationOfAnotherControllerIsSaid) {
  plug_serial("SF-2");
  date_calibration("table.json", "2026-11-22T12:00:00Z", "SF-1");
  expect_trouble("serial number SF-1, and this one has SF-2", "space-foosball calibrate --device");
  date_calibration("table.json", "2026-11-22T12:00:00Z", "");
  EXPECT_TRUE(examine(options).troubles.empty());
}

TEST_F(Doctor, AMouseInAHandHasARateAndALatency) {
  const SerialLine& mouse = plug_mouse();
  before_poll = [&, ms = 0]() mutable {
    if (++ms % 8 != 0) return;
    happen(mouse, EV_REL, REL_X, 20);
    happen(mouse, EV_SYN, SYN_REPORT, 0);
  };
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  EXPECT_NEAR(diagnosis.devices.at(0).reports_per_s, 125, 2);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis))["devices"][0];
  EXPECT_NEAR(json["frames_per_s"], 125, 2);
  EXPECT_NEAR(json["latency_mean_us"], 300, 1);
  EXPECT_EQ(json["lost"], 0);
}

TEST_F(Doctor, AMouseThatReportsSeldomLateOrWithGapsIsSaid) {
  const SerialLine& mouse = plug_mouse();
  std::int64_t late_us = 300;
  int period_ms = 20, dropped_at = -1;
  before_poll = [&, ms = 0]() mutable {
    if (++ms % period_ms != 0) return;
    if (ms == dropped_at) happen(mouse, EV_SYN, SYN_DROPPED, 0, late_us);
    happen(mouse, EV_REL, REL_X, 50, late_us);
    happen(mouse, EV_SYN, SYN_REPORT, 0, late_us);
  };
  expect_trouble("50 reports a second arrive while it moves", "with a cable");
  period_ms = 8;
  late_us = 4'000;
  expect_trouble("reports wait 4.0 ms", "busy");
  late_us = 300;
  dropped_at = 1'200;
  expect_trouble("the kernel dropped its reports 1 times", "busy");
}

TEST_F(Doctor, AMouseThatMovesByItselfIsSaid) {
  const SerialLine& mouse = plug_mouse();
  before_poll = [&, ms = 0]() mutable {
    if (++ms % 10 != 0) return;
    happen(mouse, EV_REL, REL_Y, 1);
    happen(mouse, EV_SYN, SYN_REPORT, 0);
  };
  expect_trouble("a rod of this mouse moved", "leave it alone");
}

TEST_F(Doctor, AStickThatRestsOffItsMiddleIsSaid) {
  const SerialLine& pad = plug_gamepad();
  int value = 2'000;
  before_poll = [&, ms = 0]() mutable {
    if (++ms % 10 != 0) return;
    happen(pad, EV_ABS, ABS_RX, value + ms % 20);
    happen(pad, EV_SYN, SYN_REPORT, 0);
  };
  EXPECT_TRUE(examine(options).troubles.empty()) << "a worn stick is allowed for";
  value = 9'000;
  expect_trouble("a stick was 27 % off its centre", "let go of it");
}

TEST_F(Doctor, AGamepadInAHandHasARateAndALatency) {
  const SerialLine& pad = plug_gamepad();
  before_poll = [&, ms = 0]() mutable {
    if (++ms > 300 || ms % 4 != 0) return;
    happen(pad, EV_ABS, ABS_X, ms < 296 ? 100 * ms : 0);
    happen(pad, EV_SYN, SYN_REPORT, 0);
  };
  const Diagnosis diagnosis = examine(options);
  EXPECT_TRUE(diagnosis.troubles.empty()) << diagnosis_text(diagnosis);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis))["devices"][0];
  EXPECT_NEAR(json["frames_per_s"], 250, 2);
  EXPECT_NEAR(json["latency_mean_us"], 300, 1);
  EXPECT_GT(json["stick_peak"], 0.8);
  EXPECT_EQ(json["stick_rest"], 0);
}

TEST_F(Doctor, AMouseOrAGamepadThatGoesAwayOrIsInUseIsSaid) {
  SerialLine& mouse = plug_mouse();
  before_poll = [&, ms = 0]() mutable {
    if (++ms == 100) mouse.master.close();
  };
  expect_trouble("the mouse disappeared", "change the cable");
  before_poll = {};
  SerialLine& pad = plug_gamepad();
  fs::remove_all(root_ / "sys/class/input/event7");
  const os::FileDescriptor game(pad.open());
  ASSERT_EQ(::flock(game.get(), LOCK_EX), 0);
  expect_trouble("the gamepad is in use", "the other program");
}

TEST_F(Doctor, ANameOfAStrangerHarmsNothing) {
  plug_input("event7", "3", "0", "\x1b[2J\xff\xfe\"\\");
  plug_input("event8", "zz 3", "0", std::string(10'000, 'x'));
  const Diagnosis diagnosis = examine(options);
  EXPECT_EQ(diagnosis_text(diagnosis).find('\x1b'), std::string::npos);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_EQ(json["devices"].size(), 2u);
}

}  // namespace
