// The calibration file, JSON; docs/cabinet.md has its schema.
#include "cabinet/calibration.h"

#include "calibration_check.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

namespace cabinet {
namespace {

using nlohmann::json;
using Failure = std::optional<std::string>;  // what is wrong and what to do

constexpr int kVersion = 3;  // 1 had no gains and no dead band, 2 no serial number and no date
// Eight rods take 2 KiB; a much longer file is something else.
constexpr std::size_t kMaxBytes = 64 * 1024;
// Known sensors: from PS/2 at 1 count/mm to a PMW3360 at 12000 counts per inch (472 per mm). On
// rods of 16 mm, a count of length l along the surface turns the rod by l / 8 mm. A file may exceed
// this range by a factor of 4.
constexpr double kMinMetres = 1e-3 / 472 / 4, kMaxMetres = 1e-3 * 4;
// Minimum sine of the angle between the two rows (1 for a square sensor): below it, slide and spin
// cannot be distinguished.
constexpr double kMinSine = 0.01;
// Limit for an eccentric rod. At half, the rod comes a third closer and recedes as much: it would
// grind.
constexpr double kMaxGain = 0.5;
// A magnet of 6 mm on a collar of 34 mm is on for a fifteenth of a turn.
constexpr double kMinMark = 0.01, kMaxMark = 1.6;  // [rad] wide
constexpr double kMaxDeadBand = 4000;              // [counts / s] 50 mm/s at 78.7 counts/mm
// Counts further apart belong to two motions, the second of which has just started.
constexpr double kLongestMotion = 0.05;  // [s] ten reports of a PS/2 mouse

constexpr std::size_t kMaxWord = 64;  // bytes

const char* const kSerialKey = "serial";
const char* const kMadeKey = "made";
const char* const kSlideKey = "slide_m_per_count";
const char* const kAngleKey = "angle_rad_per_count";
const char* const kSlideGainKey = "slide_gain";
const char* const kSpinGainKey = "spin_gain";
const char* const kDeadBandKey = "dead_band_counts_per_s";
const char* const kIndexAngleKey = "index_angle_rad";
const char* const kIndexWidthKey = "index_width_rad";
const char* const kIndexLagKey = "index_lag_rad";

std::string millimetres(double metres) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g mm", metres * 1e3);
  return text.data();
}

}  // namespace

Failure check_rod(const RodCalibration& rod) {
  const double slide = std::hypot(rod.m[0][0], rod.m[0][1]);
  const double arc = std::hypot(rod.m[1][0], rod.m[1][1]) * kRodRadius;
  const double determinant = rod.m[0][0] * rod.m[1][1] - rod.m[0][1] * rod.m[1][0];
  if (!std::isfinite(slide) || !std::isfinite(arc)) {
    return "has a value that is not a finite number; calibrate it again";
  }
  if (slide == 0 || arc == 0 || std::abs(determinant) * kRodRadius < kMinSine * slide * arc) {
    return "is singular: slide and angle follow the same counts; check that the sensor sees both "
           "motions and calibrate it again";
  }
  if (slide < kMinMetres || slide > kMaxMetres || arc < kMinMetres || arc > kMaxMetres) {
    return "has an impossible scale: " + millimetres(slide) + " along the rod and " +
           millimetres(arc) + " around it a count, where " + millimetres(kMinMetres) + " to " +
           millimetres(kMaxMetres) +
           " are possible; write metres and radians per count, as in "
           "cabinet/calibration.example.json";
  }
  for (const auto& gain : {rod.slide_gain, rod.spin_gain}) {
    if (!(std::hypot(gain[0], gain[1]) <= kMaxGain)) {
      return "has a gain above 0.5 in a turn, which no eccentric rod has; mount the sensor so that "
             "its distance stays the same while the rod turns, and calibrate it again";
    }
  }
  if (!(rod.dead_band >= 0 && rod.dead_band <= kMaxDeadBand)) {
    return "has a dead band out of 0 to 4000 counts a second; calibrate it again";
  }
  if (rod.index &&
      !(std::abs(rod.index->angle) <= 2 * M_PI && rod.index->width >= kMinMark &&
        rod.index->width <= kMaxMark && std::abs(rod.index->lag) <= rod.index->width)) {
    return "has an impossible index mark: its centre must be within a turn, its width 0.01 to 1.6 "
           "radians, its lag at most its width; calibrate it again, or omit the mark";
  }
  return {};
}

