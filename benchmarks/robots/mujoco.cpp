// MuJoCo with its defaults: Newton's method, pyramidal cones, 1e-8, Euler's method with implicit
// damping. Links do not collide with one another, as in Virtual Physics.
#include "mujoco.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace robots {
namespace {

std::string numbers(const vp::Vec3& a) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", a.x, a.y, a.z);
}

class Xml {
 public:
  Xml(const Robot& robot, double dt) : robot_(robot) {
    text_ = fmt::format(
        "<mujoco><compiler angle=\"radian\" boundmass=\"0\" balanceinertia=\"false\"/>"
        "<option timestep=\"{:.17g}\"/><worldbody>\n"
        "<geom type=\"plane\" size=\"0 0 1\" friction=\"{} 0 0\" contype=\"1\" "
        "conaffinity=\"2\"/>\n",
        dt, kFriction);
    add(0, "");
    text_ += "</worldbody>\n<actuator>\n";
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      if (robot.links[i].stiffness > 0.0) {
        text_ += fmt::format("<position joint=\"j{}\" kp=\"{}\" ctrllimited=\"false\"/>\n", i,
                             robot.links[i].stiffness);
      }
      if (robot.links[i].random_torque > 0.0) {
        text_ +=
            fmt::format("<motor joint=\"j{}\" gear=\"{}\"/>\n", i, robot.links[i].random_torque);
      }
    }
    text_ += "</actuator></mujoco>";
  }
  const std::string& text() const { return text_; }

 private:
  std::string joint(int i) const {
    const Link& link = robot_.links[static_cast<std::size_t>(i)];
    if (link.spec.parent == vp::kWorld) return "<freejoint/>";
    const vp::JointForces& f = link.spec.forces[0];
    return fmt::format(
        "<joint name=\"j{}\" type=\"hinge\" axis=\"{}\" limited=\"true\" range=\"{} {}\" "
        "damping=\"{}\" armature=\"{}\"/>",
        i, numbers(std::get<vp::RevoluteJoint>(link.spec.joint).axis), f.lower, f.upper,
        link.spec.damping + link.damping, link.spec.armature);
  }
  // Writes a link and its descendants; the joints of links without mass go into the next link.
  void add(int i, const std::string& joints, const vp::Vec3* at = nullptr) {
    const Link& link = robot_.links[static_cast<std::size_t>(i)];
    const vp::Vec3& here = at ? *at : link.spec.T_parent_joint.position();
    const std::string all = joints + joint(i);
    if (link.spec.inertia.mass() == 0.0) return add(i + 1, all, &here);
    const vp::Sym3 I = link.spec.inertia.central();
    text_ += fmt::format(
        "<body name=\"b{}\" pos=\"{}\"><inertial pos=\"{}\" mass=\"{:.17g}\" fullinertia=\"{:.17g} "
        "{:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\"/>{}\n",
        i, numbers(here), numbers(link.spec.inertia.centre_of_mass()), link.spec.inertia.mass(),
        I.xx, I.yy, I.zz, I.xy, I.zx, I.yz, all);
    for (const RoundShape& shape : link.shapes) {
      const bool ball = shape.from == shape.to;
      text_ += ball ? fmt::format("<geom type=\"sphere\" size=\"{}\" pos=\"{}\"", shape.radius,
                                  numbers(shape.from))
                    : fmt::format("<geom type=\"capsule\" size=\"{}\" fromto=\"{} {}\"",
                                  shape.radius, numbers(shape.from), numbers(shape.to));
      text_ += fmt::format(" friction=\"{} 0 0\" contype=\"2\" conaffinity=\"1\"/>\n", kFriction);
    }
    for (int k = i + 1; k < static_cast<int>(robot_.links.size()); ++k) {
      if (robot_.links[static_cast<std::size_t>(k)].spec.parent == i) add(k, "");
    }
    text_ += "</body>\n";
  }

  const Robot& robot_;
  std::string text_;
};

struct Freed {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

class Mujoco final : public Simulation {
 public:
  Mujoco(const Robot& robot, double dt) {
    const Xml xml(robot, dt);
    mjVFS files;
    mj_defaultVFS(&files);
    const auto length = static_cast<int>(xml.text().size()) + 1;
    char error[500] = "its model cannot be handed over";
    if (mj_makeEmptyFileVFS(&files, "robot.xml", length) == 0) {
      std::memcpy(files.filedata[files.nfile - 1], xml.text().c_str(), xml.text().size() + 1);
      model_.reset(mj_loadXML("robot.xml", &files, error, sizeof error));
    }
    mj_deleteVFS(&files);
    if (!model_) {
      std::fprintf(stderr, "MuJoCo: %s\n%s\n", error, xml.text().c_str());
      std::exit(1);
    }
    data_.reset(mj_makeData(model_.get()));
    const vp::Quaternion turn = to_quaternion(robot.start.rotation());
    const vp::Vec3& at = robot.start.position();
    const double free[] = {at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z};
    std::copy(std::begin(free), std::end(free), data_->qpos);
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      bodies_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, fmt::format("b{}", i).c_str()));
      if (i == 0) continue;
      const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, fmt::format("j{}", i).c_str());
      data_->qpos[model_->jnt_qposadr[joint]] = link.position;
    }
    int control = 0;
    for (const Link& link : robot.links) {
      if (link.stiffness > 0.0) data_->ctrl[control++] = link.position;
    }
    random_ = robot.is_random();
  }

  void step() override {
    if (random_ && steps_ % kHeldSteps == 0) {
      for (int i = 0; i < model_->nu; ++i) data_->ctrl[i] = torques_.next();
    }
    ++steps_;
    mj_step(model_.get(), data_.get());
  }
  vp::SE3 pose(int link) const override {
    const int body = bodies_[static_cast<std::size_t>(link)];
    const mjtNum* R = data_->xmat + 9 * body;
    const mjtNum* x = data_->xpos + 3 * body;
    return vp::SE3(vp::Mat3{{R[0], R[3], R[6]}, {R[1], R[4], R[7]}, {R[2], R[5], R[8]}},
                   {x[0], x[1], x[2]});
  }
  double speed() const override {
    double max = 0.0;
    for (int i = 0; i < model_->nv; ++i) max = std::max(max, std::fabs(data_->qvel[i]));
    return max;
  }

 private:
  std::unique_ptr<mjModel, Freed> model_;
  std::unique_ptr<mjData, Freed> data_;
  std::vector<int> bodies_;
  Torques torques_;
  bool random_ = false;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<Simulation> make_mujoco(const Robot& robot, double dt) {
  return std::make_unique<Mujoco>(robot, dt);
}

}  // namespace robots
