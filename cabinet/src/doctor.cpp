#include "cabinet/doctor.h"

#include <sys/stat.h>

#include <optional>
#include <utility>

#include "cabinet/controller.h"
#include "doctor_find.h"
#include "doctor_judge.h"
#include "doctor_listen.h"
#include "os/time_of_day.h"

namespace cabinet {
namespace {

constexpr double kSecondsOfDay = 86'400;

// By the date in the file: a copy, or a file from another machine, is not younger than that.
double age_in_days(const Calibration& calibration, const std::string& path, std::int64_t now_s) {
  struct stat about {};
  std::optional<std::int64_t> made_s = os::utc_seconds(calibration.made);
  if (!made_s && ::stat(path.c_str(), &about) == 0) made_s = about.st_mtime;
  return static_cast<double>(now_s - made_s.value_or(now_s)) / kSecondsOfDay;
}

// The calibration read, and the result to report.
struct ReadCalibration {
  std::optional<Calibration> calibration;
  CalibrationCheck check;
};

ReadCalibration read_calibration(const std::string& path, std::int64_t now_s) {
  ReadCalibration read;
  read.check.path = path;
  auto loaded = load_calibration(path);
  if (!loaded) {
    read.check.error = loaded.error();
    while (read.check.error.ends_with('.')) read.check.error.pop_back();
    return read;
  }
  read.check.days = age_in_days(*loaded, path, now_s);
  read.calibration = std::move(*loaded);
  return read;
}

}  // namespace

Diagnosis examine(const DoctorOptions& options) {
  Diagnosis diagnosis;
  diagnosis.devices = find_devices(options);
  std::optional<ReadCalibration> named;
  if (!options.calibration.empty()) {
    named = read_calibration(options.calibration, options.now_s);
    diagnosis.calibrations.push_back(named->check);
  }
  for (FoundDevice& device : diagnosis.devices) {
    if (!is_controller(device) || !device.listens) continue;
    std::optional<ReadCalibration> own = named;
    const std::string kept = named ? "" : kept_calibration(options.calibrations, device.serial);
    if (!kept.empty()) {
      own = read_calibration(kept, options.now_s);
      own->check.device = address_of(device);
      diagnosis.calibrations.push_back(own->check);
    }
    device.calibrated = own.has_value();
    if (own && own->calibration)
      device.calibration_conflict = serial_conflict(*own->calibration, device.serial);
    if (device.error != 0) continue;
    listen_to_controller(
        device, own && own->calibration ? *own->calibration : nominal_calibration(), options);
  }
  listen_to_inputs(diagnosis.devices, options);
  diagnosis.troubles = troubles_of(diagnosis);
  return diagnosis;
}

}  // namespace cabinet
