#include "core/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace sandbox {
namespace {

constexpr double kFieldOfView = 0.66;  // [rad], vertical
constexpr double kSteepest = 1.5;   // [rad]: at a right angle the up direction would be undefined
constexpr double kTurn = 0.006;     // [rad/px]
constexpr double kZoomStep = 1.15;  // factor of the distance per wheel step
constexpr double kNearest = 0.05, kFarthest = 1e5;  // distance to the target [m]
constexpr double kMaxCovered = 0.6;                 // of the picture's width
constexpr double kMargin = 1.06;                    // margin factor around a fitted box

glm::vec3 narrow(const vp::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

double half_height() {
  return std::tan(0.5 * kFieldOfView);
}
double aspect_of(const glm::ivec2& screen) {
  return static_cast<double>(std::max(screen.x, 1)) / static_cast<double>(std::max(screen.y, 1));
}

}  // namespace

void OrbitCamera::look_from(double yaw, double pitch) {
  yaw_ = yaw;
  pitch_ = std::clamp(pitch, -kSteepest, kSteepest);
}

void OrbitCamera::leave_free(double share) {
  covered_ = std::clamp(share, 0.0, kMaxCovered);
}

// Each corner must be inside the four sides of the view frustum; the largest distance that a corner
// needs is used.
void OrbitCamera::fit(const vp::Vec3& low, const vp::Vec3& high, const glm::ivec2& screen) {
  target_ = 0.5 * (low + high);
  const double tan_y = half_height() / kMargin,
               tan_x = (1.0 - covered_) * aspect_of(screen) * tan_y;
  double needed = kNearest;
  for (int corner = 0; corner < 8; ++corner) {
    const vp::Vec3 p =
        vp::Vec3{(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                 (corner & 4) != 0 ? high.z : low.z} -
        target_;
    const double before = dot(p, -forward());  // how much closer than the target
    needed = std::max({needed, before + std::abs(dot(p, right())) / tan_x,
                       before + std::abs(dot(p, up())) / tan_y});
  }
  distance_ = std::clamp(needed, kNearest, kFarthest);
}

void OrbitCamera::orbit(const glm::dvec2& pixels) {
  look_from(yaw_ - kTurn * pixels.x, pitch_ + kTurn * pixels.y);
}

void OrbitCamera::pan(const glm::dvec2& pixels, const glm::ivec2& screen) {
  const double metres = 2.0 * half_height() * distance_ / std::max(screen.y, 1);
  target_ += metres * (pixels.y * up() - pixels.x * right());
}

void OrbitCamera::zoom(double steps) {
  scale_distance(std::pow(kZoomStep, -steps));
}

void OrbitCamera::scale_distance(double factor) {
  distance_ = std::clamp(distance_ * factor, kNearest, kFarthest);
}

vp::Vec3 OrbitCamera::forward() const {
  return {-std::cos(pitch_) * std::cos(yaw_), -std::cos(pitch_) * std::sin(yaw_),
          -std::sin(pitch_)};
}
vp::Vec3 OrbitCamera::right() const {
  return {-std::sin(yaw_), std::cos(yaw_), 0.0};
}
vp::Vec3 OrbitCamera::up() const {
  return cross(right(), forward());
}
vp::Vec3 OrbitCamera::eye() const {
  return target_ - distance_ * forward();
}

Ray OrbitCamera::ray(const glm::dvec2& pixel, const glm::ivec2& screen) const {
  const double x = 2.0 * pixel.x / std::max(screen.x, 1) - 1.0 - covered_;
  const double y = 1.0 - 2.0 * pixel.y / std::max(screen.y, 1);
  const vp::Vec3 d = forward() + half_height() * (aspect_of(screen) * x * right() + y * up());
  return {eye(), (1.0 / norm(d)) * d};
}

glm::mat4 OrbitCamera::view() const {
  return glm::lookAt(narrow(-distance_ * forward()), glm::vec3(0.0f), glm::vec3(0, 0, 1));
}

// Near and far planes that 24 bits of depth can resolve, including the horizon.
glm::mat4 OrbitCamera::projection(const glm::ivec2& screen) const {
  glm::mat4 projection = glm::perspective(
      static_cast<float>(kFieldOfView), static_cast<float>(aspect_of(screen)),
      static_cast<float>(0.02 * distance_), static_cast<float>(60.0 * distance_ + 500.0));
  projection[2][0] -= static_cast<float>(covered_);  // shifts x / w
  return projection;
}

}  // namespace sandbox
