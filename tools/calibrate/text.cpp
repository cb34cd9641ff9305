#include "text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "render/translate.h"

namespace calibrate {
namespace {

using client::tr;
using Motion = cabinet::CalibrationRequest::Motion;

constexpr double kDegrees = 180 / M_PI;

std::string with(std::string text, const std::string& word) {
  if (const auto at = text.find("%1"); at != std::string::npos) text.replace(at, 2, word);
  return text;
}

const char* sentence(const cabinet::CalibrationRequest& asked) {
  switch (asked.motion) {
    case Motion::start:
      return N_(
          "Pull the rod towards you to its stop. Let the feet hang straight down. Then press "
          "Enter.");
    case Motion::to_and_fro:
      return N_("Push the rod to its other stop and pull it back, %1 times.");
    case Motion::push:
      return asked.slowly ? N_("Push slowly to the far stop, the feet straight down. Hold still.")
                          : N_("Push to the far stop, the feet straight down. Hold still.");
    case Motion::pull:
      return asked.slowly ? N_("Pull slowly to the near stop, the feet straight down. Hold still.")
                          : N_("Pull to the near stop, the feet straight down. Hold still.");
    case Motion::turn_and_push:
      return N_(
          "Turn the feet forward by an eighth of a turn, then push to the far stop. Hold "
          "still.");
    case Motion::pull_as_turned:
      return N_("Pull to the near stop, the feet as they are. Hold still.");
    case Motion::turn_feet_down:
      return N_(
          "Stay at the stop and turn the feet on, until they hang straight down. Hold still.");
    case Motion::turn_forward:
      return N_(
          "Stay at the stop and turn the rod forward %1 times, to the feet straight down. "
          "Hold still.");
    case Motion::turn_back:
      return N_(
          "Stay at the stop and turn the rod back %1 times, to the feet straight down. Hold "
          "still.");
  }
  return "";
}

const char* sentence(cabinet::GuideAdvice advice) {
  switch (advice) {
    case cabinet::GuideAdvice::none:
      return "";
    case cabinet::GuideAdvice::further:
      return N_("Further: the rod is not at the stop.");
    case cabinet::GuideAdvice::turn_more:
      return N_("Turn it further.");
    case cabinet::GuideAdvice::wrong_way:
      return N_("Wrong direction: turn it back, and continue.");
    case cabinet::GuideAdvice::feet_down:
      return N_("Let the feet hang straight down.");
  }
  return "";
}

const char* line_sentence(const Session& session) {
  switch (session.line()) {
    case cabinet::DeviceState::missing:
      return N_("The controller is not connected: plug it in.");
    case cabinet::DeviceState::refused:
      return session.line_error() == EBUSY ? N_("Another program uses the controller: end the "
                                                "server, or the other calibration.")
                                           : N_("The controller cannot be opened: install "
                                                "cabinet/70-space-foosball.rules, or "
                                                "join the device's group.");
    case cabinet::DeviceState::garbled:
      return N_("The controller sends no valid frames: is it the right device, with our firmware?");
    case cabinet::DeviceState::over:
      return N_("The recording is over.");
    case cabinet::DeviceState::silent:
      return N_("The controller sends nothing: plug it in again.");
    case cabinet::DeviceState::live:
      break;
  }
  return "";
}

std::string row(const char* name, double value, double deviation, const char* unit) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "%-22s %10.4g +- %-8.2g %s", tr(name), value, deviation,
                unit);
  return text.data();
}

}  // namespace

std::string rod_text(foosball::Layout layout, int rod) {
  const foosball::TableSpec& table = foosball::table_spec(layout);
  const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
  constexpr std::array<const char*, 4> kLines{N_("goalkeeper"), N_("defence"), N_("midfield"),
                                              N_("attack")};
  std::string text = with(tr(N_("Rod %1 of 8")), std::to_string(rod + 1));
  text += std::string(": ") + tr(kLines[static_cast<std::size_t>(spec.line)]);
  return text + ", " + tr(spec.team == 0 ? N_("orange") : N_("blue"));
}

