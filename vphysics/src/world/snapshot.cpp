// The mutable state as bytes: 8-byte little-endian words.
//
//   magic, format, structure digest, numbers of bodies, articulations, pair
//   records, destroyed pairs; lengths of sub-steps: of impulses, of the push
//   bodies:         pose (12), w, v, prescribed twist (6); of a link, nothing
//   articulations:  coordinates; for each velocity: itself, drive (5), drive impulse
//   records:        key, a | b, count | number of the manifold and touching, rolling, 4 points
//   destroyed pairs: a (index, generation), b, sensor
//   joints:         turns; of a gear its bodies' first poses; of each axis its drive (5) and
//                   impulses (2)
//   contacts:       contact_state.h
//   digest of all words before
#include <bit>
#include <cstring>
#include <utility>

#include "world/contact_state.h"
#include "world/recorded_call.h"

namespace vp {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMagic = 0x31534359'48505650u;  // "PVPHYCS1"
constexpr std::uint64_t kFormat = 11;

struct Digest {
  std::uint64_t digest = kMagic;
  void word(std::uint64_t w) { digest = mixed(digest, w); }
};

struct ByteSink : Digest {
  std::vector<std::byte>& bytes;
  explicit ByteSink(std::vector<std::byte>& b) : bytes(b) {}
  void word(std::uint64_t w) {
    Digest::word(w);
    const std::size_t n = bytes.size();
    bytes.resize(n + sizeof w);
    std::memcpy(bytes.data() + n, &w, sizeof w);
  }
};

using vp::put;

template <class Sink>
void put(Sink& sink, const PairRecord& r) {
  sink.word(r.key);
  sink.word((std::uint64_t{r.a} << 32) | r.b);
  sink.word((std::uint64_t{r.count} << 32) | (std::uint64_t{r.part} << 1) | (r.touching ? 1u : 0u));
  put(sink, r.rolling);
  for (const PairPoint& p : r.points) {
    sink.word(p.feature);
    put(sink, p.normal_impulse);
    put(sink, p.friction);
    put(sink, p.position);
  }
}

std::uint64_t word_of(ColliderId id) {
  return (std::uint64_t{id.index} << 32) | id.generation;
}
template <class Sink>
void put(Sink& sink, const DestroyedPair& pair) {
  sink.word(word_of(pair.a));
  sink.word(word_of(pair.b));
  sink.word(pair.sensor ? 1u : 0u);
}

void read(Reader& in, Body& body) {
  const Vec3 cx = in.vector(), cy = in.vector(), cz = in.vector(), p = in.vector();
  body.T = SE3({cx, cy, cz}, p);
  body.moved();
  in.check(is_pose(body.T));
  body.w = in.vector();
  body.v = in.vector();
  body.prescribed.w = in.vector();
  body.prescribed.v = in.vector();
}

// What of an articulation changes.
struct ArticulationState {
  std::vector<double> q, v;
  std::vector<JointDof> dofs;
};

void read(Reader& in, JointDof& dof) {
  JointDrive& d = dof.drive;
  d.position = in.bounded();
  d.velocity = in.bounded();
  d.stiffness = in.number();
  d.damping = in.number();
  d.max_force = in.number();
  in.check(!problem_with(d).has_value() && (dof.coordinate >= 0 || d.stiffness == 0.0));
  dof.drive_impulse = in.number();
}

ArticulationState read(Reader& in, const Articulation& art) {
  ArticulationState state{art.q, art.v, art.dofs};
  for (double& x : state.q) x = in.bounded();
  for (std::size_t i = 0; i < state.v.size(); ++i) {
    state.v[i] = in.bounded();
    read(in, state.dofs[i]);
  }
  in.check(has_unit_quaternions(art.model(), state.q));
  return state;
}

void read(Reader& in, const std::vector<Collider>& colliders, PairRecord& r) {
  r.key = in.word();
  const std::uint64_t both = in.word(), flags = in.word();
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
    const std::uint64_t feature = in.word();
    in.check(feature <= 0xffffffffu);
    p.feature = static_cast<std::uint32_t>(feature);
    p.normal_impulse = in.bounded();
    in.check(p.normal_impulse >= 0.0);
    p.friction = in.vector();
    p.position = in.vector();
  }
}

ColliderId read_id(Reader& in, const std::vector<Collider>& colliders) {
  const std::uint64_t w = in.word();
  const ColliderId id{static_cast<std::uint32_t>(w >> 32), static_cast<std::uint32_t>(w)};
  in.check(id.index >= 1 && id.index <= colliders.size() && id.generation >= 1 &&
           id.generation <= colliders[id.index - 1].generation);
  return id;
}

