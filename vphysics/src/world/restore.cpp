// Restores a state that snapshot() wrote. The head of snapshot.cpp describes the format.
//
// Two phases: all values are read into Incoming and checked there; then the world takes them over,
// which cannot fail. The world keeps Incoming and swaps its old data into it, so that the next
// restore allocates nothing. Derived data are kept if the state that they follow from is the same:
// poses of colliders, trees of the broad phase, lists of bodies.
#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "world/contact_state.h"
#include "world/impl.h"
#include "world/recorded_call.h"

namespace vp {
namespace {

// The state of a body.
struct SavedBody {
  SE3 T;
  Vec3 w, v;
  se3 prescribed;
  Velocity last_acceleration;
};
// The state of a degree of freedom.
struct DofState {
  double v = 0.0;
  JointDrive drive;
  std::array<double, kRowsOfDof> impulses{};
};
// The state of a joint.
struct JointState {
  double rotated[2] = {};
  SE3 start[2];
  JointDrive drives[6];
  double impulse[6] = {}, stop[6] = {};
};

SE3 read_pose(Reader& in) {
  const Vec3 cx = in.vector(), cy = in.vector(), cz = in.vector(), p = in.vector();
  const SE3 T({cx, cy, cz}, p);
  in.check(is_pose(T));
  return T;
}

void read(Reader& in, const Body& body, SavedBody& state) {
  state.T = read_pose(in);
  state.w = in.nearly_bounded_vector();
  state.v = in.nearly_bounded_vector();
  state.prescribed.w = in.vector();
  state.prescribed.v = in.vector();
  if (body.motion != Motion::kinematic) return;
  state.last_acceleration.w = in.finite_vector();
  state.last_acceleration.v = in.finite_vector();
}

void read(Reader& in, const JointDof& dof, DofState& state) {
  state.v = in.bounded();
  JointDrive& d = state.drive;
  d.position = in.bounded();
  d.velocity = in.bounded();
  d.stiffness = in.number();
  d.damping = in.number();
  d.max_force = in.number();
  in.check(!problem_with(d).has_value() && (dof.coordinate >= 0 || d.stiffness == 0.0));
  for (double& x : state.impulses) x = in.number();
}

void read(Reader& in, const Colliders& colliders, PairRecord& r) {
  r.key = in.u64();
  const std::uint64_t both = in.u64(), flags = in.u64();
  r.a = static_cast<std::uint32_t>(both >> 32);
  r.b = static_cast<std::uint32_t>(both);
  r.count = static_cast<std::uint32_t>(flags >> 32);
  r.touching = (flags & 1u) != 0;
  r.part = static_cast<std::uint32_t>(flags) >> 1;
  in.check(r.count <= collide::kMaxPoints && !(r.touching && r.part > 0));
  const bool exist = r.a < colliders.size() && r.b < colliders.size() && r.a != r.b &&
                     colliders[r.a].alive && colliders[r.b].alive;
  in.check(exist && make_pair(colliders, r.a, r.b).key == r.key &&
           colliders[r.a].serial < colliders[r.b].serial);
  if (!in.ok()) return;
  in.check(r.part == 0 || has_parts(colliders[r.a].geometry, colliders[r.b].geometry));
  r.rolling = in.vector();
  for (PairPoint& p : r.points) {
    const std::uint64_t feature = in.u64();
    in.check(feature <= 0xffffffffu);
    p.feature = static_cast<std::uint32_t>(feature);
    p.normal_impulse = in.bounded();
    in.check(p.normal_impulse >= 0.0);
    p.friction = in.vector();
    p.position = in.vector();
  }
}

ColliderId read_id(Reader& in, const Colliders& colliders) {
  const std::uint64_t w = in.u64();
  const ColliderId id{static_cast<std::uint32_t>(w >> 32), static_cast<std::uint32_t>(w)};
  in.check(id.index >= 1 && id.index <= colliders.size() && id.generation >= 1 &&
           id.generation <= colliders[id.index - 1].generation);
  return id;
}

void read(Reader& in, const Colliders& colliders, DestroyedPair& pair) {
  pair.a = read_id(in, colliders);
  pair.b = read_id(in, colliders);
  const std::uint64_t sensor = in.u64();
  in.check(sensor <= 1 && pair.a != pair.b);
  pair.sensor = sensor != 0;
}

JointState read(Reader& in, const BodyJoint& joint) {
  JointState state;
  for (double& x : state.rotated) x = in.bounded();
  if (joint.spec.form == JointSpec::Form::gear) {
    for (SE3& T : state.start) T = read_pose(in);
  }
  for (int i = 0; i < 6; ++i) {
    if (joint.spec.form == JointSpec::Form::axes) {
      JointDrive& d = state.drives[i];
      for (double* x : {&d.position, &d.velocity, &d.stiffness, &d.damping, &d.max_force})
        *x = in.number();
      const bool locked = joint.spec.axes[i].motion == AxisMotion::locked;
      in.check(!problem_with(d).has_value() && !(locked && d.max_force > 0.0));
    }
    state.impulse[i] = in.number();
    state.stop[i] = in.number();
  }
  return state;
}
void adopt(BodyJoint& joint, const JointState& state) {
  std::copy_n(state.rotated, 2, joint.rotated);
  joint.count = joint.locked = 0;
  joint.rows_sub_step = 0.0;
  joint.force = joint.torque = {};
  const bool axes = joint.spec.form == JointSpec::Form::axes;
  if (joint.spec.form == JointSpec::Form::gear) std::copy_n(state.start, 2, joint.start);
  for (int i = 0; i < 6; ++i) {
    if (axes) joint.spec.axes[i].drive = state.drives[i];
    BodyJointRow& row = joint.rows[joint.count++];
    row = {};
    row.slot = static_cast<std::uint8_t>(i);
    joint.impulse[i] = state.impulse[i];
    joint.stop[i] = state.stop[i];
  }
}

bool same_bits(const SE3& a, const SE3& b) {
  const auto same = [](const Vec3& x, const Vec3& y) {
    const auto bits = [](double d) { return std::bit_cast<std::uint64_t>(d); };
    return bits(x.x) == bits(y.x) && bits(x.y) == bits(y.y) && bits(x.z) == bits(y.z);
  };
  const Mat3 &A = a.rotation(), &B = b.rotation();
  return same(a.position(), b.position()) && same(A.cx, B.cx) && same(A.cy, B.cy) &&
         same(A.cz, B.cz);
}

tl::unexpected<Error> bad(const char* message) {
  return tl::make_unexpected(Error{Errc::bad_data, message});
}

std::uint64_t digest_of(std::span<const std::byte> bytes) {
  Reader in(bytes);
  while (!in.at_end()) (void)in.u64();
  return in.digest();
}

}  // namespace

// The state that was read and checked, before the world takes it over.
struct World::Impl::Incoming {
  explicit Incoming(Impl& of) : world(of), contacts(of.contact_data()) {}