namespace {

Failure check(const Calibration& calibration) {
  for (int rod = 0; rod < kRods; ++rod) {
    if (const Failure wrong = check_rod(calibration.rods[rod])) {
      return "(rod " + std::to_string(rod + 1) + ") " + *wrong;
    }
  }
  return {};
}

Failure read_row(const json& rod, const char* key, double (&row)[2]) {
  const auto found = rod.find(key);
  if (found == rod.end() || !found->is_array() || found->size() != 2 || !(*found)[0].is_number() ||
      !(*found)[1].is_number()) {
    return std::string("has no \"") + key +
           "\" of two numbers; see cabinet/calibration.example.json";
  }
  row[0] = (*found)[0].get<double>();
  row[1] = (*found)[1].get<double>();
  return {};
}

// Of a rod in version 2; missing values are zero.
Failure read_corrections(const json& rod, RodCalibration& calibration) {
  Failure wrong;
  if (rod.contains(kSlideGainKey)) wrong = read_row(rod, kSlideGainKey, calibration.slide_gain);
  if (!wrong && rod.contains(kSpinGainKey)) {
    wrong = read_row(rod, kSpinGainKey, calibration.spin_gain);
  }
  const auto band = rod.find(kDeadBandKey);
  if (wrong || band == rod.end()) return wrong;
  if (!band->is_number()) {
    return std::string("has a \"") + kDeadBandKey + "\" that is no number; write 0 or leave it out";
  }
  calibration.dead_band = band->get<double>();
  return {};
}

Failure read_number(const json& rod, const char* key, double& number) {
  const auto found = rod.find(key);
  if (found == rod.end() || !found->is_number()) {
    return std::string("has no number \"") + key +
           "\", which its index mark needs; calibrate it again, or leave the mark out";
  }
  number = found->get<double>();
  return {};
}

// If missing, the rod has no mark.
Failure read_index(const json& rod, RodCalibration& calibration) {
  if (!rod.contains(kIndexAngleKey)) return {};
  IndexMark mark{};
  Failure wrong = read_number(rod, kIndexAngleKey, mark.angle);
  if (!wrong) wrong = read_number(rod, kIndexWidthKey, mark.width);
  if (!wrong && rod.contains(kIndexLagKey)) wrong = read_number(rod, kIndexLagKey, mark.lag);
  calibration.index = mark;
  return wrong;
}

// If missing, it stays empty.
Failure read_word(const json& file, const char* key, std::string& word) {
  const auto found = file.find(key);
  if (found == file.end()) return {};
  if (!found->is_string() || found->get_ref<const std::string&>().size() > kMaxWord) {
    return std::string("has a \"") + key + "\" that is no text of up to 64 bytes; leave it out";
  }
  word = found->get<std::string>();
  return {};
}

Failure read_json(const json& file, Calibration& calibration) {
  if (!file.is_object()) return "is not a calibration; see cabinet/calibration.example.json";
  const auto version = file.find("version");
  if (version == file.end() || !version->is_number_integer() || *version < 1) {
    return "has no \"version\": 3; write it with this program or see "
           "cabinet/calibration.example.json";
  }
  if (*version > kVersion) {
    return "is of version " + version->dump() +
           ", this program reads up to 3; calibrate again, or "
           "take a newer program";
  }
  if (const Failure wrong = read_word(file, kSerialKey, calibration.serial)) return wrong;
  if (const Failure wrong = read_word(file, kMadeKey, calibration.made)) return wrong;
  const auto rods = file.find("rods");
  const std::size_t count = rods != file.end() && rods->is_array() ? rods->size() : 0;
  if (count != kRods) {
    return "has " + std::to_string(count) +
           " rods instead of 8; list all eight, from team 0's goal";
  }
  for (int i = 0; i < kRods; ++i) {
    const json& rod = (*rods)[static_cast<std::size_t>(i)];
    Failure wrong;
    if (!rod.is_object()) wrong = "is not an object; see cabinet/calibration.example.json";
    if (!wrong) wrong = read_row(rod, kSlideKey, calibration.rods[i].m[0]);
    if (!wrong) wrong = read_row(rod, kAngleKey, calibration.rods[i].m[1]);
    if (!wrong && *version > 1) wrong = read_corrections(rod, calibration.rods[i]);
    if (!wrong) wrong = read_index(rod, calibration.rods[i]);
    if (wrong) return "(rod " + std::to_string(i + 1) + ") " + *wrong;
  }
  return check(calibration);
}

std::string sentence(const std::string& name, const std::string& what) {
  return "Calibration " + name + " " + what + ".";
}

std::string system_error() {
  return std::strerror(errno);
}

struct File {  // closes its descriptor
  int fd;
  ~File() {
    if (fd >= 0) ::close(fd);
  }
};

tl::expected<std::string, std::string> read_text(const std::string& path) {
  const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat about {};
  if (file.fd < 0 || fstat(file.fd, &about) != 0) {
    return tl::unexpected(sentence(
        path, "cannot be opened (" + system_error() +
                  "); give an existing file, or copy cabinet/calibration.example.json there"));
  }
  if (!S_ISREG(about.st_mode)) return tl::unexpected(sentence(path, "is not a file; give one"));
  std::string text(kMaxBytes + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t got = ::read(file.fd, text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      return tl::unexpected(sentence(path, "cannot be read (" + system_error() + "); try again"));
    }
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  text.resize(size);
  return text;
}

bool write_whole(int fd, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t put = ::write(fd, text.data() + done, text.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    done += static_cast<std::size_t>(put);
  }
  return ::fsync(fd) == 0;
}

}  // namespace

RodMotion RodIntegrator::add(double slide_counts, double spin_counts, double seconds,
                             double angle) {
  double counts[2] = {slide_counts, spin_counts};
  for (int axis = 0; axis < 2; ++axis) {
    still_[axis] = std::min(still_[axis] + seconds, kLongestMotion);
    if (counts[axis] == 0) continue;
    counts[axis] += (counts[axis] > 0 ? 1 : -1) * calibration_.dead_band * still_[axis];
    still_[axis] = 0;
  }
  const auto& m = calibration_.m;
  const double along = m[0][0] * counts[0] + m[0][1] * counts[1];
  const double around = m[1][0] * counts[0] + m[1][1] * counts[1];
  const double middle = angle + 0.5 * around;
  const double c = std::cos(middle), s = std::sin(middle);
  return {(1 + calibration_.slide_gain[0] * c + calibration_.slide_gain[1] * s) * along,
          (1 + calibration_.spin_gain[0] * c + calibration_.spin_gain[1] * s) * around};
}

Calibration nominal_calibration(double counts_per_mm, double rod_diameter) {
  const double metres = 1e-3 / counts_per_mm;
  Calibration calibration{};
  for (RodCalibration& rod : calibration.rods) {
    rod.m[0][0] = metres;
    rod.m[1][1] = metres / (0.5 * rod_diameter);
  }
  return calibration;
}

tl::expected<Calibration, std::string> parse_calibration(std::string_view text,
                                                         const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return tl::unexpected(sentence(
        name, "is empty; calibrate again, or copy cabinet/calibration.example.json there"));
  }
  if (text.size() > kMaxBytes) {
    return tl::unexpected(sentence(name, "is longer than 64 KiB: not a calibration; give another"));
  }
  json file;
  try {
    file = json::parse(text);
  } catch (const json::exception& error) {
    // Also fails for a number too large for a double.
    const auto* const at = dynamic_cast<const json::parse_error*>(&error);
    return tl::unexpected(sentence(
        name, "is not JSON" + (at != nullptr ? " at byte " + std::to_string(at->byte) : "") +
                  ", or has a number out of range; correct it, or calibrate again"));
  }
  Calibration calibration{};
  if (const Failure wrong = read_json(file, calibration)) {
    return tl::unexpected(sentence(name, *wrong));
  }
  return calibration;
}

