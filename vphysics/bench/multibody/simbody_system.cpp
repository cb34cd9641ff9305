#include "simbody_system.h"

#include <Simbody.h>

namespace vp::bench {

namespace {

SimTK::Vec3 three(const std::array<double, 3>& a) {
  return {a[0], a[1], a[2]};
}
SimTK::Vector numbers(const std::vector<double>& x) {
  return {static_cast<int>(x.size()), x.data()};
}
SimTK::Transform place_of(const SimbodySystem::Body& body) {
  const auto& R = body.rotation;
  const SimTK::Mat33 rows(R[0][0], R[0][1], R[0][2], R[1][0], R[1][1], R[1][2], R[2][0], R[2][1],
                          R[2][2]);
  return {SimTK::Rotation(rows, true), three(body.position)};
}
SimTK::Body::Rigid rigid(const SimbodySystem::Body& body) {
  const auto& I = body.inertia;
  return SimTK::Body::Rigid(SimTK::MassProperties(
      body.mass, three(body.centre), SimTK::Inertia(I[0], I[1], I[2], I[3], I[4], I[5])));
}

SimTK::MobilizedBodyIndex attach(SimTK::MobilizedBody& parent, const SimbodySystem::Body& body) {
  if (body.free) return SimTK::MobilizedBody::Free(parent, rigid(body)).getMobilizedBodyIndex();
  // A Pin rotates about z.
  SimTK::Rotation to_axis;
  to_axis.setRotationFromOneAxis(SimTK::UnitVec3(three(body.axis)), SimTK::ZAxis);
  const SimTK::Transform turned(to_axis);
  return SimTK::MobilizedBody::Pin(parent, place_of(body) * turned, rigid(body), turned)
      .getMobilizedBodyIndex();
}

}  // namespace

struct SimbodySystem::Inside {
  explicit Inside(const SimTK::Vec3& g) : gravity(forces, matter, g) {}

  struct Numbers {
    SimTK::Vector q, v, tau, a;
  };
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::Gravity gravity;
  SimTK::Force::DiscreteForces drive{forces, matter};
  SimTK::State state;
  std::vector<Numbers> states;
  SimTK::Vector none, out;
  SimTK::Matrix M;
};

SimbodySystem::SimbodySystem(const std::vector<Body>& bodies, const std::array<double, 3>& gravity)
    : inside_(std::make_unique<Inside>(three(gravity))) {
  SimTK::SimbodyMatterSubsystem& matter = inside_->matter;
  std::vector<SimTK::MobilizedBodyIndex> attached;
  for (const Body& body : bodies) {
    if (body.parent < 0) {
      attached.push_back(attach(matter.updGround(), body));
    } else {
      const auto parent = attached[static_cast<std::size_t>(body.parent)];
      attached.push_back(attach(matter.updMobilizedBody(parent), body));
    }
  }
  inside_->state = inside_->system.realizeTopology();
  inside_->system.realizeModel(inside_->state);
}

SimbodySystem::~SimbodySystem() = default;

void SimbodySystem::add_state(const std::vector<double>& q, const std::vector<double>& v,
                              const std::vector<double>& tau, const std::vector<double>& a) {
  inside_->states.push_back({numbers(q), numbers(v), numbers(tau), numbers(a)});
}

double SimbodySystem::forward(std::size_t state) {
  Inside& in = *inside_;
  in.state.updQ() = in.states[state].q;
  in.state.updU() = in.states[state].v;
  in.drive.setAllMobilityForces(in.state, in.states[state].tau);
  in.system.realize(in.state, SimTK::Stage::Acceleration);
  in.out = in.state.getUDot();
  return in.out[0];
}

double SimbodySystem::inverse(std::size_t state) {
  Inside& in = *inside_;
  in.state.updQ() = in.states[state].q;
  in.state.updU() = in.states[state].v;
  in.system.realize(in.state, SimTK::Stage::Velocity);
  in.matter.calcResidualForce(in.state, in.none, in.gravity.getBodyForces(in.state),
                              in.states[state].a, in.none, in.out);
  return in.out[0];
}

double SimbodySystem::mass(std::size_t state) {
  Inside& in = *inside_;
  in.state.updQ() = in.states[state].q;
  in.system.realize(in.state, SimTK::Stage::Position);
  in.matter.calcM(in.state, in.M);
  return in.M(0, 0);
}

std::vector<double> SimbodySystem::vector() const {
  std::vector<double> x;
  for (int i = 0; i < inside_->out.size(); ++i) x.push_back(inside_->out[i]);
  return x;
}

std::vector<double> SimbodySystem::matrix() const {
  std::vector<double> x;
  for (int i = 0; i < inside_->M.nrow(); ++i) {
    for (int j = 0; j < inside_->M.ncol(); ++j) x.push_back(inside_->M(i, j));
  }
  return x;
}

}  // namespace vp::bench
