// A running scene: stepped at a rate, paused, slowed down, and pulled by the pointer.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/orbit_camera.h"
#include "core/pull.h"
#include "core/step_times.h"
#include "scenes/scene_world.h"

namespace sandbox {

// A body as it is drawn.
struct Piece {
  struct Part {
    vp::Shape shape;
    vp::SE3 T_body_part;
  };
  vp::BodyId body;  // null: it does not exist now
  scenes::Motion motion;
  vp::Inertia inertia;  // of a dynamic body
  std::vector<Part> parts;
};

class Simulation {
 public:
  // [ns]
  struct Clocks {
    std::int64_t (*real)();
    std::int64_t (*processor)();         // measures the cost of a step
    std::int64_t (*stages)() = nullptr;  // measures its stages; null: they are not timed
  };

  static constexpr int kMinRate = 10, kMaxRate = 10'000;  // [Hz]

  Simulation(scenes::SceneWorld world, int rate, const Clocks& clocks);
  // The error names the available scenes, or the part of this scene that the engine does not
  // support.
  static vp::Expected<Simulation> open(std::string_view scene, int rate, const Clocks& clocks);

  vp::Expected<void> reset();
  const scenes::Scene& scene() const { return world_.scene(); }
  const vp::World& world() const { return world_.world(); }
  double time() const { return world_.time(); }  // [s] since the start
  std::size_t steps() const { return steps_; }   // since the start
  // Indexed by the user data of bodies and their colliders: the scene's bodies, then thrown ones.
  std::span<const Piece> pieces() const { return pieces_; }
  std::size_t moving() const;  // number of existing dynamic bodies
  std::vector<vp::SE3> scene_poses() const { return world_.poses(); }
  // An average moving body of the scene: half its size [m], its mass [kg].
  struct Typical {
    double size = 1.0, mass = 1.0;
  };
  const Typical& typical() const { return typical_; }
  // Of the moving bodies, or of all bodies if none moves.
  void bounds(vp::Vec3& low, vp::Vec3& high) const;

  int rate() const { return rate_; }
  void set_rate(int hz) { rate_ = hz; }
  double dt() const { return 1.0 / rate_; }
  vp::Expected<void> step();
  // Steps as often as fits into a frame of `frame` [s] at that speed relative to real time. If the
  // steps exceed the budget [s], the remaining ones are dropped and the scene runs slower than
  // requested.
  vp::Expected<void> advance(double frame, double speed, double budget);

  const StepTimes& times() const { return times_; }
  // Of a step, the mean over about the last kStagesOf steps [us].
  static constexpr int kStagesOf = 100;
  double stage_us(vp::Stage stage) const { return stage_us_[static_cast<std::size_t>(stage)]; }
  // Accumulates the status of all steps since the start.
  const vp::StepStatus& status() const { return status_; }

  // Grabs the first moving body that the ray hits, and holds it until let_go().
  bool grab(const Ray& ray);
  // Moves the target to the pointer, in the plane through the grabbed point that faces the eye.
  void drag(const Ray& ray, const vp::Vec3& forward);
  void pull_to(const vp::Vec3& target);  // for the grabbed point
  void let_go() { grip_.reset(); }
  const std::optional<Grip>& grip() const { return grip_; }

  // Adds a body of density 1000 with its centre of mass at `at` and this velocity [m/s].
  vp::Expected<void> throw_body(const vp::Shape& shape, const vp::Vec3& at,
                                const vp::Vec3& velocity);

 private:
  void collect_pieces();
  void follow_events();
  void watch_stages();
  void average_stages();

  scenes::SceneWorld world_;
  int rate_;
  Clocks clocks_;
  std::shared_ptr<vp::StageClock> stage_clock_;
  std::array<double, vp::kStages.size()> stage_us_{};
  int stages_averaged_ = 0;
  std::vector<Piece> pieces_;
  std::size_t happened_ = 0;  // number of the scene's events at the last update of the pieces
  Typical typical_;
  StepTimes times_;
  vp::StepStatus status_;
  std::optional<Grip> grip_;
  double owed_ = 0.0;  // [s] not stepped yet
  std::size_t steps_ = 0;
};

}  // namespace sandbox
