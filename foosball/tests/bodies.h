// Bodies for tests: those of the built-in characters, and of men at the limits of the valid ranges.
#pragma once

#include <cmath>
#include <vector>

#include "foosball/table.h"

namespace foosball {

inline int built_in_count() {
  return static_cast<int>(built_in_characters().size());
}
inline const CharacterBody& built_in(int character) {
  return built_in_characters()[static_cast<std::size_t>(character)].body;
}
inline TeamBodies built_in(int character0, int character1) {
  return {built_in(character0), built_in(character1)};
}

// Every number at its minimum or maximum. The reach is reduced where the foot's corner would be too
// far from the axis.
inline CharacterBody body_at_bound(bool max) {
  CharacterBody body;
  for (const auto& field : kBodyFields) body.*field.value = max ? field.max : field.min;
  const double half = 0.5 * body.foot_depth;
  body.foot_reach = std::fmin(body.foot_reach, std::sqrt(kFootCorner * kFootCorner - half * half));
  return body;
}

// The built-in bodies, the minimum and the maximum, and a thin and a deep body with the largest
// reach.
inline std::vector<CharacterBody> bodies_of_all_kinds() {
  std::vector<CharacterBody> all;
  for (const Character& c : built_in_characters()) all.push_back(c.body);
  all.push_back(body_at_bound(false));
  all.push_back(body_at_bound(true));
  CharacterBody thin = body_at_bound(false);
  for (const auto& f : kBodyFields) {
    if (f.value == &CharacterBody::foot_reach) thin.foot_reach = f.max;
  }
  const double half = 0.5 * thin.foot_depth;
  thin.foot_reach = std::fmin(thin.foot_reach, std::sqrt(kFootCorner * kFootCorner - half * half));
  all.push_back(thin);
  return all;
}

}  // namespace foosball
