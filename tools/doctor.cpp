// space-foosball-doctor: lists the connected devices that can move rods, and says how to fix
// problems.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>

#include "cabinet/controller.h"
#include "cabinet/doctor.h"
#include "server/exit_code.h"
#include "server/option_checks.h"

namespace {

std::string without_stop(std::string sentence) {
  if (sentence.ends_with('.')) sentence.pop_back();
  return sentence;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{
      "Lists the connected devices that can move rods: controllers, mice, gamepads; listens to\n"
      "them while nobody touches the rods; and prints a remedy for every fault. It opens the\n"
      "serial ports of boards that our firmware is for, and no other unless --device names it.\n\n"
      "Exit codes: 0 no fault; 1 faults found; 2 a bad option.",
      "space-foosball-doctor"};
  cabinet::DoctorOptions options;
  std::vector<std::string> devices;
  bool json = false;
  cli.add_flag("--json", json, "print one JSON object");
  cli.add_option("--device", devices,
                 "also examine this device: serial:/dev/ttyUSB0, hid:/dev/hidraw0 or "
                 "evdev:/dev/input/event5; may be given more than once")
      ->check([](const std::string& text) {
        const auto address = cabinet::parse_doctor_address(text);
        return address ? std::string() : without_stop(address.error());
      });
  cli.add_option(
      "--calibration", options.calibration,
      "calibration of the cabinet's sensors; default: the one stored for each controller");
  cli.add_option("--seconds", options.seconds,
                 "time to listen to each controller, and then to all mice and gamepads together, "
                 "in seconds")
      ->check(CLI::Range(0.1, 3600.0))
      ->check(server::check_not_nan)
      ->capture_default_str();
  cli.add_option("--dev", options.dev, "folder of the device files")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  cli.add_option("--sys", options.sys, "folder in which the kernel describes them")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(cli.help().c_str(), stdout);
    return server::kExitOk;
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "space-foosball-doctor: %s; --help explains the options\n", error.what());
    return server::kExitUsage;
  }
  for (const std::string& device : devices)
    options.devices.push_back(*cabinet::parse_doctor_address(device));
  if (::isatty(STDERR_FILENO) != 0)
    std::fputs("Listening: leave rods, mice and sticks alone.\n", stderr);
  options.calibrations = cabinet::calibrations_folder();
  options.now_s = std::time(nullptr);
  const cabinet::Diagnosis diagnosis = cabinet::examine(options);
  const std::string text =
      json ? cabinet::diagnosis_json(diagnosis) : cabinet::diagnosis_text(diagnosis);
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) return server::kExitFailed;
  return diagnosis.troubles.empty() ? server::kExitOk : server::kExitFailed;
}
