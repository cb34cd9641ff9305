// The format of a recording. Each type is described once, for writing and reading:
// Fields<Io>::of(io, x) passes each field of x to io.
//
//   header    magic, format (8 bytes each), settings of the world, topology hash, whether a
//             snapshot follows, its length and bytes; check
//   frames    length (4), items, check (4)
//   item      code (1), fields. A call; calls that build are followed by the topology hash (8).
//             Or a step: dt if it differs from the last step's, hash of the state if it was taken.
//             Or the end.
//
// Numbers are little-endian: a double has 8 bytes, an id or a count is a varint, an enum one byte.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "vphysics/recording.h"
#include "world/recorded_call.h"

namespace vp::recording {

inline constexpr std::uint64_t kMagic = 0x4443455259485056u;  // "VPHYRECD"
inline constexpr std::uint64_t kFormat = 3;
// Codes of items that are not calls.
inline constexpr std::uint8_t kStep = 0x80, kNewDt = 1, kHash = 2, kEnd = 0xff;

std::uint32_t check_of(std::span<const std::byte> bytes);

template <class Io, class T>
using Field = std::conditional_t<Io::kReads, T&, const T&>;

// Number of shape kinds that a recording contains. It refers to the others as parts, by index.
inline constexpr std::size_t kCarriedShapes = 6;

template <class E>
constexpr E last_of();
template <>
constexpr Motion last_of() {
  return Motion::dynamic;
}
template <>
constexpr AxisMotion last_of() {
  return AxisMotion::locked;
}
template <>
constexpr JointAxis last_of() {
  return JointAxis::rotation_z;
}

template <class T>
concept Plain = std::same_as<T, double> || std::same_as<T, std::uint64_t>;

class Writer {
 public:
  static constexpr bool kReads = false;
  Writer(std::vector<std::byte>& out, RecordedParts& parts) : out_(out), parts_(parts) {}

  template <class... T>
  void operator()(const T&... x) {
    (one(x), ...);
  }
  void byte(std::uint8_t x) { out_.push_back(std::byte{x}); }
  void count(std::uint64_t x) {
    for (; x >= 0x80; x >>= 7) byte(static_cast<std::uint8_t>(x | 0x80));
    byte(static_cast<std::uint8_t>(x));
  }
  void append(const void* data, std::size_t size) {
    const std::size_t n = out_.size();
    out_.resize(n + size);
    if (size > 0) std::memcpy(out_.data() + n, data, size);
  }

 private:
  template <class T>
  void one(const T& x);
  template <class T>
  void part(std::vector<T>& parts, const T& x) {
    count(parts.size());
    parts.push_back(x);
  }
  template <Plain T>
  void one(const T& x) {
    append(&x, sizeof x);
  }
  void one(const bool& x) { byte(x ? 1 : 0); }
  void one(const std::uint32_t& x) { count(x); }
  template <class E>
  requires std::is_enum_v<E>
  void one(const E& x) { byte(static_cast<std::uint8_t>(x)); }
  template <class Tag>
  void one(const Id<Tag>& id) {
    count(id.index);
    count(id.generation);
  }
  void one(const std::vector<std::byte>& bytes) {
    count(bytes.size());
    append(bytes.data(), bytes.size());
  }
  template <class T>
  void one(const std::vector<T>& list) {
    count(list.size());
    for (const T& x : list) one(x);
  }
  template <class... K>
  void one(const std::variant<K...>& x) {
    byte(static_cast<std::uint8_t>(x.index()));
    std::visit([this](const auto& kind) { this->one(kind); }, x);
  }
  void one(const Shape& shape);
  void one(const std::shared_ptr<const UserJoint>& joint) { part(parts_.joints, joint); }
  void one(const UserConstraint& user) { part(parts_.constraints, user.constraint); }

  std::vector<std::byte>& out_;
  RecordedParts& parts_;
};

// Fails permanently if the bytes end or a value is out of range.
class Reader {
 public:
  static constexpr bool kReads = true;
  Reader(std::span<const std::byte> bytes, const RecordedParts& parts)
      : bytes_(bytes), parts_(parts) {}

