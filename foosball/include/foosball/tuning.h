// The quantities that shape play. They are tuned for playability, not for realism (paper, section
// 5.1). Each has a name, a unit, a range and a meaning, described in one place. They are part of a
// match: recorded and hashed with it, and changed during play by Command::Kind::tune.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace foosball {

struct Tuning {
  double gravity = 12.0;
  double ball_mass = 0.0263;
  double ball_friction = 0.50;
  double field_friction = 0.30;
  double field_restitution = 0.76;
  double rolling_resistance = 0.00008;
  double wall_friction = 0.20;
  double wall_restitution = 0.75;
  double man_friction = 1.0;
  double man_restitution = 1.0;
  double still_speed = 0.25;
  double hop_from = 0.95;
  double hop_gain = 3.3;
  double bounce_gain = 0.40;
  double bounce_from = 2.0;
  double bounce_most = 1.9;
  double hop_ceiling = 0.120;
  double sag_from = 0.045;
  double sag_acceleration = 0.70;
  double hand_mass = 0.40;
  double hand_inertia = 5.0e-4;
  double hand_frequency = 250.0;
  double hand_force = 350.0;
  double hand_torque = 14.0;
  double slide_rate = 8.0;
  double turn_rate = 150.0;
  double serve_ahead = -0.030;
  double restart_ahead = 0.034;

  bool operator==(const Tuning&) const = default;
};

struct TuningField {
  const char* name;  // of the member; used in profiles and panels
  const char* unit;  // empty: dimensionless
  double Tuning::*value;
  double min, max;
  const char* meaning;  // one sentence: what it is, and what fails beyond its range
};

inline constexpr std::array kTuningFields = std::to_array<TuningField>({
    {"gravity", "m/s^2", &Tuning::gravity, 5.0, 30.0,
     "Acceleration of the ball towards the field; stronger than the earth's, so that hops are "
     "short."},
    {"ball_mass", "kg", &Tuning::ball_mass, 0.010, 0.060,
     "Mass of the ball; the hand feels a heavier one more."},
    {"ball_friction", "", &Tuning::ball_friction, 0.0, 2.0,
     "Friction of the ball; a pair uses the geometric mean. With it a sliding foot drags the "
     "ball."},
    {"field_friction", "", &Tuning::field_friction, 0.0, 2.0,
     "Friction of the field; with more a sliding ball begins to roll sooner."},
    {"field_restitution", "", &Tuning::field_restitution, 0.0, 0.85,
     "Restitution of the field: the fraction of its speed that a falling ball keeps. With more it "
     "never comes to rest."},
    {"rolling_resistance", "m", &Tuning::rolling_resistance, 0.0, 0.002,
     "Lever arm of the rolling resistance; times gravity over the radius it is the deceleration."},
    {"wall_friction", "", &Tuning::wall_friction, 0.0, 2.0, "Friction of walls."},
    {"wall_restitution", "", &Tuning::wall_restitution, 0.0, 0.95,
     "Restitution of the walls; close to 1 a missed shot never slows down."},
    {"man_friction", "", &Tuning::man_friction, 0.0, 3.0,
     "Factor on the friction of every character."},
    {"man_restitution", "", &Tuning::man_restitution, 0.0, 1.1,
     "Factor on the restitution of every character."},
    {"still_speed", "m/s", &Tuning::still_speed, 0.01, 1.0,
     "Slower approaches do not bounce: this ends the last small hops of a ball."},
    {"hop_from", "m/s", &Tuning::hop_from, 0.0, 2.0,
     "A ball that falls more slowly does not bounce: a hop is clearly visible, or there is none."},
    {"hop_gain", "", &Tuning::hop_gain, 1.0, 4.0,
     "Exaggeration: factor on the upward speed that a man gives the ball."},
    {"bounce_gain", "", &Tuning::bounce_gain, 0.0, 1.5,
     "Exaggeration: upward speed of a ball that hits a man, for each m/s of its speed beyond "
     "bounce_from."},
    {"bounce_from", "m/s", &Tuning::bounce_from, 0.0, 10.0,
     "Exaggeration: a slower ball is not lifted, so that it can be trapped."},
    {"bounce_most", "m/s", &Tuning::bounce_most, 0.0, 3.0,
     "Exaggeration: the maximum upward speed that a man gives in this way."},
    {"hop_ceiling", "m", &Tuning::hop_ceiling, 0.02, 1.0,
     "No hop takes the ball's lowest point higher than this; above the walls it can leave the "
     "table."},
    {"sag_from", "m", &Tuning::sag_from, 0.020, 0.075,
     "Farther than this from the nearest rod, the field slopes towards it."},
    {"sag_acceleration", "m/s^2", &Tuning::sag_acceleration, 0.0, 1.0,
     "Acceleration of a ball on that slope; must exceed the rolling resistance."},
    {"hand_mass", "kg", &Tuning::hand_mass, 0.05, 3.0,
     "Mass of the hand and handle that move with a rod; with more a foot is heavier but slower."},
    {"hand_inertia", "kg m^2", &Tuning::hand_inertia, 5.0e-5, 0.01,
     "Inertia of the hand and handle that turn with a rod."},
    {"hand_frequency", "rad/s", &Tuning::hand_frequency, 50.0, 500.0,
     "Of the critically damped drives: if the hand accelerates at a, the lag is a over the square "
     "of this."},
    {"hand_force", "N", &Tuning::hand_force, 20.0, 2000.0,
     "Maximum force of a hand along a rod: the force on a pinched ball."},
    {"hand_torque", "N m", &Tuning::hand_torque, 1.0, 100.0, "Maximum torque of a hand on a rod."},
    {"slide_rate", "m/s", &Tuning::slide_rate, 0.5, 12.0,
     "Maximum speed at which a rod slides, however far its target jumps."},
    {"turn_rate", "rad/s", &Tuning::turn_rate, 20.0, 160.0,
     "Maximum speed at which a rod turns, however far its target jumps; real rods reach 140 "
     "rad/s."},
    {"serve_ahead", "m", &Tuning::serve_ahead, -0.060, 0.060,
     "Where the ball is placed ahead of the midfield that serves: farther ahead the opponent's "
     "midfield has the first shot; behind the men, the server's."},
    {"restart_ahead", "m", &Tuning::restart_ahead, -0.060, 0.060,
     "The same at the other rods that restart play."},
});
inline constexpr int kTuningValues = static_cast<int>(kTuningFields.size());

// Calls visit(field, value) for each value, in order; of a const Tuning the values are const.
template <class Self, class Visit>
constexpr void visit_fields(Self& tuning, Visit&& visit) {
  for (const TuningField& field : kTuningFields) visit(field, tuning.*field.value);
}

// False out of the field's range and for NaN.
constexpr bool in_range(const TuningField& field, double value) {
  return field.min <= value && value <= field.max;
}
constexpr bool in_range(const Tuning& tuning) {
  bool all = true;
  visit_fields(tuning,
               [&](const TuningField& f, double value) { all = all && in_range(f, value); });
  return all;
}
static_assert(in_range(Tuning{}));

// Returns -1 if no value has this name.
constexpr int tuning_index(std::string_view name) {
  for (int i = 0; i < kTuningValues; ++i) {
    if (name == kTuningFields[static_cast<std::size_t>(i)].name) return i;
  }
  return -1;
}

}  // namespace foosball