std::string request_text(const Session& session) {
  switch (session.state(session.rod())) {
    case RodState::refused:
      return session.problem() + " " + tr(N_("Press Enter to start this rod again."));
    case RodState::fitted:
      return tr(session.all_fitted()
                    ? N_("All rods are calibrated, and their numbers are stored. Leave with Esc.")
                    : N_("This rod is calibrated, and its numbers are stored. Enter: the next rod; "
                         "Backspace: this one again."));
    default:
      break;
  }
  const cabinet::CalibrationRequest asked = session.guide().request();
  return with(tr(sentence(asked)), std::to_string(asked.times));
}

std::string advice_text(const Session& session) {
  if (const char* line = line_sentence(session); *line != '\0') return tr(line);
  if (!session.sensor_answers())
    return tr(N_("The sensor of this rod does not answer: look at its cable."));
  if (session.state(session.rod()) != RodState::guided) return {};
  if (session.interrupted())
    return tr(N_("The controller or its sensor was disconnected: start this rod again."));
  if (const int other = session.other_rod_moves(); other >= 0)
    return with(tr(N_("Rod %1 moves, but another one is being calibrated.")),
                std::to_string(other + 1));
  const char* text = sentence(session.guide().advice());
  return *text == '\0' ? "" : tr(text);
}

std::vector<std::string> fit_text(const cabinet::RodFit& fit) {
  const cabinet::RodCalibration& c = fit.calibration;
  const auto& d = fit.deviation;
  // Of the larger component of each pair: a sensor may be mounted at any angle.
  const double along = std::hypot(c.m[0][0], c.m[0][1]), around = std::hypot(c.m[1][0], c.m[1][1]);
  const auto spread = [](double a, double b, double da, double db) {
    const double length = std::hypot(a, b);
    return length > 0 ? std::hypot(a * da, b * db) / length : std::hypot(da, db);
  };
  const double tilt = std::atan2(c.m[0][1], c.m[0][0]);
  std::vector<std::string> lines;
  lines.push_back(row(N_("along the rod"), along * 1e6,
                      spread(c.m[0][0], c.m[0][1], d[0], d[1]) * 1e6, "um/count"));
  lines.push_back(row(N_("around the rod"), around * kDegrees,
                      spread(c.m[1][0], c.m[1][1], d[2], d[3]) * kDegrees, "deg/count"));
  lines.push_back(row(N_("tilt of the sensor"), tilt * kDegrees,
                      spread(c.m[0][1], c.m[0][0], d[0], d[1]) / along * kDegrees, "deg"));
  lines.push_back(row(N_("eccentric, along"), std::hypot(c.slide_gain[0], c.slide_gain[1]) * 100,
                      spread(c.slide_gain[0], c.slide_gain[1], d[4], d[5]) * 100, "%"));
  lines.push_back(row(N_("eccentric, around"), std::hypot(c.spin_gain[0], c.spin_gain[1]) * 100,
                      spread(c.spin_gain[0], c.spin_gain[1], d[6], d[7]) * 100, "%"));
  lines.push_back(row(N_("dead band"), c.dead_band, d[8], "counts/s"));
  if (c.index)
    lines.push_back(
        row(N_("index mark"), c.index->angle * kDegrees, fit.index_deviation * kDegrees, "deg"));
  else if (fit.index_passes > 0)
    lines.emplace_back(
        tr(N_("Index mark: its passes differ. Are its magnet and its switch firm?")));
  const auto outliers = std::ranges::count_if(fit.residuals, &cabinet::RodFit::Residual::outlier);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                tr(N_("residual: %.2f mm, %.2f degrees rms of %d marks; outliers: %d")),
                fit.slide_rms * 1e3, fit.angle_rms * kDegrees,
                static_cast<int>(fit.residuals.size()), static_cast<int>(outliers));
  lines.emplace_back(text.data());
  return lines;
}

}  // namespace calibrate