  template <class... T>
  void operator()(T&... x) {
    (one(x), ...);
  }
  std::uint8_t byte() {
    return bytes_.empty() ? failed() : std::to_integer<std::uint8_t>(next(1)[0]);
  }
  std::uint64_t count() {
    std::uint64_t x = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t b = byte();
      x |= std::uint64_t{b & 0x7fu} << shift;
      if (b < 0x80) return x;
    }
    return failed();
  }
  // Number of the items that follow. Each has at least one byte.
  std::size_t items() {
    const std::uint64_t n = count();
    if (n > bytes_.size()) return failed();
    return static_cast<std::size_t>(n);
  }
  void check(bool condition) { ok_ = ok_ && condition; }
  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }

 private:
  template <class T>
  void one(T& x);
  std::uint8_t failed() {
    ok_ = false;
    bytes_ = {};
    return 0;
  }
  std::span<const std::byte> next(std::size_t n) {
    const auto first = bytes_.first(n);
    bytes_ = bytes_.subspan(n);
    return first;
  }
  template <class T>
  void part(const std::vector<T>& parts, T& x) {
    const std::uint64_t i = count();
    check(i < parts.size());
    if (ok_) x = parts[static_cast<std::size_t>(i)];
  }
  template <Plain T>
  void one(T& x) {
    if (bytes_.size() < sizeof x) {
      failed();
    } else {
      std::memcpy(&x, next(sizeof x).data(), sizeof x);
    }
  }
  void one(bool& x) {
    const std::uint8_t b = byte();
    check(b <= 1);
    x = b == 1;
  }
  void one(std::uint32_t& x) {
    const std::uint64_t n = count();
    check(n <= std::numeric_limits<std::uint32_t>::max());
    x = static_cast<std::uint32_t>(n);
  }
  template <class E>
  requires std::is_enum_v<E>
  void one(E& x) {
    const std::uint8_t b = byte();
    check(b <= static_cast<std::uint8_t>(last_of<E>()));
    x = static_cast<E>(ok_ ? b : 0);
  }
  template <class Tag>
  void one(Id<Tag>& id) {
    one(id.index);
    one(id.generation);
  }
  void one(std::vector<std::byte>& bytes) {
    const auto all = next(items());
    bytes.assign(all.begin(), all.end());
  }
  template <class T>
  void one(std::vector<T>& list) {
    list.clear();
    // Memory grows with the bytes present, not with the announced count.
    for (std::size_t n = items(); n > 0 && ok_; --n) one(list.emplace_back());
  }
  template <class... K>
  void one(std::variant<K...>& x) {
    const std::uint8_t kind = byte();
    check(kind < sizeof...(K));
    if (!ok_) return;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (void)((I == kind && (one(x.template emplace<I>()), true)) || ...);
    }
    (std::index_sequence_for<K...>());
  }
  void one(Shape& shape);
  void one(std::shared_ptr<const UserJoint>& joint) { part(parts_.joints, joint); }
  void one(UserConstraint& user) { part(parts_.constraints, user.constraint); }

  std::span<const std::byte> bytes_;
  const RecordedParts& parts_;
  bool ok_ = true;
};

template <class Io>
struct Fields {
  // --- values

  static void of(Io& io, Field<Io, Vec3> a) { io(a.x, a.y, a.z); }
  static void of(Io& io, Field<Io, se3> V) { io(V.w, V.v); }
  static void of(Io& io, Field<Io, SE3> T) {
    Mat3 R = T.rotation();
    Vec3 p = T.position();
    io(R.cx, R.cy, R.cz, p);
    if constexpr (Io::kReads) T = SE3(R, p);
  }
  static void of(Io& io, Field<Io, Inertia> J) {
    double mass = J.mass();
    Vec3 h = J.first_moment();
    Sym3 I = J.rotational();
    io(mass, h, I.xx, I.yy, I.zz, I.xy, I.yz, I.zx);
    if constexpr (Io::kReads) J = Inertia(mass, h, I);
  }

  // --- descriptions

