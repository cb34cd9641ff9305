// MuJoCo's three integrators. The system is MJCF without geometry.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "system.h"

namespace vp::bench {
namespace {

std::string numbers(const Vec3& a) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", a.x, a.y, a.z);
}

// Both systems are chains, with principal axes along the links' axes.
std::string mjcf(const System& system) {
  std::string xml = fmt::format(
      "<mujoco><compiler inertiafromgeom=\"false\" angle=\"radian\"/>"
      "<option timestep=\"{:.17g}\" gravity=\"{}\"/><worldbody>",
      kStep, numbers(system.gravity));
  const int links = system.model.links();
  for (int i = 0; i < links; ++i) {
    const LinkSpec& link = system.model.link(i);
    const Sym3 I = link.inertia.central();
    xml += fmt::format("<body pos=\"{}\">", numbers(link.T_parent_joint.position()));
    if (const auto* hinge = std::get_if<RevoluteJoint>(&link.joint)) {
      xml += fmt::format("<joint type=\"hinge\" axis=\"{}\"/>", numbers(hinge->axis));
    } else {
      xml += "<joint type=\"free\"/>";
    }
    xml += fmt::format("<inertial pos=\"{}\" mass=\"{:.17g}\" diaginertia=\"{}\"/>",
                       numbers(link.inertia.centre_of_mass()), link.inertia.mass(),
                       numbers({I.xx, I.yy, I.zz}));
  }
  for (int i = 0; i < links; ++i) xml += "</body>";
  return xml + "</worldbody></mujoco>";
}

mjModel* load(const std::string& xml) {
  auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "system.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[512] = "";
  mjModel* model = mj_loadXML("system.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    fmt::print(stderr, "drift-bench: MuJoCo refuses the system: {}\n", error);
    std::exit(1);
  }
  return model;
}

class Mujoco final : public Mover {
 public:
  Mujoco(const System& system, int integrator, const char* label)
      : free_(system.model.coordinates() != system.model.velocities()),
        model_(load(mjcf(system)), mj_deleteModel),
        data_(mj_makeData(model_.get()), mj_deleteData) {
    name = label;
    model_->opt.integrator = integrator;
    // There are no contacts and no joint limits.
    model_->opt.disableflags |= mjDSBL_CONSTRAINT;
    const State& s = system.start;
    if (!free_) return;  // at zero and at rest, MuJoCo's initial state
    const double q[7] = {s.q[0], s.q[1], s.q[2], s.q[6], s.q[3], s.q[4], s.q[5]};
    const double v[6] = {s.v[3], s.v[4], s.v[5], s.v[0], s.v[1], s.v[2]};
    std::copy(q, q + 7, data_->qpos);
    std::copy(v, v + 6, data_->qvel);
  }

  void advance(int steps) override {
    for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
    failed = data_->warning[mjWARN_BADQACC].number > 0 || data_->warning[mjWARN_BADQVEL].number > 0;
  }
  State state() const override {
    const mjtNum *q = data_->qpos, *v = data_->qvel;
    if (!free_) return {{q, q + model_->nq}, {v, v + model_->nv}};
    // Its linear velocity is in world axes; the systems are and remain at rest there.
    return {{q[0], q[1], q[2], q[4], q[5], q[6], q[3]}, {v[3], v[4], v[5], v[0], v[1], v[2]}};
  }

 private:
  bool free_;
  std::unique_ptr<mjModel, void (*)(mjModel*)> model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

}  // namespace

std::vector<std::unique_ptr<Mover>> mujoco_movers(const System& system) {
  // By default warnings go to a file in the working directory. They are counted instead.
  mju_user_warning = [](const char*) {};
  std::vector<std::unique_ptr<Mover>> awake_bodies;
  awake_bodies.push_back(std::make_unique<Mujoco>(system, mjINT_EULER, "MuJoCo: Euler"));
  awake_bodies.push_back(std::make_unique<Mujoco>(system, mjINT_IMPLICIT, "MuJoCo: implicit"));
  awake_bodies.push_back(std::make_unique<Mujoco>(system, mjINT_RK4, "MuJoCo: RK4"));
  return awake_bodies;
}

}  // namespace vp::bench
