// The Pico in rp2040js, which runs in node beside this program: firmware/tests/rp2040/lockstep.mjs.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "controller.h"
#include "os/file_descriptor.h"

extern char** environ;

namespace cabinet_bench {
namespace {

using nlohmann::json;

std::string hex(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

struct Pipe {
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to the simulator");
    reading = os::FileDescriptor(ends[0]);
    writing = os::FileDescriptor(ends[1]);
  }
  os::FileDescriptor reading, writing;
};

// node with a script: lines in, lines out.
class Script {
 public:
  Script(const std::string& folder, const std::string& script, const std::string& firmware) {
    ::signal(SIGPIPE, SIG_IGN);
    Pipe in, out;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in.reading.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out.writing.get(), STDOUT_FILENO);
    std::string path = folder + "/" + script, image = "FIRMWARE_UF2=" + firmware, node = NODE;
    char* arguments[] = {node.data(), path.data(), nullptr};
    std::vector<char*> environment{image.data()};
    for (char** word = environ; *word != nullptr; ++word) environment.push_back(*word);
    environment.push_back(nullptr);
    const int failed = ::posix_spawn(&pid_, NODE, &actions, nullptr, arguments, environment.data());
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("node does not start: " + std::string(NODE));
    to_ = std::move(in.writing);
    from_ = std::move(out.reading);
  }
  ~Script() {
    to_.reset();
    ::waitpid(pid_, nullptr, 0);
  }
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;

  std::string ask(std::string line) {
    line += '\n';
    for (std::size_t sent = 0; sent < line.size();) {
      const ssize_t wrote = ::write(to_.get(), line.data() + sent, line.size() - sent);
      if (wrote <= 0) throw std::runtime_error("the simulator of the RP2040 has ended");
      sent += static_cast<std::size_t>(wrote);
    }
    return answer();
  }

 private:
  std::string answer() {
    for (;;) {
      const std::size_t end = received_.find('\n');
      if (end != std::string::npos) {
        std::string line = received_.substr(0, end);
        received_.erase(0, end + 1);
        return line;
      }
      char piece[65536];
      const ssize_t got = ::read(from_.get(), piece, sizeof piece);
      if (got <= 0) throw std::runtime_error("the simulator of the RP2040 has ended");
      received_.append(piece, static_cast<std::size_t>(got));
    }
  }

  pid_t pid_ = -1;
  os::FileDescriptor to_, from_;
  std::string received_;
};

class Rp2040Controller final : public Controller {
 public:
  Rp2040Controller() : script_(RP2040_SCRIPTS, "lockstep.mjs", FIRMWARE_UF2) {}

  void advance(const PerRod<Surface>& to) override {
    json surfaces = json::array();
    for (const Surface& surface : to) {
      surfaces.push_back(surface.slide);
      surfaces.push_back(surface.spin);
    }
    request_["to"] = std::move(surfaces);
    take(json::parse(script_.ask(request_.dump())));
    request_ = json::object();
  }
  void show_marks(std::uint8_t under) override { request_["marks"] = under; }
  std::int64_t now_us() const override { return now_us_; }
  cabinet::DeviceFraming framing() const override { return cabinet::DeviceFraming::report; }
  std::vector<Packet> take_packets() override { return std::exchange(packets_, {}); }

  void command(std::span<const std::uint8_t> packet) override {
    request_["commands"].push_back(hex(packet.subspan(1)));  // without the report's number
  }
  std::vector<MotorWrite> take_motor_writes() override { return std::exchange(motors_, {}); }

  std::vector<Told> take_told(int rod) override {
    return std::exchange(told_[static_cast<std::size_t>(rod)], {});
  }
  std::string trouble(int rod, std::mt19937& random) override;

 private:
  void take(const json& answer) {
    now_us_ = answer.at("now");
    if (!answer.at("faults").empty()) {
      throw std::runtime_error("the RP2040's program does what it may not: " +
                               answer.at("faults").dump());
    }
    for (const json& packet : answer.at("packets")) {
      packets_.push_back({packet[0], bytes_of(packet[1])});
    }
    for (const json& write : answer.at("motors")) motors_.push_back({write[0], write[1], write[2]});
    for (const json& told : answer.at("told")) {
      told_[told[0].get<std::size_t>()].push_back({told[1], told[2], told[3]});
    }
  }

  Script script_;
  json request_ = json::object();
  std::int64_t now_us_ = 0;
  std::vector<Packet> packets_;
  std::vector<MotorWrite> motors_;
  PerRod<std::vector<Told>> told_;
};

std::string Rp2040Controller::trouble(int rod, std::mt19937& random) {
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const auto ask = [&](json trouble) {
    trouble["rod"] = rod;
    request_["troubles"].push_back(std::move(trouble));
  };
  switch (below(7)) {
    case 0:
      ask({{"kind", "unplug"}, {"ms", 1 + below(20)}});
      return "plug that jumps";
    case 1:
      ask({{"kind", "unplug"}, {"ms", 100 + below(1000)}});
      return "unplugged or replaced";
    case 2:
      ask({{"kind", "supply"}});
      return "supply of a sensor lost";
    case 3:
      ask({{"kind", "stuck"}, {"ms", 1 + below(5)}, {"level", below(2) == 0}});
      return "data line stuck for a moment";
    case 4:
      ask({{"kind", "stuck"}, {"ms", 50 + below(500)}, {"level", below(2) == 0}});
      return "data line stuck";
    case 5:
      if (below(4) != 0) return {};
      ask({{"kind", "hang"}});
      return "watchdog reset";
    default:
      return {};
  }
}

}  // namespace

std::unique_ptr<Controller> power_on_rp2040() {
  return std::make_unique<Rp2040Controller>();
}

}  // namespace cabinet_bench