void read(Reader& in, const std::vector<Collider>& colliders, DestroyedPair& pair) {
  pair.a = read_id(in, colliders);
  pair.b = read_id(in, colliders);
  const std::uint64_t sensor = in.word();
  in.check(sensor <= 1 && pair.a != pair.b);
  pair.sensor = sensor != 0;
}

// What of a joint changes.
struct JointState {
  double turned[2] = {};
  SE3 start[2];
  JointDrive drives[6];
  double impulse[6] = {}, stop[6] = {};
};

template <class Sink>
void put(Sink& sink, const SE3& T) {
  const Mat3& R = T.rotation();
  for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &T.position()}) put(sink, *v);
}
template <class Sink>
void put(Sink& sink, const BodyJoint& joint) {
  put(sink, joint.turned[0]);
  put(sink, joint.turned[1]);
  if (joint.law.form == JointLaw::Form::gear) {
    put(sink, joint.start[0]);
    put(sink, joint.start[1]);
  }
  double impulse[6] = {}, stop[6] = {};
  for (int i = 0; i < joint.block.count; ++i) {
    const solve::JointRow6& row = joint.block.rows[i];
    impulse[row.slot] = row.impulse;
    stop[row.slot] = row.stop;
  }
  for (int i = 0; i < 6; ++i) {
    if (joint.law.form == JointLaw::Form::axes) {
      const JointDrive& d = joint.law.axes[i].drive;
      for (const double x : {d.position, d.velocity, d.stiffness, d.damping, d.max_force})
        put(sink, x);
    }
    put(sink, impulse[i]);
    put(sink, stop[i]);
  }
}

SE3 read_pose(Reader& in) {
  const Vec3 cx = in.vector(), cy = in.vector(), cz = in.vector(), p = in.vector();
  const SE3 T({cx, cy, cz}, p);
  in.check(is_pose(T));
  return T;
}
JointState read(Reader& in, const BodyJoint& joint) {
  JointState state;
  for (double& x : state.turned) x = in.bounded();
  if (joint.law.form == JointLaw::Form::gear) {
    for (SE3& T : state.start) T = read_pose(in);
  }
  for (int i = 0; i < 6; ++i) {
    if (joint.law.form == JointLaw::Form::axes) {
      JointDrive& d = state.drives[i];
      for (double* x : {&d.position, &d.velocity, &d.stiffness, &d.damping, &d.max_force})
        *x = in.number();
      const bool held = joint.law.axes[i].motion == AxisMotion::locked;
      in.check(!problem_with(d).has_value() && !(held && d.max_force > 0.0));
    }
    state.impulse[i] = in.number();
    state.stop[i] = in.number();
  }
  return state;
}
void adopt(BodyJoint& joint, const JointState& state) {
  std::copy_n(state.turned, 2, joint.turned);
  joint.block = {};
  joint.laid_out_for = 0.0;
  joint.force = joint.torque = {};
  const bool axes = joint.law.form == JointLaw::Form::axes;
  if (joint.law.form == JointLaw::Form::gear) std::copy_n(state.start, 2, joint.start);
  for (int i = 0; i < 6; ++i) {
    if (axes) joint.law.axes[i].drive = state.drives[i];
    solve::JointRow6& row = joint.block.rows[joint.block.count++];
    row.slot = static_cast<std::uint8_t>(i);
    row.impulse = state.impulse[i];
    row.stop = state.stop[i];
  }
}

tl::unexpected<Error> bad(const char* message) {
  return tl::make_unexpected(Error{Errc::bad_data, message});
}

}  // namespace

template <class Sink>
void World::Impl::write(Sink& sink) const {
  sink.word(kMagic);
  sink.word(kFormat);
  sink.word(structure);
  sink.word(bodies.size());
  sink.word(articulations.size());
  sink.word(records.size());
  sink.word(destroyed_pairs.size());
  put(sink, sub_step_before);
  put(sink, push_length);
  for (const Body& body : bodies) {
    if (body.is_link) continue;
    const Mat3& R = body.T.rotation();
    for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &body.T.position(), &body.w, &body.v,
                          &body.prescribed.w, &body.prescribed.v}) {
      put(sink, *v);
    }
  }
  for (const Articulation& art : articulations) {
    for (const double x : art.q) put(sink, x);
    for (std::size_t i = 0; i < art.v.size(); ++i) {
      const JointDrive& d = art.dofs[i].drive;
      for (const double x : {art.v[i], d.position, d.velocity, d.stiffness, d.damping, d.max_force,
                             art.dofs[i].drive_impulse}) {
        put(sink, x);
      }
    }
  }
  for (const PairRecord& record : records) put(sink, record);
  for (const DestroyedPair& pair : destroyed_pairs) put(sink, pair);
  for (const BodyJoint& joint : joints) {
    if (joint.alive) put(sink, joint);
  }
  write_contacts(sink);
}

