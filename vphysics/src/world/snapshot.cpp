// The mutable state as bytes: 8-byte little-endian words.
//
//   magic, format, structure digest, numbers of bodies, articulations, pair
//   records, destroyed pairs
//   bodies:         pose (12), w, v, prescribed twist (6); of a link, nothing
//   articulations:  coordinates; for each velocity: itself, drive (5), drive impulse
//   records:        key, a | b, count | touching, rolling, 4 points
//   destroyed pairs: a (index, generation), b, sensor
//   contacts:       contact_state.h
//   digest of all words before
#include <bit>
#include <cstring>

#include "world/contact_state.h"

namespace vp {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMagic = 0x31534359'48505650u;  // "PVPHYCS1"
constexpr std::uint64_t kFormat = 4;

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
  sink.word((std::uint64_t{r.count} << 32) | (r.touching ? 1u : 0u));
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
  in.check((flags & 0xfffffffeu) == 0 && r.count <= collide::kMaxPoints);
  const bool exist = r.a < colliders.size() && r.b < colliders.size() && r.a != r.b &&
                     colliders[r.a].alive && colliders[r.b].alive;
  in.check(exist && make_pair(colliders, r.a, r.b).key == r.key &&
           colliders[r.a].serial < colliders[r.b].serial);
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
  const std::uint64_t count = in.word(), destroyed_count = in.word();
  constexpr std::size_t kRecord = 38 * sizeof(std::uint64_t), kPair = 3 * sizeof(std::uint64_t);
  if (count > bytes.size() / kRecord || destroyed_count > bytes.size() / kPair)
    return bad("restore: more contacts announced than bytes follow");

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
    in.check(i == 0 || records[i - 1].key < records[i].key);
  }
  for (std::size_t i = 0; i < destroyed_pairs.size() && in.ok(); ++i) {
    read(in, impl_->colliders, destroyed_pairs[i]);
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
  contact_state.adopt();
  impl_->records.swap(records);
  impl_->destroyed_pairs.swap(destroyed_pairs);
  impl_->events.clear();
  impl_->counters = {};
  return {};
}

}  // namespace vp
