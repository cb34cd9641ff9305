// The source on real descriptors: ptys, socket pairs, files. The tests pass the clock in.
#include "cabinet/device_source.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

struct Bench {
  SerialLine line;
  SimulatedDevice device;
  std::int64_t now_us = 5'000'000;
  int opened = 0;
  std::unique_ptr<DeviceSource> source;

  Bench() {
    line.plug();
    source = std::make_unique<DeviceSource>(DeviceOptions{}, [this] {
      const int fd = line.open();
      opened += fd >= 0 ? 1 : 0;
      return fd;
    });
    source->poll(now_us);
  }
  void step(std::int64_t by_us) {
    now_us += by_us;
    source->poll(now_us);
  }
  void send_and_step() {
    line.master.send(cobs(device.frame()));
    step(4'000);
  }
  const RodInput& rod(int index) const { return source->rods()[index]; }
};

// The state at the last report, without the extrapolation.
double measured_slide(const RodInput& rod) {
  return rod.slide - rod.slide_ahead;
}
double measured_angle(const RodInput& rod) {
  return rod.angle - rod.angle_ahead;
}

TEST(DeviceSource, BeforeTheFirstFrameRodsAreAbsent) {
  Bench bench;
  EXPECT_FALSE(bench.source->connected());
  for (const RodInput& rod : bench.source->rods()) EXPECT_EQ(rod.status, RodStatus::absent);
}

TEST(DeviceSource, EightRodsThroughAPtyAreExact) {
  Bench bench;
  bench.send_and_step();
  for (int i = 0; i < 2'500; ++i) {  // 10 s at 250 frames a second
    for (int rod = 0; rod < kRods; ++rod) {
      bench.device.slide[rod] += (rod % 2 == 0 ? 1 : -1) * (30 + rod);
      bench.device.spin[rod] -= 50 - 7 * rod;
    }
    bench.send_and_step();
  }
  for (int rod = 0; rod < kRods; ++rod) {
    EXPECT_NEAR(measured_slide(bench.rod(rod)),
                static_cast<double>(bench.device.slide[rod]) * kMetresPerCount, 1e-9);
    EXPECT_NEAR(measured_angle(bench.rod(rod)),
                static_cast<double>(bench.device.spin[rod]) * kMetresPerCount / 0.008, 1e-9);
    EXPECT_EQ(bench.rod(rod).time_us, bench.now_us);
  }
  EXPECT_EQ(bench.source->counters().frames, 2'501u);
  EXPECT_EQ(bench.source->counters().bad, 0u);
  EXPECT_EQ(bench.source->last_frame_time_us(), bench.device.time_us);
  EXPECT_TRUE(bench.source->connected());
}

TEST(DeviceSource, AnUnpluggedLineHoldsAtTheNextPoll) {
  Bench bench;
  bench.send_and_step();
  bench.device.slide[0] = 80;
  bench.send_and_step();
  EXPECT_GT(bench.rod(0).slide_rate, 0.0);
  bench.line.unplug();
  bench.step(1'000);  // detected 1 ms later; 100 ms are allowed
  EXPECT_FALSE(bench.source->connected());
  for (const RodInput& rod : bench.source->rods()) {
    EXPECT_EQ(rod.status, RodStatus::held);
    EXPECT_EQ(rod.slide_rate, 0.0);
    EXPECT_EQ(rod.angle_rate, 0.0);
  }
  EXPECT_NEAR(bench.rod(0).slide, 0.01, 1e-12);
}

TEST(DeviceSource, PluggedInAgainItContinuesWithoutAJump) {
  Bench bench;
  bench.send_and_step();
  bench.device.slide[0] = 800;
  bench.send_and_step();
  bench.line.unplug();
  bench.step(1'000);
  bench.step(1'000'000);
  EXPECT_EQ(bench.rod(0).status, RodStatus::held);

  bench.line.plug();
  bench.device.slide[0] = 20'000;  // turned meanwhile, or another micro-controller
  const std::int64_t plugged_us = bench.now_us;
  while (!bench.source->connected() && bench.now_us < plugged_us + 2'000'000) {
    if (bench.opened > 1) bench.line.master.send(cobs(bench.device.frame()));
    bench.step(4'000);
  }
  EXPECT_LT(bench.now_us - plugged_us, 250'000);
  EXPECT_EQ(bench.rod(0).status, RodStatus::live);
  EXPECT_NEAR(bench.rod(0).slide, 0.1, 1e-12);
  EXPECT_EQ(bench.rod(0).slide_rate, 0.0);
  EXPECT_EQ(bench.source->counters().reopened, 1u);

  bench.device.slide[0] += 8;
  bench.send_and_step();
  EXPECT_NEAR(measured_slide(bench.rod(0)), 0.101, 1e-12);
}

TEST(DeviceSource, OpensNoOftenerThanReopenUs) {
  Bench bench;
  bench.line.unplug();
  int tries = 0;
  DeviceSource source(DeviceOptions{}, [&tries] {
    ++tries;
    return -1;
  });
  for (int ms = 0; ms <= 1'000; ++ms) source.poll(ms * 1'000);
  EXPECT_EQ(tries, 6);  // at 0, 200, ... 1000 ms
}

TEST(DeviceSource, SilenceHoldsAndTheNextFrameRevives) {
  Bench bench;
  bench.send_and_step();
  bench.device.slide[0] = 80;
  bench.send_and_step();
  bench.step(50'000);
  EXPECT_EQ(bench.rod(0).status, RodStatus::live);
  bench.step(1);
  EXPECT_EQ(bench.rod(0).status, RodStatus::held);
  EXPECT_EQ(bench.rod(0).slide_rate, 0.0);
  EXPECT_FALSE(bench.source->connected());
  bench.send_and_step();
  EXPECT_EQ(bench.rod(0).status, RodStatus::live);
  EXPECT_TRUE(bench.source->connected());
  EXPECT_EQ(bench.opened, 1);
  EXPECT_EQ(bench.source->counters().reopened, 0u);
}

TEST(DeviceSource, TellsSilenceNoiseAndAbsenceApart) {
  Bench bench;
  const auto state = [&bench] { return bench.source->state(); };
  EXPECT_EQ(state(), DeviceState::silent);
  bench.line.master.send(Bytes(100, 0x55));
  bench.step(1'000);
  EXPECT_EQ(state(), DeviceState::garbled);
  bench.step(900'000);  // occasional noise
  EXPECT_EQ(state(), DeviceState::garbled);
  bench.step(100'001);
  EXPECT_EQ(state(), DeviceState::silent);

  bench.line.master.send({0});  // end of the noise
  bench.send_and_step();
  EXPECT_EQ(state(), DeviceState::live);
  // Cut off in the middle of a frame: an incomplete frame is not noise.
  const Bytes piece = cobs(bench.device.frame());
  bench.line.master.send(Bytes(piece.begin(), piece.begin() + 20));
  bench.step(1'000);
  EXPECT_EQ(state(), DeviceState::live);
  bench.step(60'000);
  EXPECT_EQ(state(), DeviceState::silent);

  bench.line.master.send({0});
  bench.send_and_step();
  EXPECT_EQ(state(), DeviceState::live);
  for (int i = 0; i < 60; ++i) {  // from frames to noise, as after another program's reset
    bench.line.master.send(Bytes(48, 0xEE));
    bench.step(1'000);
  }
  EXPECT_EQ(state(), DeviceState::garbled);
  bench.line.unplug();
  bench.step(1'000);
  EXPECT_EQ(state(), DeviceState::missing);
  bench.line.plug();
  bench.step(200'000);
  EXPECT_EQ(state(), DeviceState::silent);  // its earlier state no longer counts
}

TEST(DeviceSource, TellsADeviceThatMayNotBeOpenedFromOneThatIsNotThere) {
  int error = ENOENT;
  DeviceSource source(DeviceOptions{}, [&error] {
    errno = error;
    return -1;
  });
  std::int64_t now_us = 0;
  const auto state_with = [&](int wanted) {
    error = wanted;
    source.poll(now_us += 200'000);
    EXPECT_EQ(source.open_error(), wanted);
    return source.state();
  };
  for (const int absent : {ENOENT, ENOTDIR, ENODEV, ENXIO}) {
    EXPECT_EQ(state_with(absent), DeviceState::missing) << absent;
  }
  for (const int refused : {EACCES, EPERM, EBUSY, EIO}) {
    EXPECT_EQ(state_with(refused), DeviceState::refused) << refused;
  }
}

TEST(DeviceSource, OnePollTakesABoundedShareOfAFlood) {
  int pair[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair), 0);
  Descriptor far(pair[0]);
  const Bytes noise(4'096, 0x55);
  std::size_t sent = 0;
  while (::write(far.fd, noise.data(), noise.size()) > 0) sent += noise.size();
  ASSERT_GT(sent, 65'536u);
  const Descriptor watch(::dup(pair[1]));
  DeviceSource source(DeviceOptions{}, [&pair] { return std::exchange(pair[1], -1); });
  source.poll(0);
  std::size_t left = 0;
  Bytes rest(4'096);
  for (ssize_t got; (got = ::read(watch.fd, rest.data(), rest.size())) > 0;) {
    left += static_cast<std::size_t>(got);
  }
  EXPECT_EQ(sent - left, 16u * 1024);
  EXPECT_EQ(source.counters().bad, 1u);
}

struct Recording {
  std::string path = testing::TempDir() + "cabinet_recording_" + std::to_string(getpid());
  explicit Recording(const Bytes& bytes) {
    Descriptor file(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600));
    file.send(bytes);
  }
  ~Recording() { ::unlink(path.c_str()); }
};

void expect_paced(const std::function<Bytes(const wire::DeviceFrame&)>& coded) {
  SimulatedDevice device;
  Bytes bytes;
  for (int i = 0; i < 100; ++i) {
    device.slide[0] = 8 * i;
    const Bytes frame = coded(device.frame(i == 50 ? 30'000 : 4'000));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  const Recording recording(bytes);
  auto source = open_device("file:" + recording.path, nominal_calibration());
  ASSERT_TRUE(source.has_value()) << source.error();
  const std::int64_t start = 77'000;
  for (std::int64_t at = 0; at <= 99 * 4'000 + 26'000; at += 1'000) {
    (*source)->poll(start + at);
    const std::int64_t shown =
        at < 50 * 4'000 + 26'000 ? std::min<std::int64_t>(at / 4'000, 49) : (at - 26'000) / 4'000;
    ASSERT_NEAR(measured_slide((*source)->rods()[0]), 0.001 * static_cast<double>(shown), 1e-12)
        << at;
  }
  EXPECT_EQ((*source)->counters().frames, 100u);
  EXPECT_EQ((*source)->counters().bad, 0u);
  EXPECT_EQ((*source)->state(), DeviceState::over);
  // Played once: at its end the rods become held and stay so.
  for (int i = 1; i < 10; ++i) (*source)->poll(start + 500'000 + i * 300'000);
  EXPECT_EQ((*source)->rods()[0].status, RodStatus::held);
  EXPECT_EQ((*source)->counters().frames, 100u);
}

TEST(DeviceSource, PlaysASerialRecordingAtTheDevicesPace) {
  expect_paced(cobs);
}
TEST(DeviceSource, PlaysAHidRecordingAtTheDevicesPace) {
  expect_paced(report);
}

TEST(OpenDevice, RefusesWhatIsNoDeviceWithASentence) {
  const auto sentence = [](const std::string& address) {
    const auto source = open_device(address, nominal_calibration());
    return source ? std::string() : source.error();
  };
  for (const char* wrong : {"", "serial", "serial:", "usb:/dev/x", "/dev/ttyACM0", ":", "file:"}) {
    EXPECT_NE(sentence(wrong).find("is not a device: write serial:/dev/ttyACM0"), std::string::npos)
        << wrong << " -> " << sentence(wrong);
  }
  EXPECT_NE(sentence("file:/nowhere/a.bin").find("give the path of an existing recording"),
            std::string::npos);
  EXPECT_NE(sentence("file:/tmp").find("not a regular file"), std::string::npos);
  EXPECT_NE(sentence("serial:/tmp").find("not a device"), std::string::npos);
  EXPECT_NE(sentence("hid:/etc/passwd").find("for a recording write file:/etc/passwd"),
            std::string::npos);
}

TEST(OpenDevice, ADeviceNotThereYetIsNoError) {
  auto source = open_device("serial:/dev/no-such-tty", nominal_calibration());
  ASSERT_TRUE(source.has_value()) << source.error();
  (*source)->poll(0);
  EXPECT_FALSE((*source)->connected());
  EXPECT_EQ((*source)->name(), "serial:/dev/no-such-tty");
}

TEST(OpenDevice, ReadsAPtyByItsAddress) {
  SerialLine line;
  line.plug();
  auto source = open_device("serial:" + line.path, nominal_calibration());
  ASSERT_TRUE(source.has_value()) << source.error();
  std::int64_t now_us = 0;
  const auto poll_until_connected = [&](SimulatedDevice& device) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!(*source)->connected() && std::chrono::steady_clock::now() < end) {
      (void)line.master.send_what_fits(cobs(device.frame(1'000)));
      (*source)->poll(now_us += 1'000);
    }
    return (*source)->connected();
  };
  SimulatedDevice device;
  EXPECT_TRUE(poll_until_connected(device));

  // Hang-up: held at the next poll. The path then names no device, and nothing else happens.
  line.master.close();
  for (int i = 0; i < 1'000; ++i) (*source)->poll(now_us += 1'000);
  EXPECT_FALSE((*source)->connected());
  EXPECT_EQ((*source)->rods()[0].status, RodStatus::held);
}

// Before the first one is plugged in, the controller is unknown; the next one may be another.
TEST(OpenDevice, WhatIsPluggedInIsMeasuredByItsOwnCalibration) {
  const std::string link = testing::TempDir() + "sf_line_" + std::to_string(::getpid());
  std::filesystem::remove(link);
  std::atomic<int> asked{0};
  auto source = open_device("serial:" + link, nominal_calibration(), {}, [&asked] {
    Calibration own = nominal_calibration();
    own.rods[0].m[0][0] *= 2.0 + asked++;
    return std::optional(own);
  });
  ASSERT_TRUE(source.has_value()) << source.error();
  std::int64_t now_us = 0;
  double expected = 0;
  for (int turn = 0; turn < 2; ++turn) {
    SerialLine line;
    line.plug();
    std::filesystem::create_symlink(line.path, link);
    SimulatedDevice device;
    const auto poll_until = [&](const auto& done) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
      while (!done() && std::chrono::steady_clock::now() < end) {
        (void)line.master.send_what_fits(cobs(device.frame(1'000)));
        (*source)->poll(now_us += 1'000);
      }
      return done();
    };
    ASSERT_TRUE(poll_until([&] { return (*source)->connected(); }));
    device.slide[0] += 80;
    expected += (2.0 + turn) * 80 * kMetresPerCount;
    EXPECT_TRUE(poll_until([&] {
      return std::abs(measured_slide((*source)->rods()[0]) - expected) < 1e-9;
    })) << measured_slide((*source)->rods()[0])
        << " " << expected;
    std::filesystem::remove(link);
    line.master.close();
    EXPECT_TRUE(poll_until([&] { return !(*source)->connected(); }));
  }
}

TEST(OpenDevice, ARecordingIsInMemoryBeforeTheFirstPoll) {
  SimulatedDevice device;
  Bytes bytes;
  for (int i = 0; i < 5'000; ++i) {
    const Bytes frame = cobs(device.frame(1'000));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  auto recording = std::make_unique<Recording>(bytes);
  auto source = open_device("file:" + recording->path, nominal_calibration());
  ASSERT_TRUE(source.has_value()) << source.error();
  ASSERT_EQ(::truncate(recording->path.c_str(), 0), 0);
  recording.reset();
  for (int i = 0; i < 5'001; ++i) (*source)->poll(i * 1'000);
  EXPECT_EQ((*source)->counters().frames, 5'000u);
}

TEST(OpenDevice, RefusesARecordingThatIsTooLong) {
  const Recording recording({});
  ASSERT_EQ(::truncate(recording.path.c_str(), (64 << 20) + 1), 0);
  const auto source = open_device("file:" + recording.path, nominal_calibration());
  ASSERT_FALSE(source.has_value());
  EXPECT_NE(source.error().find("longer than 64 MiB"), std::string::npos);
}

}  // namespace