  // Returns the problem, or null.
  const char* read(Reader& in);
  void read_joints(Reader& in);
  void read_records(Reader& in, std::size_t count, std::size_t destroyed_count);
  void read_loads(Reader& in);

  Impl& world;
  SubStepState sub_steps;
  double impact_step = 0.0;
  std::vector<SavedBody> bodies;  // without links
  std::vector<double> q;          // of all articulations, concatenated, as dofs
  std::vector<DofState> dofs;
  std::vector<PairRecord> records;
  std::vector<DestroyedPair> destroyed_pairs;
  std::vector<JointState> joints;  // of joints that are alive
  std::vector<BodyLoad> loads;
  // Indices of articulations with loads; loads on their links and on their joints, concatenated.
  std::vector<std::uint32_t> loaded;
  std::vector<dse3> link_loads;
  std::vector<double> joint_loads;
  ContactState contacts;
};

const char* World::Impl::Incoming::read(Reader& in) {
  if (in.u64() != kSnapshotMagic || in.u64() != kSnapshotFormat) {
    return "restore: not a snapshot of this version; take a new one";
  }
  if (in.u64() != world.topology_hash || in.u64() != world.bodies.size() ||
      in.u64() != world.articulations.size()) {
    return "restore: a snapshot of another world; build this one by the same sequence of calls";
  }
  constexpr std::size_t kRecord = 38, kPair = 3;  // u64 each
  const std::size_t count = in.count(kRecord), destroyed_count = in.count(kPair);
  if (!in.ok()) return "restore: more contacts announced than bytes follow";

  sub_steps.length = in.bounded();
  sub_steps.last_step_length = in.bounded();
  in.check(sub_steps.length >= 0.0 && sub_steps.last_step_length >= 0.0);
  sub_steps.position_error = in.index(2) != 0;
  impact_step = in.bounded();
  in.check(impact_step >= 0.0);
  bodies.clear();
  for (const Body& body : world.bodies) {
    if (!body.is_link) vp::read(in, body, bodies.emplace_back());
  }
  read_joints(in);
  read_records(in, count, destroyed_count);
  joints.clear();
  for (const BodyJoint& joint : world.joints) {
    if (joint.alive && in.ok()) joints.push_back(vp::read(in, joint));
  }
  if (in.ok()) contacts.read(in);
  read_loads(in);
  const bool complete = in.ok() && in.at_end();
  return complete ? nullptr : "restore: a value is out of range; the bytes are damaged";
}

void World::Impl::Incoming::read_joints(Reader& in) {
  q.clear();
  dofs.clear();
  for (const Articulation& art : world.articulations) {
    if (!art.alive) continue;
    const std::size_t first = q.size();
    for (std::size_t i = 0; i < art.q.size(); ++i) q.push_back(in.bounded());
    for (const JointDof& dof : art.dofs) vp::read(in, dof, dofs.emplace_back());
    in.check(has_unit_quaternions(art.model(), std::span(q).subspan(first)));
  }
}

void World::Impl::Incoming::read_loads(Reader& in) {
  loads.clear();
  loaded.clear();
  link_loads.clear();
  joint_loads.clear();
  if (!in.ok() || in.at_end()) return;
  constexpr std::size_t kLoad = 7;  // u64 each
  std::uint32_t next = 0;
  std::size_t state = 0;  // index of that body's state in `bodies`
  for (std::size_t n = in.count(kLoad); n > 0 && in.ok(); --n) {
    BodyLoad load;
    load.body = in.index(world.bodies.size());
    load.force = in.finite_vector();
    load.torque = in.finite_vector();
    in.check(loads.empty() || loads.back().body < load.body);
    if (!in.ok()) return;
    for (; next < load.body; ++next) state += world.bodies[next].is_link ? 0 : 1;
    const Body& body = world.bodies[load.body];
    in.check(body.alive && !body.is_link && body.motion == Motion::dynamic);
    if (!in.ok()) return;
    in.check(load_in_range(body, bodies[state].T.rotation(), 0.5 * load.force, 0.5 * load.torque));
    loads.push_back(load);
  }
  for (std::size_t n = in.count(1); n > 0 && in.ok(); --n) {
    const std::uint32_t a = in.index(world.articulations.size());
    in.check(loaded.empty() || loaded.back() < a);
    in.check(in.ok() && world.articulations[a].alive);
    if (!in.ok()) return;
    loaded.push_back(a);
    const Articulation& art = world.articulations[a];
    for (std::size_t l = 0; l < art.bodies.size(); ++l) {
      const Vec3 m = in.vector(), f = in.vector();
      link_loads.push_back({m, f});
    }
    for (std::size_t i = 0; i < art.v.size(); ++i) joint_loads.push_back(in.bounded());
  }
  in.check(!loads.empty() || !loaded.empty());
}

void World::Impl::Incoming::read_records(Reader& in, std::size_t count,
                                         std::size_t destroyed_count) {
  records.resize(count);
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    vp::read(in, world.colliders, records[i]);
    const auto place = [&](std::size_t k) { return std::pair(records[k].key, records[k].part); };
    in.check(i == 0 || place(i - 1) < place(i));
  }
  destroyed_pairs.resize(destroyed_count);
  for (std::size_t i = 0; i < destroyed_count && in.ok(); ++i) {
    vp::read(in, world.colliders, destroyed_pairs[i]);
  }
}

