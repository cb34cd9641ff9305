#include "scenes/touchstone.h"

#include "parts.h"

namespace scenes {
namespace {

constexpr double kEnd = 1.0, kG = 9.81, kMu = 0.6;  // [s], [m/s^2]
constexpr double kAway = 5.0;                       // distance between separate cases [m]

class Course {
 public:
  Course() {
    out_.scene.seconds = kEnd;
    add_floor(out_.scene);
  }
  int add(Body body) { return scenes::add(out_.scene, std::move(body)); }
  // Expects a point with a given initial position in the world to end at another.
  void expect(const char* what, int body, const Vec3& point, const Vec3& end, double tolerance) {
    out_.expectations.push_back({what, body, point, end, tolerance});
  }
  Expectation& last() { return out_.expectations.back(); }
  Scene& scene() { return out_.scene; }
  Touchstone take(const char* name) {
    out_.scene.name = name;
    return std::move(out_);
  }

 private:
  Touchstone out_;
};

Body moving(const Shape& shape, const Vec3& at, const Vec3& velocity, double density = 1000.0) {
  Body body = body_of(shape, SE3(at), {}, density);
  body.velocity = velocity;
  return body;
}

// It slides until friction stops it, after v^2 / (2 mu g).
void add_slider(Course& b, double y) {
  constexpr double kSpeed = 5.0, kHalf = 0.25;
  const int body = b.add(moving(Box{{0.5, 0.5, kHalf}}, {0, y, kHalf}, {kSpeed, 0, 0}));
  b.expect("a box slides", body, {}, {kSpeed * kSpeed / (2.0 * kMu * kG), y, kHalf}, 0.08);
}

// It slides until it rolls at 5/7 of its speed, if its moment of inertia is 2/5 m r^2.
void add_roller(Course& b, double y) {
  constexpr double kSpeed = 3.0, kRadius = 0.5;
  const double slips = 2.0 * kSpeed / (7.0 * kMu * kG);
  const double distance = kSpeed * slips - 0.5 * kMu * kG * slips * slips;
  const int ball = b.add(moving(Sphere{kRadius}, {0, y, kRadius}, {kSpeed, 0, 0}));
  b.expect("a ball slides, then rolls", ball, {},
           {distance + 5.0 / 7.0 * kSpeed * (kEnd - slips), y, kRadius}, 0.08);
}

// Both fall, and one collides with the other, of twice its mass. Whatever the impulse, the motion
// of their common centre of mass is unchanged.
void add_collision(Course& b, double y) {
  constexpr double kSpeed = 3.0, kGap = 0.5, kHeight = 20.0;
  const Box crate{{0.5, 0.5, 0.5}};
  const int one = b.add(moving(crate, {0, y, kHeight}, {kSpeed, 0, 0}, 1000.0));
  const int two = b.add(moving(crate, {1.0 + kGap, y, kHeight}, {}, 2000.0));
  const double share = 2.0 / 3.0;
  b.expect(
      "a box runs into one of twice its mass", one, {},
      {share * (1.0 + kGap) + (1.0 - share) * kSpeed * kEnd, y, kHeight - 0.5 * kG * kEnd * kEnd},
      0.05);
  b.last().other = two;
  b.last().share = share;
}

void add_flier(Course& b, double y) {
  constexpr double kSpin = 2.0, kHeight = 20.0;
  Body body = moving(Capsule{0.3, 0.3}, {0, y, kHeight}, {1.0, 0, 0});
  body.spin = {0, kSpin, 0};
  const int flier = b.add(body);
  const auto [s, c] = vp::sin_cos(kSpin * kEnd);
  const Vec3 centre{kEnd, y, kHeight - 0.5 * kG * kEnd * kEnd};
  b.expect("a capsule turns as it falls", flier, {0, 0, 1}, centre + Vec3{s, 0, c}, 0.08);
}

void add_dropped(Course& b, double y) {
  const int body = b.add(moving(Box{{0.5, 0.5, 0.5}}, {0, y, 0.8}, {}));
  b.expect("a box falls and does not bounce", body, {0.5, 0, 0.5}, {0.5, y, 1.0}, 0.03);
}

void add_launched(Course& b, double y) {
  constexpr double kWhen = 0.5, kSpeed = 4.0, kHeight = 20.0;
  const int body = b.add(moving(Sphere{0.5}, {0, y, kHeight}, {}));
  b.scene().launches.push_back({kWhen, body, {kSpeed, 0, 0}, {}});
  const double again = kEnd - kWhen;
  const double z = kHeight - 0.5 * kG * kWhen * kWhen - 0.5 * kG * again * again;
  b.expect("a ball is launched on its way", body, {}, {kSpeed * again, y, z}, 0.08);
}

// The angle below the horizontal of a pendulum released from there: x'' = k cos x, by the
// fourth-order Runge-Kutta method, to 1e-9.
double pendulum_angle(double k, double seconds) {
  constexpr int kSteps = 2000;
  const double h = seconds / kSteps;
  const auto f = [&](double x) { return k * vp::sin_cos(x).cos; };
  double x = 0.0, v = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double a1 = f(x), a2 = f(x + 0.5 * h * v), a3 = f(x + 0.5 * h * (v + 0.5 * h * a1)),
                 a4 = f(x + h * (v + 0.5 * h * a2));
    x += h * v + h * h / 6.0 * (a1 + a2 + a3);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return x;
}

// A bar along x. A joint at its end has its z axis along the world's y or -y.
constexpr double kHalf = 0.5;
constexpr Box kBar{{kHalf, 0.05, 0.05}};
constexpr double kHeight = 5.0;

int add_bar(Course& b, Joint::Kind kind, double y, double axis, double lower, double upper) {
  const int post = b.add(fixed_body(Box{{0.1, 0.1, 0.1}}, SE3(Vec3{-0.1, y, kHeight})));
  const int bar = b.add(moving(kBar, {kHalf, y, kHeight}, {}));
  const vp::Mat3 R{{1, 0, 0}, {0, 0, -axis}, {0, axis, 0}};
  b.scene().joints.push_back(
      {kind, post, bar, SE3(R, {0.1, 0, 0}), SE3(R, {-kHalf, 0, 0}), lower, upper});
  return bar;
}

void expect_angle(Course& b, const char* what, int bar, double y, double angle, double tolerance) {
  const auto [s, c] = vp::sin_cos(angle);
  b.expect(what, bar, {kHalf, 0, 0}, Vec3{0, y, kHeight} + 2.0 * kHalf * Vec3{c, 0, -s}, tolerance);
}

}  // namespace

Touchstone touchstone() {
  Course b;
  int lane = 0;
  for (const auto add :
       {add_slider, add_roller, add_collision, add_flier, add_dropped, add_launched}) {
    add(b, kAway * lane++);
  }
  return b.take("touchstone");
}

Touchstone joined_touchstone() {
  constexpr double kNever = Joint::kNever;
  const Mass bar = mass_of(kBar, 1000.0);
  const double k = bar.mass * kG * kHalf / (bar.moments.y + bar.mass * kHalf * kHalf);
  const double swung = pendulum_angle(k, kEnd);
  Course b;
  int lane = 0;
  const auto next = [&] { return kAway * lane++; };
  for (const auto kind : {Joint::Kind::hinge, Joint::Kind::ball}) {
    const double y = next();
    expect_angle(b,
                 kind == Joint::Kind::hinge ? "a bar swings on a hinge" : "a bar swings on a ball",
                 add_bar(b, kind, y, 1.0, -kNever, kNever), y, swung, 0.08);
  }
  // The bar falls with a rotation about +y: the joint's angle grows where its z axis is +y.
  constexpr double kStop = 0.5;
  double y = next();
  expect_angle(b, "a bar falls onto its hinge's upper limit",
               add_bar(b, Joint::Kind::hinge, y, 1.0, -2.0, kStop), y, kStop, 0.08);
  y = next();
  expect_angle(b, "a bar falls onto its hinge's lower limit",
               add_bar(b, Joint::Kind::hinge, y, -1.0, -kStop, 2.0), y, kStop, 0.08);
  return b.take("touchstone-joined");
}

}  // namespace scenes
