// Simbody: a SimbodyMatterSubsystem with gravity and forces on its mobilities.
#include "engine.h"
#include "simbody_system.h"

namespace vp::bench {
namespace {

constexpr BaseConvention kBase{
    .linear_first = false, .angular_in_world = true, .linear_in_world = true};

std::array<double, 3> array(const Vec3& a) {
  return {a.x, a.y, a.z};
}

std::vector<SimbodySystem::Body> bodies_of(const BenchModel& model) {
  std::vector<SimbodySystem::Body> bodies;
  for (const LinkSpec& link : model.links) {
    const bool free = std::holds_alternative<FreeJoint>(link.joint);
    const Mat3 rows = transpose(link.T_parent_joint.rotation());
    const Sym3& I = link.inertia.rotational();
    bodies.push_back({.parent = link.parent,
                      .free = free,
                      .rotation = {array(rows.cx), array(rows.cy), array(rows.cz)},
                      .position = array(link.T_parent_joint.position()),
                      .axis = free ? std::array<double, 3>{} : array(axis_of(link)),
                      .mass = link.inertia.mass(),
                      .centre = array(link.inertia.centre_of_mass()),
                      .inertia = {I.xx, I.yy, I.zz, I.xy, I.zx, I.yz}});
  }
  return bodies;
}

class Simbody final : public Engine {
 public:
  Simbody(const BenchModel& model, const std::vector<State>& states)
      : system_(bodies_of(model), array(kGravity)), free_(model.free_base), ours_(states) {
    for (State s : states) {
      if (free_) {
        const BaseMap base(kBase, s);
        base.to(s.v);
        base.to(s.tau);
        base.acceleration_to(s.a);
        const std::array<double, 7> q = {s.q[6], s.q[3], s.q[4], s.q[5], s.q[0], s.q[1], s.q[2]};
        std::copy(q.begin(), q.end(), s.q.begin());
      }
      system_.add_state(s.q, s.v, s.tau, s.a);
    }
  }

  double call(Metric metric, std::size_t state) override {
    if (metric == Metric::forward) return system_.forward(state);
    if (metric == Metric::inverse) return system_.inverse(state);
    return system_.mass(state);
  }

  std::vector<double> result(Metric metric, std::size_t state) override {
    call(metric, state);
    std::vector<double> x = metric == Metric::mass ? system_.matrix() : system_.vector();
    if (!free_) return x;
    const BaseMap base(kBase, ours_[state]);
    if (metric == Metric::forward) base.acceleration_from(x);
    if (metric == Metric::inverse) base.from(x);
    if (metric == Metric::mass) base.mass_from(x, static_cast<int>(ours_[state].v.size()));
    return x;
  }

 private:
  SimbodySystem system_;
  bool free_;
  const std::vector<State>& ours_;
};

}  // namespace

MadeEngine make_simbody(const BenchModel& model, const std::vector<State>& states) {
  return std::make_unique<Simbody>(model, states);
}

}  // namespace vp::bench
