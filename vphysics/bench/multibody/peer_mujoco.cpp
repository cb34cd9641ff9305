// MuJoCo, without collision, contacts and actuation: calls only the functions that the three
// metrics need.
//
//   forward  mj_kinematics, mj_comPos, mj_crb, mj_factorM, mj_comVel, mj_rne, mj_solveM
//   inverse  mj_kinematics, mj_comPos, mj_comVel, mj_rne with accelerations
//   mass     mj_kinematics, mj_comPos, mj_crb, mj_fullM
//
// Its free joint: position, quaternion (w, x, y, z); linear velocity in world axes, then angular
// velocity in body axes.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine.h"

namespace vp::bench {
namespace {

constexpr BaseConvention kBase{
    .linear_first = true, .angular_in_world = false, .linear_in_world = true};

std::string numbers(const Vec3& a) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", a.x, a.y, a.z);
}

// Rotations about the fixed axes x, y, z, in this order.
Vec3 roll_pitch_yaw(const Mat3& R) {
  return {std::atan2(R.cy.z, R.cz.z), std::asin(std::clamp(-R.cx.z, -1.0, 1.0)),
          std::atan2(R.cx.y, R.cx.x)};
}

std::string name_of_link(int link) {
  return link == kWorld ? "world" : "link" + std::to_string(link);
}

// URDF, which lists its links. MJCF nests them, and its reader rejects more than a hundred levels.
std::string urdf(const BenchModel& model) {
  std::string xml = fmt::format(
      "<robot name=\"{}\"><mujoco><size njmax=\"1\" nconmax=\"1\"/><option "
      "gravity=\"{}\"/></mujoco>"
      "<link name=\"world\"/>",
      model.name, numbers(kGravity));
  for (int i = 0; i < static_cast<int>(model.links.size()); ++i) {
    const LinkSpec& link = model.links[static_cast<std::size_t>(i)];
    const Sym3 I = link.inertia.central();
    xml += fmt::format(
        "<link name=\"{}\"><inertial><origin xyz=\"{}\"/><mass value=\"{:.17g}\"/>"
        "<inertia ixx=\"{:.17g}\" iyy=\"{:.17g}\" izz=\"{:.17g}\" ixy=\"{:.17g}\" "
        "iyz=\"{:.17g}\" ixz=\"{:.17g}\"/></inertial></link>",
        name_of_link(i), numbers(link.inertia.centre_of_mass()), link.inertia.mass(), I.xx, I.yy,
        I.zz, I.xy, I.yz, I.zx);
    const bool free = std::holds_alternative<FreeJoint>(link.joint);
    xml += fmt::format(
        "<joint name=\"joint{}\" type=\"{}\"><origin xyz=\"{}\" rpy=\"{}\"/>"
        "<axis xyz=\"{}\"/><parent link=\"{}\"/><child link=\"{}\"/></joint>",
        i, free ? "floating" : "continuous", numbers(link.T_parent_joint.position()),
        numbers(roll_pitch_yaw(link.T_parent_joint.rotation())),
        numbers(free ? Vec3{0, 0, 1} : axis_of(link)), name_of_link(link.parent), name_of_link(i));
  }
  return xml + "</robot>";
}

void put(mjtNum* out, const Vec3& a) {
  out[0] = a.x, out[1] = a.y, out[2] = a.z;
}
void put(mjtNum* out, const Mat3& R) {
  const Quaternion q = to_quaternion(R);
  out[0] = q.w, out[1] = q.x, out[2] = q.y, out[3] = q.z;
}

// The reader computes principal axes to 11 digits; these have 16.
void write_exactly(const BenchModel& model, mjModel& m) {
  for (int i = 0; i < static_cast<int>(model.links.size()); ++i) {
    const LinkSpec& link = model.links[static_cast<std::size_t>(i)];
    const PrincipalInertia J = principal_inertia(link.inertia);
    const int body = mj_name2id(&m, mjOBJ_BODY, name_of_link(i).c_str());
    put(m.body_pos + 3 * body, link.T_parent_joint.position());
    put(m.body_quat + 4 * body, link.T_parent_joint.rotation());
    put(m.body_ipos + 3 * body, J.centre);
    put(m.body_iquat + 4 * body, J.axes);
    put(m.body_inertia + 3 * body, J.moments);
  }
}

struct Freed {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, Freed>;
using DataPointer = std::unique_ptr<mjData, Freed>;

class MuJoCo final : public Engine {
 public:
  MuJoCo(const BenchModel& model, const std::vector<State>& states, ModelPointer m, DataPointer d)
      : model_(std::move(m)), data_(std::move(d)), free_(model.free_base), ours_(states) {
    for (State s : states) {
      if (free_) {
        const BaseMap base(kBase, s);
        base.to(s.v);
        base.to(s.tau);
        base.acceleration_to(s.a);
        std::rotate(s.q.begin() + 3, s.q.begin() + 6, s.q.begin() + 7);  // w first
      }
      states_.push_back(std::move(s));
    }
    out_.resize(static_cast<std::size_t>(model_->nv));
    bias_.resize(out_.size());
    M_.resize(out_.size() * out_.size());
  }

  double call(Metric metric, std::size_t state) override {
    const State& s = states_[state];
    const mjModel* m = model_.get();
    mjData* d = data_.get();
    mju_copy(d->qpos, s.q.data(), m->nq);
    mj_kinematics(m, d);
    mj_comPos(m, d);
    if (metric == Metric::mass) {
      mj_crb(m, d);
      mj_fullM(m, M_.data(), d->qM);
      return M_.back();
    }
    mju_copy(d->qvel, s.v.data(), m->nv);
    if (metric == Metric::inverse) {
      mju_copy(d->qacc, s.a.data(), m->nv);
      mj_comVel(m, d);
      mj_rne(m, d, 1, out_.data());
      return out_.back();
    }
    mj_crb(m, d);
    mj_factorM(m, d);
    mj_comVel(m, d);
    mj_rne(m, d, 0, bias_.data());
    mju_sub(bias_.data(), s.tau.data(), bias_.data(), m->nv);
    mj_solveM(m, d, out_.data(), bias_.data(), 1);
    return out_.back();
  }

  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    std::vector<double> x = metric == Metric::mass ? M_ : out_;
    if (!free_) return x;
    const BaseMap base(kBase, ours_[state]);
    if (metric == Metric::forward) base.acceleration_from(x);
    if (metric == Metric::inverse) base.from(x);
    if (metric == Metric::mass) base.mass_from(x, model_->nv);
    return x;
  }

 private:
  ModelPointer model_;
  DataPointer data_;
  bool free_;
  const std::vector<State>& ours_;
  std::vector<State> states_;
  std::vector<double> out_, bias_, M_;
};

}  // namespace

MadeEngine make_mujoco(const BenchModel& model, const std::vector<State>& states) {
  const std::string xml = urdf(model);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* kName = "model.urdf";
  if (mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(xml.size())) != 0) {
    return tl::make_unexpected("no memory for its description");
  }
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[512] = "";
  ModelPointer m(mj_loadXML(kName, files.get(), error, sizeof(error)));
  mj_deleteVFS(files.get());
  if (!m) return tl::make_unexpected(std::string("its reader says: ") + error);
  write_exactly(model, *m);
  DataPointer d(mj_makeData(m.get()));
  if (!d) return tl::make_unexpected("no memory for its data");
  mj_setConst(m.get(), d.get());
  return std::make_unique<MuJoCo>(model, states, std::move(m), std::move(d));
}

}  // namespace vp::bench
