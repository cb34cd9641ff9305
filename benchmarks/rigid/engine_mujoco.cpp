// MuJoCo with its defaults (Newton's method, pyramidal cones, at most 100 iterations, 1e-8); the
// scene is converted to its XML. The first joint of a body connects it to the tree; a joint that
// would close a loop is an equality constraint.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "engine.h"

namespace rigid {
namespace {

// A Newton step factors a matrix of all velocities: with more bodies than this it takes minutes.
constexpr std::size_t kMaxBodies = 3000;

// Maximum nesting depth of bodies in the XML.
constexpr int kDeepest = 90;

// The model sets the maximum number of constraint rows, four for each contact. MuJoCo 2.2 counts
// the bytes of their buffer in an int: 12 rows^2 + 24 rows velocities, plus small terms.
int max_rows(double velocities) {
  constexpr double kMaxBytes = 2.0e9;
  return static_cast<int>(std::sqrt(velocities * velocities + kMaxBytes / 12.0) - velocities);
}

bool begins_at_rest(const scenes::Body& body) {
  return norm(body.velocity) + norm(body.spin) == 0.0;
}

std::string numbers(const vp::Vec3& a) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", a.x, a.y, a.z);
}
std::string place(const vp::SE3& T) {
  const auto q = vp::to_quaternion(T.rotation());
  return fmt::format("pos=\"{}\" quat=\"{:.17g} {:.17g} {:.17g} {:.17g}\"", numbers(T.position()),
                     q.w, q.x, q.y, q.z);
}

std::string geom(const scenes::Part& part) {
  const std::string where = place(part.T_body_shape);
  const std::string friction = fmt::format("friction=\"{} 0 0\"", part.material.friction);
  if (const auto* s = std::get_if<scenes::Sphere>(&part.shape)) {
    return fmt::format("<geom type=\"sphere\" size=\"{}\" {} {}/>\n", s->radius, where, friction);
  }
  if (const auto* b = std::get_if<scenes::Box>(&part.shape)) {
    return fmt::format("<geom type=\"box\" size=\"{}\" {} {}/>\n", numbers(b->half_extents), where,
                       friction);
  }
  if (const auto* c = std::get_if<scenes::Capsule>(&part.shape)) {
    return fmt::format("<geom type=\"capsule\" size=\"{} {}\" {} {}/>\n", c->radius, c->half_length,
                       where, friction);
  }
  return fmt::format("<geom type=\"plane\" size=\"0 0 1\" {} {}/>\n", where, friction);
}

class Xml {
 public:
  Xml(const scenes::Scene& scene, double dt) : scene_(scene) {
    hung_.resize(scene.bodies.size());
    joints_of_.resize(scene.bodies.size());
    used_.resize(scene.joints.size());
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      joints_of_[scene.joints[j].a].push_back(j);
      joints_of_[scene.joints[j].b].push_back(j);
    }
    text_ = fmt::format(
        "<mujoco><compiler angle=\"radian\" boundmass=\"0\" balanceinertia=\"false\"/>"
        "<option timestep=\"{:.17g}\" gravity=\"{}\"/><worldbody>\n",
        dt, numbers(scene.gravity));
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (scene.bodies[i].motion == scenes::Motion::fixed) hang(i, vp::SE3{}, -1, 0);
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (!hung_[i]) hang(i, vp::SE3{}, -1, 0);
    }
    text_ += "</worldbody>\n" + rest() + "</mujoco>";
  }
  const std::string& text() const { return text_; }

 private:
  // Writes a body and its descendants. by: the joint to its parent, or -1.
  void hang(std::size_t i, const vp::SE3& T_world_parent, long by, int depth) {
    hung_[i] = true;
    const scenes::Body& body = scene_.bodies[i];
    const vp::SE3& T = body.T_world_body;
    text_ += fmt::format("<body name=\"b{}\" {}>", i, place(Inv(T_world_parent) * T));
    if (body.motion == scenes::Motion::dynamic) {
      const scenes::Mass mass = scenes::mass_of(body);
      text_ += fmt::format("<inertial pos=\"0 0 0\" mass=\"{:.17g}\" diaginertia=\"{}\"/>",
                           mass.mass, numbers(mass.moments));
      text_ += by < 0 ? "<freejoint/>" : joint(scene_.joints[by], static_cast<int>(i));
    }
    for (const scenes::Part& part : body.parts) text_ += geom(part);
    for (const std::size_t j : joints_of_[i]) {
      const scenes::Joint& next = scene_.joints[j];
      const auto other = static_cast<std::size_t>(next.a == static_cast<int>(i) ? next.b : next.a);
      if (depth == kDeepest || hung_[other] || scene_.bodies[other].motion == scenes::Motion::fixed)
        continue;
      used_[j] = true;
      hang(other, T, static_cast<long>(j), depth + 1);
    }
    text_ += "</body>\n";
  }

  // The joint in the frame of its child; the limits of a hinge are for rotation of the child.
  static std::string joint(const scenes::Joint& j, int child) {
    const bool turned = child == j.a;
    const vp::SE3& at = turned ? j.T_a_joint : j.T_b_joint;
    if (j.kind == scenes::Joint::Kind::ball) {
      return fmt::format("<joint type=\"ball\" pos=\"{}\"/>", numbers(at.position()));
    }
    std::string limits;
    if (std::isfinite(j.lower)) {
      limits = fmt::format("limited=\"true\" range=\"{} {}\"", turned ? -j.upper : j.lower,
                           turned ? -j.lower : j.upper);
    }
    return fmt::format("<joint type=\"hinge\" pos=\"{}\" axis=\"{}\" {}/>", numbers(at.position()),
                       numbers(at.rotation().cz), limits);
  }

  // Joints that close loops, a hinge by two points of its axis. Excludes collisions of joined
  // bodies.
  std::string rest() const {
    std::string equality, contact;
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const scenes::Joint& joint = scene_.joints[j];
      contact += fmt::format("<exclude body1=\"b{}\" body2=\"b{}\"/>\n", joint.a, joint.b);
      if (used_[j]) continue;
      const bool hinge = joint.kind == scenes::Joint::Kind::hinge;
      for (const double along : {-0.5, 0.5}) {
        const vp::Vec3 point = joint.T_a_joint * vp::Vec3{0, 0, hinge ? along : 0.0};
        if (!hinge && along > 0.0) break;
        equality += fmt::format("<connect body1=\"b{}\" body2=\"b{}\" anchor=\"{}\"/>\n", joint.a,
                                joint.b, numbers(point));
      }
    }
    return "<equality>\n" + equality + "</equality>\n<contact>\n" + contact + "</contact>\n";
  }

  const scenes::Scene& scene_;
  std::string text_;
  std::vector<bool> hung_, used_;
  std::vector<std::vector<std::size_t>> joints_of_;
};