void World::snapshot(std::vector<std::byte>& bytes) const {
  ByteSink sink(bytes);
  impl_->write(sink);
  sink.word(sink.digest);
}

std::uint64_t World::state_hash() const {
  Digest sink;
  impl_->write(sink);
  return sink.digest;
}

Expected<void> World::restore(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeader = 7 * sizeof(std::uint64_t), kTail = sizeof(std::uint64_t);
  if (bytes.size() < kHeader + kTail || bytes.size() % sizeof(std::uint64_t) != 0) {
    return bad("restore: too short to be a snapshot; hand in what snapshot() wrote");
  }
  Digest digest;
  Reader all(bytes.first(bytes.size() - kTail));
  while (!all.at_end()) digest.word(all.word());
  Reader tail(bytes.last(kTail));
  if (tail.word() != digest.digest)
    return bad("restore: the checksum is wrong; the bytes are damaged");

  Reader in(bytes.first(bytes.size() - kTail));
  if (in.word() != kMagic || in.word() != kFormat) {
    return bad("restore: not a snapshot of this version; take a new one");
  }
  if (in.word() != impl_->structure || in.word() != impl_->bodies.size() ||
      in.word() != impl_->articulations.size()) {
    return bad(
        "restore: a snapshot of another world; build this one by the same sequence of calls");
  }
  constexpr std::size_t kRecord = 38, kPair = 3;  // words
  const std::size_t count = in.count(kRecord), destroyed_count = in.count(kPair);
  if (!in.ok()) return bad("restore: more contacts announced than bytes follow");

  const double sub_step_before = in.bounded();
  const double push_length = in.bounded();
  in.check(sub_step_before >= 0.0 && push_length >= 0.0);
  std::vector<Body> bodies = impl_->bodies;
  std::vector<ArticulationState> articulations;
  std::vector<PairRecord> records(count);
  std::vector<DestroyedPair> destroyed_pairs(destroyed_count);
  for (Body& body : bodies) {
    if (!body.is_link) read(in, body);
  }
  for (const Articulation& art : impl_->articulations) articulations.push_back(read(in, art));
  for (std::size_t i = 0; i < records.size() && in.ok(); ++i) {
    read(in, impl_->colliders, records[i]);
    const auto place = [&](std::size_t k) { return std::pair(records[k].key, records[k].part); };
    in.check(i == 0 || place(i - 1) < place(i));
  }
  for (std::size_t i = 0; i < destroyed_pairs.size() && in.ok(); ++i) {
    read(in, impl_->colliders, destroyed_pairs[i]);
  }
  std::vector<JointState> joint_states;
  for (const BodyJoint& joint : impl_->joints) {
    if (joint.alive && in.ok()) joint_states.push_back(read(in, joint));
  }
  Impl::ContactState contact_state(*impl_);
  if (in.ok()) contact_state.read(in);
  if (!in.ok() || !in.at_end())
    return bad("restore: a value is out of range; the bytes are damaged");
  impl_->bodies.swap(bodies);
  for (std::size_t i = 0; i < articulations.size(); ++i) {
    Articulation& art = impl_->articulations[i];
    art.q = std::move(articulations[i].q);
    art.v = std::move(articulations[i].v);
    art.dofs = std::move(articulations[i].dofs);
    art.refresh();
    impl_->follow(art);
  }
  std::size_t next_joint = 0;
  for (BodyJoint& joint : impl_->joints) {
    if (joint.alive) adopt(joint, joint_states[next_joint++]);
  }
  contact_state.adopt();
  impl_->sub_step_before = sub_step_before;
  impl_->push_length = push_length;
  impl_->ready_for_queries = false;
  impl_->records.swap(records);
  impl_->destroyed_pairs.swap(destroyed_pairs);
  impl_->events.clear();
  impl_->counters = {};
  impl_->sub_steps_taken = 0;
  if (impl_->recorder) impl_->log({calls::Restore{{bytes.begin(), bytes.end()}}});
  return {};
}

}  // namespace vp
