// Runs the program on a real serial line (a pty), on the terminal, with a simulated controller and
// person at the other end.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "cabinet/calibration.h"
#include "foosball/table.h"
#include "simulated_device.h"
#include "simulated_person.h"

namespace {

using namespace cabinet_test;

class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    int in[2], out[2];
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDERR_FILENO);
    words.insert(words.begin(), CALIBRATE_PROGRAM);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0)
      pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(out[1]);
    keys_ = in[1];
    words_ = out[0];
  }
  ~Program() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    end_input();
    close(words_);
  }
  void end_input() {
    if (keys_ >= 0) close(keys_);
    keys_ = -1;
  }
  void type(const char* line) {
    const std::string text = std::string(line) + "\n";
    ASSERT_EQ(write(keys_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  // By now, or within 10 ms.
  bool has_said(const std::string& text) {
    pollfd ready{words_, POLLIN, 0};
    if (poll(&ready, 1, 10) > 0) read_output();
    return said_.find(text) != std::string::npos;
  }
  // After the text found last.
  bool says(const std::string& text) {
    while (said_.find(text, found_) == std::string::npos)
      if (!read_output()) return false;
    found_ = said_.find(text, found_) + text.size();
    return true;
  }
  int wait() {
    if (!says_its_last()) kill(pid_, SIGKILL);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  const std::string& said() const { return said_; }

 private:
  // False: the output continues for longer than the time limit.
  bool says_its_last() {
    while (read_output()) {
    }
    return ended_;
  }
  bool read_output() {
    pollfd ready{words_, POLLIN, 0};
    char bytes[4096];
    if (poll(&ready, 1, 20'000) <= 0) return false;
    const ssize_t got = read(words_, bytes, sizeof bytes);
    ended_ = got <= 0;
    if (!ended_) said_.append(bytes, static_cast<std::size_t>(got));
    return !ended_;
  }

  pid_t pid_ = -1;
  int keys_ = -1, words_ = -1;
  bool ended_ = false;
  std::size_t found_ = 0;
  std::string said_;
};

std::string temp_path(const char* name) {
  return testing::TempDir() + "calibrate_" + std::to_string(getpid()) + "_" + name;
}

TEST(CalibrateProgram, GuidesOverASerialLineAndKeepsTheCalibration) {
  SerialLine line;
  line.plug();
  const std::string path = temp_path("c.json");
  unlink(path.c_str());
  Program program({"--device", "serial:" + line.path, "--rods", "2", "--text", "--out", path,
                   "--language", "en"});
  const auto& spec = foosball::table_spec(foosball::Layout::tournament).rods[1];
  const cabinet::GuideOptions options{.reach = spec.slide_limit,
                                      .push_side = foosball::push_sign(spec.team),
                                      .forward_sign = -foosball::attack_sign(spec.team)};
  cabinet::CalibrationGuide guide(options);
  SimulatedRod rod({.counts_per_mm = 39.4, .tilt = 0.05, .scale = 1.02}, 5);
  // At the stop already: keys may overtake data still on the line.
  rod.slide = -options.push_side * options.reach;
  Person person(guide, rod, options);
  SimulatedDevice device;
  // Until the program has opened the line and has received data from the controller.
  for (int i = 0; i < 2000 && !program.has_said("press Enter.\n"); ++i)
    line.master.send_what_fits(cobs(device.frame(5'000)));
  ASSERT_TRUE(program.says("press Enter.\n")) << program.said();
  const int flags = fcntl(line.master.fd, F_GETFL);
  fcntl(line.master.fd, F_SETFL, flags & ~O_NONBLOCK);
  const auto send = [&](const cabinet::CountIncrement& c) {
    device.slide[1] += c.slide;
    device.spin[1] += c.spin;
    const Bytes bytes = cobs(device.frame(5'000));
    // The program reads until it exits; this write waits only for the program.
    ASSERT_EQ(write(line.master.fd, bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  };
  person.on_counts = send;
  person.on_start = [&] {
    program.type("");
    ASSERT_TRUE(program.says("2/29")) << program.said();
  };
  person.follow();
  EXPECT_EQ(program.wait(), 0) << program.said();
  EXPECT_NE(program.said().find("along the rod"), std::string::npos) << program.said();
  const auto calibration = cabinet::load_calibration(path);
  ASSERT_TRUE(calibration) << calibration.error();
  const auto& m = calibration->rods[1].m;
  EXPECT_NEAR(std::hypot(m[0][0], m[0][1]) * 39.4e3 * 1.02, 1, 0.005);
  EXPECT_NEAR(std::atan2(m[0][1], m[0][0]), -0.05, 0.003);
  EXPECT_EQ(calibration->made.size(), 20u) << calibration->made;
  unlink(path.c_str());
}

TEST(CalibrateProgram, EndsWhenItsInputDoes) {
  SerialLine line;
  line.plug();
  Program program({"--device", "serial:" + line.path, "--text", "--out", temp_path("ended.json")});
  ASSERT_TRUE(program.says("Enter: mark")) << program.said();
  program.end_input();
  EXPECT_EQ(program.wait(), 1) << program.said();
  EXPECT_NE(program.said().find("its input has ended"), std::string::npos) << program.said();
}

TEST(CalibrateProgram, SaysWhatItCannotDoInOneSentence) {
  const std::string broken = temp_path("broken.json");
  std::ofstream(broken) << "{";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {},
           {"--device", "mouse"},
           {"--device", "file:/nowhere"},
           {"--device", "serial:/dev/null9", "--rods", "9"},
           {"--device", "serial:/dev/null9", "--rods", "1.5"},
           {"--device", ""},
           {"--device", "file:" + broken},
           {"--device", "serial:/dev/null9", "--out", "/tmp/" + std::string(300, 'x')},
           {"--device", "serial:/dev/null9", "--out", "/nowhere/c.json"},
           {"--device", "serial:/dev/null9", "--out", broken}}) {
    Program program(words);
    EXPECT_EQ(program.wait(), 2) << program.said();
    EXPECT_EQ(program.said().rfind("space-foosball-calibrate: ", 0), 0u) << program.said();
    EXPECT_EQ(std::count(program.said().begin(), program.said().end(), '\n'), 1) << program.said();
  }
  unlink(broken.c_str());
}

}  // namespace
