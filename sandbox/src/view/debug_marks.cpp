#include "view/debug_marks.h"

#include <algorithm>
#include <cmath>

#include "view/palette.h"

namespace sandbox {
namespace {

// In sizes of an average body.
constexpr double kFrame = 0.9, kNormal = 0.5;
// Length of the impulse that supports an average body's weight for one step.
constexpr double kWeight = 1.0;
constexpr double kEarth = 9.81;  // [m/s^2], if a scene has no gravity
constexpr double kSmallest = 1e-6, kLargest = 1e6;

class ToMarks : public vp::DebugDraw {
 public:
  ToMarks(const vp::Vec3& origin, Marks& marks) : origin_(origin), marks_(marks) {}

  void line(const vp::Vec3& from, const vp::Vec3& to, vp::DebugCategory mark) override {
    marks_.line(seen(from), seen(to), mark_colour(mark), behind(mark));
  }
  void point(const vp::Vec3& at, vp::DebugCategory mark) override {
    marks_.point(seen(at), mark_colour(mark), behind(mark));
  }
  // The picture draws its own ground.
  bool shape(vp::ColliderId, const vp::Shape& shape, const vp::SE3&, vp::DebugCategory) override {
    return std::holds_alternative<vp::HalfSpace>(shape);
  }

  glm::vec3 seen(const vp::Vec3& p) const {
    const vp::Vec3 d = p - origin_;
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
  }

 private:
  static float behind(vp::DebugCategory mark) {
    return mark >= vp::DebugCategory::axis_x ? Marks::kWithin : Marks::kOnSurface;
  }

  vp::Vec3 origin_;
  Marks& marks_;
};

double fitting(double size) {
  return std::clamp(size, kSmallest, kLargest);
}

}  // namespace

void add_marks(const Simulation& simulation, const vp::DebugDrawOptions& options,
               const vp::Vec3& origin, Marks& marks) {
  ToMarks to_marks(origin, marks);
  const Simulation::Typical typical = simulation.typical();
  const double g = norm(simulation.scene().gravity);
  vp::DebugDrawOptions sized = options;
  sized.frame_size = fitting(kFrame * typical.size);
  sized.normal_length = fitting(kNormal * typical.size);
  sized.impulse_scale =
      fitting(kWeight * typical.size / (typical.mass * (g > 0.0 ? g : kEarth) * simulation.dt()));
  (void)simulation.world().debug_draw(sized, to_marks);  // its sizes are valid
  if (const auto& grip = simulation.grip()) {
    const vp::Vec3 held = simulation.world().pose(grip->body) * grip->point_body;
    marks.line(to_marks.seen(held), to_marks.seen(grip->target), kGripColour, Marks::kWithin);
    marks.point(to_marks.seen(held), kGripColour, Marks::kWithin);
    marks.point(to_marks.seen(grip->target), kGripColour, Marks::kWithin);
  }
}

}  // namespace sandbox
