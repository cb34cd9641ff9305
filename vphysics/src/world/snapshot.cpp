// The mutable state as bytes: a sequence of little-endian u64.
//
//   magic, format, topology hash; numbers of bodies, articulations, pair records, destroyed pairs;
//   sub-step lengths: of the impulses, of the bias velocity; 1 if the last step ended with a
//   position error, else 0; step length of the records and joints
//   bodies:          pose (12), w, v, prescribed twist (6), of a kinematic one also its last
//                    accelerations; of a link, nothing
//   articulations:   coordinates; for each velocity: itself, drive (5), impulses (5)
//   records:         key, a | b, count | number of the manifold and touching, rolling, 4 points
//   destroyed pairs: a (index, generation), b, sensor
//   joints:          rotations (2); of a gear its bodies' initial poses; for each axis its drive
//                    (5) and impulses (2)
//   contacts:        contact_state.h
//   loads, only if there are any: number of loaded bodies; for each its index, force, torque;
//                    number of loaded articulations; for each its index, the wrench on each link,
//                    the force of each degree of freedom
//   digest of all preceding u64
#include <algorithm>
#include <bit>

#include "world/contact_state.h"
#include "world/impl.h"

namespace vp {
namespace {

static_assert(std::endian::native == std::endian::little);

struct Digest {
  std::uint64_t digest = kSnapshotMagic;
  void u64(std::uint64_t w) { digest = mixed(digest, w); }
};

// The u64 are appended in blocks: growing the vector for each one would cost more than all the
// rest.
class ByteSink : public Digest {
 public:
  explicit ByteSink(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  void u64(std::uint64_t w) {
    Digest::u64(w);
    block_[used_++] = w;
    if (used_ == std::size(block_)) flush();
  }
  void flush() {
    const auto* first = reinterpret_cast<const std::byte*>(block_);
    bytes_.insert(bytes_.end(), first, first + used_ * sizeof(block_[0]));
    used_ = 0;
  }

 private:
  std::vector<std::byte>& bytes_;
  std::uint64_t block_[128];
  std::size_t used_ = 0;
};

using vp::put;

template <class Sink>
void put(Sink& sink, const PairRecord& r) {
  sink.u64(r.key);
  sink.u64((std::uint64_t{r.a} << 32) | r.b);
  sink.u64((std::uint64_t{r.count} << 32) | (std::uint64_t{r.part} << 1) | (r.touching ? 1u : 0u));
  put(sink, r.rolling);
  for (const PairPoint& p : r.points) {
    sink.u64(p.feature);
    put(sink, p.normal_impulse);
    put(sink, p.friction);
    put(sink, p.position);
  }
}

std::uint64_t id_bits(ColliderId id) {
  return (std::uint64_t{id.index} << 32) | id.generation;
}
template <class Sink>
void put(Sink& sink, const DestroyedPair& pair) {
  sink.u64(id_bits(pair.a));
  sink.u64(id_bits(pair.b));
  sink.u64(pair.sensor ? 1u : 0u);
}

template <class Sink>
void put(Sink& sink, const SE3& T) {
  const Mat3& R = T.rotation();
  for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &T.position()}) put(sink, *v);
}
template <class Sink>
void put(Sink& sink, const BodyJoint& joint) {
  put(sink, joint.rotated[0]);
  put(sink, joint.rotated[1]);
  if (joint.spec.form == JointSpec::Form::gear) {
    put(sink, joint.start[0]);
    put(sink, joint.start[1]);
  }
  double impulse[6] = {}, stop[6] = {};
  for (int i = 0; i < joint.count; ++i) {
    impulse[joint.rows[i].slot] = joint.impulse[i];
    stop[joint.rows[i].slot] = joint.stop[i];
  }
  for (int i = 0; i < 6; ++i) {
    if (joint.spec.form == JointSpec::Form::axes) {
      const JointDrive& d = joint.spec.axes[i].drive;
      for (const double x : {d.position, d.velocity, d.stiffness, d.damping, d.max_force})
        put(sink, x);
    }
    put(sink, impulse[i]);
    put(sink, stop[i]);
  }
}

}  // namespace

ContactData World::Impl::contact_data() {
  return {bodies, colliders, body_states, finder, contact_store, regions.state, lists};
}

template <class Sink>
void World::Impl::write(Sink& sink) {
  sink.u64(kSnapshotMagic);
  sink.u64(kSnapshotFormat);
  sink.u64(topology_hash);
  sink.u64(bodies.size());
  sink.u64(articulations.size());
  sink.u64(pair_contacts.records().size());
  sink.u64(events.destroyed.size());
  put(sink, sub_step_state.length);
  put(sink, sub_step_state.last_step_length);
  sink.u64(sub_step_state.position_error ? 1 : 0);
  put(sink, impacts.step_length());
  for (const Body& body : bodies) {
    if (body.is_link) continue;
    const Mat3& R = body.T.rotation();
    for (const Vec3* v : {&R.cx, &R.cy, &R.cz, &body.T.position(), &body.w, &body.v,
                          &body.prescribed.w, &body.prescribed.v}) {
      put(sink, *v);
    }
    if (body.motion != Motion::kinematic) continue;
    put(sink, body.last_acceleration.w);
    put(sink, body.last_acceleration.v);
  }
  for (const Articulation& art : articulations) {
    if (!art.alive) continue;
    for (const double x : art.q) put(sink, x);
    for (std::size_t i = 0; i < art.v.size(); ++i) {
      const JointDrive& d = art.dofs[i].drive;
      for (const double x :
           {art.v[i], d.position, d.velocity, d.stiffness, d.damping, d.max_force}) {
        put(sink, x);
      }
      for (const double x : art.dofs[i].impulses) put(sink, x);
    }
  }
  for (const PairRecord& record : pair_contacts.records()) put(sink, record);
  for (const DestroyedPair& pair : events.destroyed) put(sink, pair);
  for (const BodyJoint& joint : joints) {
    if (joint.alive) put(sink, joint);
  }
  write_contacts(sink, contact_data());
  const auto loaded = static_cast<std::uint64_t>(
      std::count_if(articulations.begin(), articulations.end(),
                    [](const Articulation& art) { return art.is_loaded(); }));
  if (loads.all().empty() && loaded == 0) return;
  sink.u64(loads.all().size());
  for (const Body& body : bodies) {
    const BodyLoad* load = loads.of(body);
    if (!load) continue;
    sink.u64(load->body);
    put(sink, load->force);
    put(sink, load->torque);
  }
  sink.u64(loaded);
  for (std::size_t a = 0; a < articulations.size(); ++a) {
    const Articulation& art = articulations[a];
    if (!art.is_loaded()) continue;
    sink.u64(a);
    for (std::size_t l = 0; l < art.bodies.size(); ++l) {
      const dse3 load = art.load(static_cast<int>(l));
      put(sink, load.m);
      put(sink, load.f);
    }
    for (std::size_t i = 0; i < art.v.size(); ++i) put(sink, art.joint_load(i));
  }
}

void World::snapshot(std::vector<std::byte>& bytes) const {
  ByteSink sink(bytes);
  impl_->write(sink);
  sink.u64(sink.digest);
  sink.flush();
}

std::uint64_t World::state_hash() const {
  Digest sink;
  impl_->write(sink);
  return sink.digest;
}

}  // namespace vp