class Mujoco final : public Engine {
 public:
  static MadeEngine make(const scenes::Scene& scene, double dt) {
    mju_user_warning = [](const char* text) { std::fprintf(stderr, "%s\n", text); };
    mju_user_error = [](const char* text) {  // it must not return
      std::fprintf(stderr, "%s\n", text);
      std::exit(1);
    };
    const Xml xml(scene, dt);
    mjVFS files;
    mj_defaultVFS(&files);
    // The length of a file is an int and includes the terminating zero.
    if (mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(xml.text().size()) + 1) != 0) {
      return tl::make_unexpected("its model cannot be handed over");
    }
    std::memcpy(files.filedata[files.nfile - 1], xml.text().c_str(), xml.text().size() + 1);
    char error[500] = "";
    mjModel* model = mj_loadXML("scene.xml", &files, error, sizeof(error));
    mj_deleteVFS(&files);
    if (!model) return tl::make_unexpected(std::string("it refuses the model: ") + error);
    return std::unique_ptr<Engine>(new Mujoco(scene, model));
  }
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  std::string settings() const override { return "double; Newton; pyramidal cones"; }
  std::string trouble() const override { return trouble_; }
  bool step() override {
    // A failed step leaves an unusable state, so the state before it is restored.
    const std::vector<mjtNum> q(data_->qpos, data_->qpos + model_->nq);
    const std::vector<mjtNum> v(data_->qvel, data_->qvel + model_->nv);
    const mjtNum time = data_->time;
    const std::vector<mjtNum> a(data_->qacc_warmstart, data_->qacc_warmstart + model_->nv);
    for (;;) {
      mj_step(model_, data_);
      const auto warned = [&](int of) { return data_->warning[of].number > 0; };
      const bool unstable =
          warned(mjWARN_BADQPOS) || warned(mjWARN_BADQVEL) || warned(mjWARN_BADQACC);
      if (!unstable && !warned(mjWARN_CONTACTFULL) && !warned(mjWARN_CNSTRFULL)) return true;
      if (unstable) trouble_ = "it calls the simulation unstable";
      const bool again = !unstable && make_room(2 * model_->njmax);
      mju_copy(data_->qpos, q.data(), model_->nq);
      mju_copy(data_->qvel, v.data(), model_->nv);
      mju_copy(data_->qacc_warmstart, a.data(), model_->nv);
      data_->time = time;
      if (!again) return false;
    }
  }
  // The velocities of a free joint are linear in the world frame and angular in the body's frame.
  void launch(const scenes::Launch& launch) override {
    const int v = model_->body_dofadr[ids_[launch.body]];
    const vp::Vec3 spin = poses()[launch.body].unrotate(launch.spin);
    for (int i = 0; i < 3; ++i) data_->qvel[v + i] = launch.velocity[i];
    for (int i = 0; i < 3; ++i) data_->qvel[v + 3 + i] = spin[i];
  }
  std::vector<vp::SE3> poses() const override {
    mj_kinematics(model_, data_);
    std::vector<vp::SE3> out;
    for (const int id : ids_) {
      const mjtNum *R = data_->xmat + 9 * id, *p = data_->xpos + 3 * id;
      out.emplace_back(vp::Mat3{{R[0], R[3], R[6]}, {R[1], R[4], R[7]}, {R[2], R[5], R[8]}},
                       vp::Vec3{p[0], p[1], p[2]});
    }
    return out;
  }

 private:
  Mujoco(const scenes::Scene& scene, mjModel* model) : model_(model) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      ids_.push_back(mj_name2id(model_, mjOBJ_BODY, fmt::format("b{}", i).c_str()));
    }
    make_room(1000);
    for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
      const scenes::Body& body = scene.bodies[i];
      if (begins_at_rest(body)) continue;
      launch({0.0, i, body.velocity, body.spin});
    }
  }
  // Creates its data again with this many rows, or with the maximum. Returns false if it has the
  // maximum already.
  bool make_room(int rows) {
    const int max = max_rows(model_->nv);
    if (data_ && model_->njmax == max) {
      trouble_ =
          fmt::format("its data holds {} rows of contacts at most beside so many bodies", max);
      return false;
    }
    if (data_) mj_deleteData(data_);
    model_->njmax = std::min(rows, max);
    model_->nconmax = model_->njmax / 3;
    // The same formula as MuJoCo's own choice.
    const double all = model_->njmax + model_->nv;
    model_->nstack = static_cast<int>(std::min(5.0 * all * all + 1e5, 2e9));
    data_ = mj_makeData(model_);
    return true;
  }

  mjModel* model_;
  mjData* data_ = nullptr;
  std::vector<int> ids_;
  std::string trouble_;
};

}  // namespace

MadeEngine make_engine(const scenes::Scene& scene, double dt) {
  if (const std::string why = beyond_simple(scene); !why.empty()) return tl::make_unexpected(why);
  if (scene.bodies.size() > kMaxBodies) {
    return tl::make_unexpected("a step of so many bodies takes it minutes");
  }
  for (const scenes::Body& body : scene.bodies) {
    if (!scene.joints.empty() && !begins_at_rest(body)) {
      return tl::make_unexpected("this comparison gives it joined bodies that begin at rest");
    }
  }
  return Mujoco::make(scene, dt);
}

}  // namespace rigid