  static void of(Io& io, Field<Io, WorldDesc> d) {
    auto iterations = static_cast<std::uint32_t>(d.velocity_iterations);
    auto sub_steps = static_cast<std::uint32_t>(d.sub_steps);
    auto impacts = static_cast<std::uint32_t>(d.max_impacts_per_step);
    auto region_bodies = static_cast<std::uint32_t>(d.region_bodies);
    io(d.gravity, d.restitution_threshold, d.contact_slop, iterations, sub_steps, impacts,
       d.sleep_after, d.sleep_speed, region_bodies, d.length_unit);
    if constexpr (Io::kReads) {
      d.velocity_iterations = static_cast<int>(iterations);
      d.sub_steps = static_cast<int>(sub_steps);
      d.max_impacts_per_step = static_cast<int>(impacts);
      d.region_bodies = static_cast<int>(region_bodies);
    }
  }
  static void of(Io& io, Field<Io, BodyDesc> d) {
    io(d.motion, d.T_world_body, d.velocity, d.inertia, d.linear_damping, d.angular_damping);
    // Later fields are behind flags, so that bodies without them are written as before.
    constexpr std::uint8_t kContinuous = 1, kScaled = 2, kSleepless = 4;
    if constexpr (Io::kReads) {
      const std::uint8_t flags = io.byte();
      io.check(flags <= (kContinuous | kScaled | kSleepless));
      d.continuous = (flags & kContinuous) != 0;
      d.allow_sleep = (flags & kSleepless) == 0;
      d.gravity_scale = 1.0;
      if ((flags & kScaled) != 0) io(d.gravity_scale);
    } else {
      const bool scaled = d.gravity_scale != 1.0;
      io.byte(static_cast<std::uint8_t>((d.continuous ? kContinuous : 0) | (scaled ? kScaled : 0) |
                                        (d.allow_sleep ? 0 : kSleepless)));
      if (scaled) io(d.gravity_scale);
    }
    io(d.user_data);
  }
  static void of(Io& io, Field<Io, Sphere> s) { io(s.radius); }
  static void of(Io& io, Field<Io, Box> s) { io(s.half_extents); }
  static void of(Io& io, Field<Io, Capsule> s) { io(s.radius, s.half_length); }
  static void of(Io&, Field<Io, HalfSpace>) {}
  static void of(Io& io, Field<Io, Cylinder> s) { io(s.radius, s.half_length); }
  static void of(Io& io, Field<Io, Cone> s) { io(s.radius, s.half_height); }
  static void of(Io& io, Field<Io, Material> m) {
    io(m.friction, m.restitution, m.rolling_friction, m.spinning_friction);
  }
  static void of(Io& io, Field<Io, ColliderDesc> d) {
    io(d.shape, d.T_body_shape, d.material, d.filter.category, d.filter.mask, d.sensor, d.user_data,
       d.surface_velocity, d.density);
  }
  static void of(Io& io, Field<Io, JointDrive> d) {
    io(d.position, d.velocity, d.stiffness, d.damping, d.max_force);
  }

  // Joints of articulations.
  static void of(Io&, Field<Io, FixedJoint>) {}
  static void of(Io& io, Field<Io, RevoluteJoint> j) { io(j.axis); }
  static void of(Io& io, Field<Io, PrismaticJoint> j) { io(j.axis); }
  static void of(Io& io, Field<Io, HelicalJoint> j) { io(j.axis, j.pitch); }
  static void of(Io& io, Field<Io, CylindricalJoint> j) { io(j.axis); }
  static void of(Io& io, Field<Io, UniversalJoint> j) { io(j.first, j.second); }
  static void of(Io&, Field<Io, PlanarJoint>) {}
  static void of(Io&, Field<Io, BallJoint>) {}
  static void of(Io&, Field<Io, FreeJoint>) {}
  static void of(Io& io, Field<Io, JointForces> f) {
    io(f.lower, f.upper, f.limit_stiffness, f.limit_damping, f.stiffness, f.rest, f.friction,
       f.motor_limit);
  }
  // Names belong to the user, not to the world.
  static void of(Io& io, Field<Io, LinkSpec> link) {
    // The top bit, which no parent's index uses: the inertia is taken as stated.
    auto behind = static_cast<std::uint32_t>(link.parent + 1) |
                  static_cast<std::uint32_t>(link.inertia_as_stated) << 31;
    io(behind, link.joint, link.T_parent_joint, link.inertia, link.armature, link.damping,
       link.forces);
    if constexpr (Io::kReads) {
      link.parent = static_cast<int>(behind & 0x7fffffffu) - 1;
      link.inertia_as_stated = behind >> 31 != 0;
    }
  }

  // Joints between bodies.
  static void of(Io&, Field<Io, BallSocket>) {}
  static void of(Io& io, Field<Io, Hinge> j) { io(j.lower, j.upper, j.drive); }
  static void of(Io& io, Field<Io, Slider> j) { io(j.lower, j.upper, j.drive); }
  static void of(Io&, Field<Io, Weld>) {}
  static void of(Io& io, Field<Io, Distance> j) { io(j.min, j.max); }
  static void of(Io& io, Field<Io, Spring> j) { io(j.length, j.stiffness, j.damping); }
  static void of(Io& io, Field<Io, ConeTwist> j) {
    io(j.swing_x, j.swing_y, j.lower, j.upper, j.drive);
  }
  static void of(Io& io, Field<Io, AxisDesc> a) { io(a.motion, a.lower, a.upper, a.drive); }
  static void of(Io& io, Field<Io, SixDof> j) {
    for (auto& axis : j.axes) io(axis);
  }
  static void of(Io& io, Field<Io, Gear> j) { io(j.ratio, j.slides_a, j.slides_b); }
  static void of(Io& io, Field<Io, JointDesc> d) {
    io(d.kind, d.T_a_joint, d.T_b_joint, d.collide, d.frequency, d.damping_ratio);
  }

