// Each trouble once, in a tree of files that stands for /dev and /sys, with ptys for controllers.
#include "cabinet/doctor.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "cabinet/calibration.h"
#include "os/file_descriptor.h"
#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

namespace fs = std::filesystem;

// A machine with nothing connected, to which things are plugged.
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
    // A frame each millisecond, once the line is open.
    options.next_poll = [this] {
      if (++polls_ > 2 && line_.master.fd >= 0) frame();
      return now_us_ += 1'000;
    };
    write("table.json", "");
    fs::copy_file(fs::path(CABINET_DIR) / "calibration.example.json", root_ / "table.json",
                  fs::copy_options::overwrite_existing);
    options.calibration = (root_ / "table.json").string();
    struct stat about {};
    ::stat(options.calibration.c_str(), &about);
    options.now_s = about.st_mtime + 86'400;
  }
  ~Doctor() override {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  void plug_serial() {
    line_.plug();
    fs::create_symlink(line_.path, root_ / "dev/ttyACM0");
  }
  void describe_hid(const char* id = "0003:00001209:00000001") const {
    write("sys/class/hidraw/hidraw3/device/uevent",
          std::string("DRIVER=hid-generic\nHID_ID=") + id + "\nHID_NAME=Space Foosball cabinet\n");
  }
  void plug_hid() {
    describe_hid();
    line_.plug();
    report = true;
    fs::create_symlink(line_.path, root_ / "dev/hidraw3");
  }
  void plug_input(const std::string& event, const std::string& axes, const std::string& keys,
                  const std::string& name) const {
    const fs::path folder = fs::path("sys/class/input") / event / "device";
    write(folder / "capabilities/rel", axes + "\n");
    write(folder / "capabilities/key", keys + "\n");
    write(folder / "name", name + "\n");
    write("dev/input/" + event, "");
  }
  void plug_mouse() const { plug_input("event7", "1943", "1f0000 0 0 0 0", "A mouse"); }

  void frame() {
    if (before_frame) before_frame();
    wire::DeviceFrame made = device.frame(1'000);
    if (change) change(made);
    const Bytes bytes = report ? cabinet_test::report(made) : cobs(made);
    if (polls_ % every == 0) (void)line_.master.send_what_fits(bytes);
  }

  // The only trouble; its cure.
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
  std::function<void()> before_frame;
  std::function<void(wire::DeviceFrame&)> change;
  fs::path root_;
  SerialLine line_;

 private:
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
  EXPECT_NE(diagnosis_text(diagnosis).find("all is well"), std::string::npos);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_TRUE(json["healthy"]);
  EXPECT_EQ(json["devices"][0]["kind"], "serial");
  EXPECT_EQ(json["devices"][0]["rods"].size(), 8u);
  EXPECT_EQ(json["calibration"]["days"], 1.0);
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

TEST_F(Doctor, MiceAndGamepadsAreToldFromTheRest) {
  plug_mouse();
  plug_input("event2", "0", "402000007 ff803078f800d001 feffffdfffefffff fffffffffffffffe",
             "Keyboard");
  plug_input("event9", "0", "7fdb000000000000 0 0 0 0", "A pad");
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
  fs::permissions(root_ / "dev/input/event7", fs::perms::none);
  ASSERT_EQ(::setresuid(65'534, 65'534, 0), 0);
  const Diagnosis diagnosis = examine(options);
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  ASSERT_EQ(diagnosis.troubles.size(), 1u);
  EXPECT_NE(diagnosis.troubles[0].what.find("the mouse may not be read"), std::string::npos);
  EXPECT_NE(diagnosis.troubles[0].cure.find("70-space-foosball.rules"), std::string::npos);
}

TEST_F(Doctor, AControllerWithoutANodeNeedsUdev) {
  describe_hid();
  expect_trouble("has no node", "start udev");
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
  expect_trouble("sends what is no frame", "flash our firmware");
}

TEST_F(Doctor, TooFewFramesAreSaid) {
  plug_hid();
  every = 2;
  change = [this](wire::DeviceFrame& frame) {
    frame.sequence = static_cast<std::uint16_t>(device.sequence / 2);
  };
  expect_trouble("frames a second come, of 1000", "not into a hub");
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
  expect_trouble("1 pieces of what came are no frames", "shorter cable");
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
  expect_trouble("1 motions came that no rod can make", "distance of the sensor");
}

// Somebody turns the rod to and fro while it listens, past a mark that comes a third of a turn
// later the second time: its collar has slipped.
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
  expect_trouble("went away", "change the cable");
}

TEST_F(Doctor, AnotherSerialDeviceIsNoTroubleBesideAController) {
  plug_serial();
  SerialLine modem;
  modem.plug();
  fs::create_symlink(modem.path, root_ / "dev/ttyUSB0");
  EXPECT_TRUE(examine(options).troubles.empty());
}

TEST_F(Doctor, NoCalibrationABadOneAndAnOldOneAreSaid) {
  plug_serial();
  options.now_s += std::int64_t{200} * 86'400;
  expect_trouble("201 days old", "calibrate anew");
  write("table.json", "{}");
  expect_trouble("table.json", "name another file");
  options.calibration.clear();
  expect_trouble("there is no calibration", "space-foosball calibrate --device ");
  write("kept/unnumbered.json", "");
  fs::copy_file(fs::path(CABINET_DIR) / "calibration.example.json", root_ / "kept/unnumbered.json",
                fs::copy_options::overwrite_existing);
  options.calibrations = (root_ / "kept").string();
  const Diagnosis kept = examine(options);
  ASSERT_TRUE(kept.calibration);
  EXPECT_EQ(kept.calibration->path, options.calibrations + "/unnumbered.json");
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
