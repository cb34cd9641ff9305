// Virtual Physics, through its public headers. docs/vphysics.md.
#include <optional>

#include "engine.h"
#include "load.h"
#include "scenes/scene_world.h"
#include "table_scene.h"

namespace rigid {
namespace {

class Ours final : public Engine {
 public:
  Ours(scenes::SceneWorld world, std::optional<Rods> rods, double dt)
      : world_(std::move(world)), rods_(std::move(rods)), dt_(dt) {
    if (rods_) world_.world().snapshot(start_);
  }
  std::string settings() const override { return "defaults"; }
  bool step() override {
    if (rods_) rods_->drive(world_.world(), steps_);
    // Restores the initial state now and then, as the game puts balls back that have left the
    // table.
    if (rods_ && steps_ % 2000 == 1999) (void)world_.world().restore(start_);
    ++steps_;
    const auto status = world_.step(dt_);
    return status && !status->non_finite;
  }
  void launch(const scenes::Launch&) override {}  // SceneWorld handles all events in its step
  std::vector<vp::SE3> poses() const override { return world_.poses(); }

 private:
  scenes::SceneWorld world_;
  std::optional<Rods> rods_;
  double dt_;
  long steps_ = 0;
  std::vector<std::byte> start_;
};

}  // namespace

MadeEngine make_engine(const scenes::Scene& scene, double dt) {
  auto world = scenes::SceneWorld::create(scene);
  if (!world) return tl::make_unexpected(world.error().message);
  std::optional<Rods> rods;
  if (is_table(scene.name)) {
    auto made = Rods::create(world->world());
    if (!made) return tl::make_unexpected(made.error().message);
    rods = std::move(*made);
  }
  return std::make_unique<Ours>(std::move(*world), std::move(rods), dt);
}

}  // namespace rigid
