// A scene that runs: stepped at a rate, paused, slowed down, with a hand in it.
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

// A body as it is shown.
struct Piece {
  struct Part {
    vp::Shape shape;
    vp::SE3 T_body_part;
  };
  vp::BodyId body;  // null: it does not exist now
  scenes::Motion motion;
  vp::Inertia inertia;  // of a dynamic one
  std::vector<Part> parts;
};

class Simulation {
 public:
  // [ns]
  struct Clocks {
    std::int64_t (*real)();
    std::int64_t (*processor)();         // what a step costs is told by it
    std::int64_t (*stages)() = nullptr;  // and by this its stages; null: they are not timed
  };

  static constexpr int kLeastRate = 10, kMostRate = 10'000;  // [Hz]

  Simulation(scenes::SceneWorld world, int rate, const Clocks& clocks);
  // The error names the scenes there are, or what of this one the engine cannot have.
  static vp::Expected<Simulation> open(std::string_view scene, int rate, const Clocks& clocks);

  vp::Expected<void> reset();
  const scenes::Scene& scene() const { return world_.scene(); }
  const vp::World& world() const { return world_.world(); }
  double time() const { return world_.time(); }  // [s] since the start
  std::size_t steps() const { return steps_; }   // since the start
  // By the user data of bodies and their colliders: those of the scene, then those thrown.
  std::span<const Piece> pieces() const { return pieces_; }
  std::size_t moving() const;  // number of dynamic ones that exist
  std::vector<vp::SE3> scene_poses() const { return world_.poses(); }
  // An average moving body of the scene: half its size [m], its mass [kg].
  struct Typical {
    double size = 1.0, mass = 1.0;
  };
  const Typical& typical() const { return typical_; }
  // Around what moves, or all there is if nothing does.
  void bounds(vp::Vec3& low, vp::Vec3& high) const;

  int rate() const { return rate_; }
  void set_rate(int hz) { rate_ = hz; }
  double dt() const { return 1.0 / rate_; }
  vp::Expected<void> step();
  // As many steps as fall into a frame of so many seconds, at that share of real time; fewer if
  // they take longer than the budget [s], and then the rest is let go: the scene runs slower than
  // asked.
  vp::Expected<void> advance(double frame, double speed, double budget);

  const StepTimes& times() const { return times_; }
  // Of a step, the mean over about the last kStagesOf [us].
  static constexpr int kStagesOf = 100;
  double stage_us(vp::Stage stage) const { return stage_us_[static_cast<std::size_t>(stage)]; }
  // Whatever a step since the start has had to do without.
  const vp::StepStatus& status() const { return status_; }

  // Of what moves, the first that the ray meets; then it is held, until let go.
  bool grab(const Ray& ray);
  // Where the pointer is now: in the plane through the grabbed point that faces the eye.
  void drag(const Ray& ray, const vp::Vec3& forward);
  void pull_to(const vp::Vec3& target);  // of what is held
  void let_go() { grip_.reset(); }
  const std::optional<Grip>& grip() const { return grip_; }

  // Adds a body of density 1000, its centre of mass there, flying so [m/s].
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
  std::size_t happened_ = 0;  // of the scene's events, when the pieces' bodies were last asked for
  Typical typical_;
  StepTimes times_;
  vp::StepStatus status_;
  std::optional<Grip> grip_;
  double owed_ = 0.0;  // [s] not stepped yet
  std::size_t steps_ = 0;
};

}  // namespace sandbox