void World::Impl::adopt(Incoming& from) {
  auto state = from.bodies.cbegin();
  for (Body& body : bodies) {
    if (body.is_link) continue;
    if (!same_bits(body.T, state->T)) {
      body.T = state->T;
      body.moved();
      // The swept pairs were found with the poses of fixed bodies.
      if (body.motion == Motion::fixed) lists.invalidate();
    }
    body.w = state->w;
    body.v = state->v;
    body.prescribed = state->prescribed;
    body.last_acceleration = state->last_acceleration;
    ++state;
  }
  auto q = from.q.cbegin();
  auto dof = from.dofs.cbegin();
  for (Articulation& art : articulations) {
    if (!art.alive) continue;
    for (double& x : art.q) x = *q++;
    for (std::size_t i = 0; i < art.v.size(); ++i, ++dof) {
      art.v[i] = dof->v;
      art.dofs[i].drive = dof->drive;
      art.dofs[i].impulses = dof->impulses;
    }
    art.drives_changed();
    art.forget_step();
    art.refresh();
    follow(art);
  }
  auto joint_state = from.joints.cbegin();
  for (BodyJoint& joint : joints) {
    if (joint.alive) vp::adopt(joint, *joint_state++);
  }
  clear_loads();
  for (const BodyLoad& load : from.loads) loads.set(bodies, load.body, load.force, load.torque);
  auto link_load = from.link_loads.cbegin();
  auto joint_load = from.joint_loads.cbegin();
  for (const std::uint32_t a : from.loaded) {
    Articulation& art = articulations[a];
    const int links = art.model().links();
    for (int l = 0; l < links; ++l) art.set_load(l, *link_load++);
    for (std::size_t i = 0; i < art.v.size(); ++i) art.set_joint_load(i, *joint_load++);
  }
  from.contacts.adopt();
  sub_step_state = from.sub_steps;
  impacts.set_step_length(from.impact_step);
  ready_for_queries = false;
  pair_contacts.swap_records(from.records);
  events.destroyed.swap(from.destroyed_pairs);
  events.clear();
  step_contacts.clear();
  counters = {};
  sub_steps_taken = 0;
}

Expected<void> World::restore(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeader = 7 * sizeof(std::uint64_t), kTail = sizeof(std::uint64_t);
  if (bytes.size() < kHeader + kTail || bytes.size() % sizeof(std::uint64_t) != 0) {
    return bad("restore: too short to be a snapshot; give what snapshot() wrote");
  }
  if (!impl_->incoming) impl_->incoming = std::make_shared<Impl::Incoming>(*impl_);
  const std::span<const std::byte> words = bytes.first(bytes.size() - kTail);
  std::uint64_t digest = 0;
  std::memcpy(&digest, bytes.data() + words.size(), sizeof digest);
  Reader in(words);
  const char* problem = impl_->incoming->read(in);
  if (problem != nullptr ? digest_of(words) != digest : in.digest() != digest) {
    return bad("restore: the checksum is wrong; the bytes are damaged");
  }
  if (problem != nullptr) return bad(problem);
  impl_->adopt(*impl_->incoming);
  if (impl_->recorder) impl_->log({calls::Restore{{bytes.begin(), bytes.end()}}});
  return {};
}

}  // namespace vp
