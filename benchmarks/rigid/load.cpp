#include "load.h"

#include <charconv>

#include "scenes/catalogue.h"
#include "table_scene.h"

namespace rigid {

vp::Expected<scenes::Scene> load(std::string_view name) {
  if (!is_table(name)) return scenes::make_scene(name);
  const std::string_view digits = name.substr(5);
  int balls = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), balls);
  if (error != std::errc() || end != digits.data() + digits.size() || balls < 1 ||
      balls > kMaxBalls) {
    return tl::make_unexpected(vp::Error{vp::Errc::invalid_argument,
                                         "a table is asked for as tableN, with N from 1 to 1000"});
  }
  return table_scene(balls);
}

}  // namespace rigid