  // --- calls

  static void of(Io& io, Field<Io, calls::CreateBody> c) { io(c.desc); }
  static void of(Io& io, Field<Io, calls::DestroyBody> c) { io(c.body); }
  static void of(Io& io, Field<Io, calls::AddCollider> c) { io(c.body, c.desc); }
  static void of(Io& io, Field<Io, calls::CreateArticulation> c) { io(c.links); }
  static void of(Io& io, Field<Io, calls::CreateJoint> c) { io(c.a, c.b, c.desc); }
  static void of(Io& io, Field<Io, calls::DestroyJoint> c) { io(c.joint); }
  static void of(Io& io, Field<Io, calls::SetPose> c) { io(c.body, c.T_world_body); }
  static void of(Io& io, Field<Io, calls::SetVelocity> c) { io(c.body, c.velocity); }
  static void of(Io& io, Field<Io, calls::ApplyImpulse> c) { io(c.body, c.impulse, c.point); }
  static void of(Io& io, Field<Io, calls::SetJointStates> c) {
    io(c.articulation, c.coordinates, c.velocities);
  }
  static void of(Io& io, Field<Io, calls::SetJointState> c) {
    io(c.articulation, c.link, c.dof, c.position, c.velocity);
  }
  static void of(Io& io, Field<Io, calls::SetLinkDrive> c) {
    io(c.articulation, c.link, c.dof, c.drive);
  }
  static void of(Io& io, Field<Io, calls::SetJointDrive> c) { io(c.joint, c.drive); }
  static void of(Io& io, Field<Io, calls::SetAxisDrive> c) { io(c.joint, c.axis, c.drive); }
  static void of(Io& io, Field<Io, calls::Restore> c) { io(c.snapshot); }
  static void of(Io& io, Field<Io, calls::Wake> c) { io(c.body); }
  static void of(Io& io, Field<Io, calls::SetMassFromColliders> c) { io(c.body); }
  static void of(Io& io, Field<Io, calls::ApplyForce> c) { io(c.body, c.force, c.point); }
  static void of(Io& io, Field<Io, calls::ApplyTorque> c) { io(c.body, c.torque); }
  static void of(Io& io, Field<Io, calls::ApplyJointForce> c) {
    io(c.articulation, c.link, c.dof, c.force);
  }
  static void of(Io& io, Field<Io, calls::SetMotion> c) { io(c.body, c.motion); }
  static void of(Io& io, Field<Io, calls::SetInertia> c) { io(c.body, c.inertia); }
  static void of(Io& io, Field<Io, calls::SetDamping> c) { io(c.body, c.linear, c.angular); }
  static void of(Io& io, Field<Io, calls::SetGravityScale> c) { io(c.body, c.scale); }
  static void of(Io& io, Field<Io, calls::SetAllowSleep> c) { io(c.body, c.allow); }
  static void of(Io& io, Field<Io, calls::SetMaterial> c) { io(c.collider, c.material); }
  static void of(Io& io, Field<Io, calls::SetFilter> c) {
    io(c.collider, c.filter.category, c.filter.mask);
  }
  static void of(Io& io, Field<Io, calls::SetSurfaceVelocity> c) { io(c.collider, c.velocity); }
  static void of(Io& io, Field<Io, calls::RemoveCollider> c) { io(c.collider); }
  static void of(Io& io, Field<Io, calls::DestroyArticulation> c) { io(c.articulation); }
  static void of(Io& io, Field<Io, calls::CreateArticulationWithOptions> c) {
    io(c.links, c.links_collide);
  }
};

template <class T>
void Writer::one(const T& x) {
  Fields<Writer>::of(*this, x);
}
template <class T>
void Reader::one(T& x) {
  Fields<Reader>::of(*this, x);
}

inline void Writer::one(const Shape& shape) {
  byte(static_cast<std::uint8_t>(shape.index()));
  if (shape.index() >= kCarriedShapes) return part(parts_.shapes, shape);
  std::visit(
      [this]<class S>(const S& s) {
        if constexpr (requires { Fields<Writer>::of(*this, s); }) Fields<Writer>::of(*this, s);
      },
      shape);
}
inline void Reader::one(Shape& shape) {
  const std::uint8_t kind = byte();
  check(kind < std::variant_size_v<Shape>);
  if (!ok_) return;
  if (kind >= kCarriedShapes) {
    part(parts_.shapes, shape);
    return check(shape.index() == kind);
  }
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (void)((I == kind && (Fields<Reader>::of(*this, shape.template emplace<I>()), true)) || ...);
  }
  (std::make_index_sequence<kCarriedShapes>());
}

}  // namespace vp::recording
