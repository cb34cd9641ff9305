// Bodies for tests: those of the built-in characters, and of men at the bounds of what a file may
// say.
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

// Every number at its least or at its most; the reach gives way where the foot's corner would not.
inline CharacterBody body_at_bound(bool most) {
  CharacterBody body;
  for (const auto& field : kBodyFields) body.*field.value = most ? field.most : field.least;
  const double half = 0.5 * body.foot_depth;
  body.foot_reach = std::fmin(body.foot_reach, std::sqrt(kFootCorner * kFootCorner - half * half));
  return body;
}

// The built-in ones, then the least and the most, and a thin and a deep one that reach furthest.
inline std::vector<CharacterBody> bodies_of_all_kinds() {
  std::vector<CharacterBody> all;
  for (const Character& c : built_in_characters()) all.push_back(c.body);
  all.push_back(body_at_bound(false));
  all.push_back(body_at_bound(true));
  CharacterBody thin = body_at_bound(false);
  for (const auto& f : kBodyFields) {
    if (f.value == &CharacterBody::foot_reach) thin.foot_reach = f.most;
  }
  const double half = 0.5 * thin.foot_depth;
  thin.foot_reach = std::fmin(thin.foot_reach, std::sqrt(kFootCorner * kFootCorner - half * half));
  all.push_back(thin);
  return all;
}

}  // namespace foosball