tl::expected<Calibration, std::string> load_calibration(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return tl::unexpected(text.error());
  return parse_calibration(*text, path);
}

tl::expected<void, std::string> save_calibration(const Calibration& calibration,
                                                 const std::string& path) {
  if (const Failure wrong = check(calibration)) {
    return tl::unexpected(sentence(path, "was not written: it " + *wrong));
  }
  json file{{"version", kVersion}, {"rods", json::array()}};
  if (!calibration.serial.empty()) file[kSerialKey] = calibration.serial;
  if (!calibration.made.empty()) file[kMadeKey] = calibration.made;
  for (const RodCalibration& rod : calibration.rods) {
    file["rods"].push_back(json{{kSlideKey, {rod.m[0][0], rod.m[0][1]}},
                                {kAngleKey, {rod.m[1][0], rod.m[1][1]}},
                                {kSlideGainKey, {rod.slide_gain[0], rod.slide_gain[1]}},
                                {kSpinGainKey, {rod.spin_gain[0], rod.spin_gain[1]}},
                                {kDeadBandKey, rod.dead_band}});
    if (!rod.index) continue;
    json& written = file["rods"].back();
    written[kIndexAngleKey] = rod.index->angle;
    written[kIndexWidthKey] = rod.index->width;
    written[kIndexLagKey] = rod.index->lag;
  }
  const std::string beside = path + ".new";
  {
    const File out{::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (out.fd >= 0 && write_whole(out.fd, file.dump(2) + "\n") &&
        ::rename(beside.c_str(), path.c_str()) == 0) {
      return {};
    }
  }
  const std::string why = system_error();
  ::unlink(beside.c_str());
  return tl::unexpected(
      sentence(path, "cannot be written (" + why + "); give a folder you may write to"));
}

}  // namespace cabinet
