// Replay of recorded calls. The bytes may be untrusted: each frame is read completely and checked
// before any of its calls is made. The calls go through the world's public functions, which reject
// invalid arguments.
#include <utility>

#include "vphysics/recording.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recording_io.h"
#include "world/recording_limits.h"
#include "world/validate.h"

namespace vp {
namespace {

tl::unexpected<Error> bad(std::string message) {
  return invalid(Errc::bad_data, std::move(message));
}

std::uint32_t u32_at(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

Expected<ArticulationDesc> articulation_of(const std::vector<LinkSpec>& links, bool links_collide) {
  ModelBuilder builder;
  for (const LinkSpec& link : links) {
    if (const auto added = builder.add(link); !added) return tl::make_unexpected(added.error());
  }
  auto model = builder.build();
  if (!model) return tl::make_unexpected(model.error());
  return ArticulationDesc{std::move(*model), links_collide};
}

// Makes a call and discards its result, except errors.
class CallPlayer {
 public:
  using Done = Expected<void>;
  explicit CallPlayer(World& world) : world_(world) {}
  Done operator()(const calls::CreateBody& c) { return only(world_.create_body(c.desc)); }
  Done operator()(const calls::DestroyBody& c) { return world_.destroy_body(c.body); }
  Done operator()(const calls::AddCollider& c) { return only(world_.add_collider(c.body, c.desc)); }
  Done operator()(const calls::CreateArticulation& c) { return create(c.links, false); }
  Done operator()(const calls::CreateArticulationWithOptions& c) {
    return create(c.links, c.links_collide);
  }
  Done operator()(const calls::CreateJoint& c) {
    return only(world_.create_joint(c.a, c.b, c.desc));
  }
  Done operator()(const calls::DestroyJoint& c) { return world_.destroy_joint(c.joint); }
  Done operator()(const calls::SetPose& c) { return world_.set_pose(c.body, c.T_world_body); }
  Done operator()(const calls::SetVelocity& c) { return world_.set_velocity(c.body, c.velocity); }
  Done operator()(const calls::ApplyImpulse& c) {
    return world_.apply_impulse(c.body, c.impulse, c.point);
  }
  Done operator()(const calls::SetJointStates& c) {
    return world_.set_joint_states(c.articulation, c.coordinates, c.velocities);
  }
  Done operator()(const calls::SetJointState& c) {
    return world_.set_joint_state(c.articulation, static_cast<int>(c.link), static_cast<int>(c.dof),
                                  c.position, c.velocity);
  }
  Done operator()(const calls::SetLinkDrive& c) {
    return world_.set_drive(c.articulation, static_cast<int>(c.link), static_cast<int>(c.dof),
                            c.drive);
  }
  Done operator()(const calls::SetJointDrive& c) { return world_.set_drive(c.joint, c.drive); }
  Done operator()(const calls::SetAxisDrive& c) {
    return world_.set_drive(c.joint, c.axis, c.drive);
  }
  Done operator()(const calls::Restore& c) { return world_.restore(c.snapshot); }
  Done operator()(const calls::Wake& c) { return world_.wake(c.body); }
  Done operator()(const calls::SetMassFromColliders& c) {
    return world_.set_mass_from_colliders(c.body);
  }
  Done operator()(const calls::ApplyForce& c) {
    return world_.apply_force(c.body, c.force, c.point);
  }
  Done operator()(const calls::ApplyTorque& c) { return world_.apply_torque(c.body, c.torque); }
  Done operator()(const calls::ApplyJointForce& c) {
    return world_.apply_joint_force(c.articulation, static_cast<int>(c.link),
                                    static_cast<int>(c.dof), c.force);
  }
  Done operator()(const calls::SetMotion& c) { return world_.set_motion(c.body, c.motion); }
  Done operator()(const calls::SetInertia& c) { return world_.set_inertia(c.body, c.inertia); }
  Done operator()(const calls::SetDamping& c) {
    return world_.set_damping(c.body, c.linear, c.angular);
  }
  Done operator()(const calls::SetGravityScale& c) {
    return world_.set_gravity_scale(c.body, c.scale);
  }
  Done operator()(const calls::SetAllowSleep& c) { return world_.set_allow_sleep(c.body, c.allow); }
  Done operator()(const calls::SetMaterial& c) {
    return world_.set_material(c.collider, c.material);
  }
  Done operator()(const calls::SetFilter& c) { return world_.set_filter(c.collider, c.filter); }
  Done operator()(const calls::SetSurfaceVelocity& c) {
    return world_.set_surface_velocity(c.collider, c.velocity);
  }
  Done operator()(const calls::RemoveCollider& c) { return world_.remove_collider(c.collider); }
  Done operator()(const calls::DestroyArticulation& c) {
    return world_.destroy_articulation(c.articulation);
  }

 private:
  Done create(const std::vector<LinkSpec>& links, bool links_collide) {
    const auto desc = articulation_of(links, links_collide);
    if (!desc) return tl::make_unexpected(desc.error());
    return only(world_.create_articulation(*desc));
  }
  template <class T>
  static Expected<void> only(const Expected<T>& result) {
    if (!result) return tl::make_unexpected(result.error());
    return {};
  }

  World& world_;
};

}  // namespace

// The items of a frame, before they are executed.
class Replay::Frame {
 public:
  struct Built {
    RecordedCall call;
    std::uint64_t topology_hash = 0;
  };
  std::vector<Built> calls;
  bool steps = false, hashed = false, ends = false;
  double dt = 0.0;
  std::uint64_t hash = 0, last_step = 0;

  // False: a recorder did not write this frame. A step or the end is the last item of a frame.
  bool read(std::span<const std::byte> bytes, const RecordedParts& parts, double last_dt) {
    recording::Reader in(bytes, parts);
    while (in.ok() && !in.at_end()) {
      if (steps || ends) return false;
      const auto code = std::to_integer<std::uint8_t>(bytes[bytes.size() - in.left()]);
      if (code < recording::kStep) {
        Built& item = calls.emplace_back();
        in(item.call.what);
        if (in.ok() && recording::builds(item.call)) in(item.topology_hash);
        continue;
      }
      in.byte();
      ends = code == recording::kEnd;
      steps = !ends;
      if (ends) in(last_step);
      if (ends) continue;
      in.check(code <= (recording::kStep | recording::kNewDt | recording::kHash));
      hashed = (code & recording::kHash) != 0;
      dt = last_dt;
      if ((code & recording::kNewDt) != 0) in(dt);
      if (hashed) in(hash);
    }
    return in.ok();
  }
};

Expected<Replay> Replay::open(std::vector<std::byte> bytes, RecordedParts parts) {
  return begin(std::move(bytes), std::move(parts), nullptr);
}
Expected<Replay> Replay::open(std::vector<std::byte> bytes, RecordedParts parts, World built) {
  return begin(std::move(bytes), std::move(parts), &built);
}

Expected<Replay> Replay::begin(std::vector<std::byte> bytes, RecordedParts parts, World* built) {
  recording::Reader in(bytes, parts);
  std::uint64_t magic = 0, format = 0, topology_hash = 0;
  WorldDesc desc;
  bool later = false;
  std::vector<std::byte> snapshot;
  in(magic, format);
  if (!in.ok() || magic != recording::kMagic) {
    return bad("replay: these bytes are no recording; give all bytes that a Recorder wrote");
  }
  if (format != recording::kFormat) {
    return bad("replay: a recording of another version; replay it with the engine that wrote it");
  }
  in(desc, topology_hash, later, snapshot);
  const std::size_t header = bytes.size() - in.left();
  if (!in.ok() || in.left() < sizeof(std::uint32_t) ||
      u32_at(std::span(bytes).subspan(header)) !=
          recording::check_of(std::span(bytes).first(header)) ||
      problem_with(desc)) {
    return bad("replay: the recording's beginning is damaged or cut short");
  }
  if (later && !built) {
    return invalid(
        "replay: the recording began with a world that had been built; give one made by the "
        "same calls");
  }
  if (!later && built) {
    return invalid("replay: the recording creates its world itself; give none");
  }
  if (later) {
    if (const auto restored = built->restore(snapshot); !restored) {
      return tl::make_unexpected(restored.error());
    }
  }
  Replay replay(std::move(bytes), std::move(parts), built ? std::move(*built) : World(desc));
  replay.at_ = header + sizeof(std::uint32_t);
  return replay;
}

Expected<ReplayState> Replay::step() {
  if (error_) return tl::make_unexpected(*error_);
  const std::uint64_t before = steps_;
  while (steps_ == before && !ended_) {
    constexpr std::size_t kU32Size = sizeof(std::uint32_t);
    const auto left = std::span<const std::byte>(bytes_).subspan(at_);
    if (left.size() < 2 * kU32Size) return ReplayState::cut_short;
    const std::uint32_t length = u32_at(left);
    if (length > left.size() - 2 * kU32Size) return ReplayState::cut_short;
    if (u32_at(left.subspan(kU32Size + length)) !=
        recording::check_of(left.first(kU32Size + length))) {
      return stop({Errc::bad_data, "the recording's bytes are damaged"});
    }
    at_ += 2 * kU32Size + length;
    if (const auto played = play(left.subspan(kU32Size, length)); !played) {
      return stop(played.error());
    }
  }
  if (ended_) return ReplayState::end;
  return first_difference_ ? ReplayState::differs : ReplayState::same;
}

tl::unexpected<Error> Replay::stop(const Error& error) {
  error_ =
      Error{Errc::bad_data, "replay, after step " + std::to_string(steps_) + ": " + error.message};
  return tl::make_unexpected(*error_);
}

Expected<void> Replay::play(std::span<const std::byte> bytes) {
  Frame frame;
  if (!frame.read(bytes, parts_, dt_)) {
    return bad("a value is out of range, or a part is missing; give the recorder's parts");
  }
  for (const Frame::Built& item : frame.calls) {
    if (const auto made = make(item.call, item.topology_hash); !made) return made;
  }
  if (frame.ends && frame.last_step != steps_) return bad("steps are missing from the recording");
  ended_ = frame.ends;
  return frame.steps ? make_step(frame.dt, frame.hashed ? &frame.hash : nullptr) : Expected<void>{};
}

Expected<void> Replay::make(const RecordedCall& call, std::uint64_t topology_hash) {
  if (const auto made = std::visit(CallPlayer(world_), call.what); !made) {
    return bad("a recorded call is refused: " + made.error().message);
  }
  if (recording::builds(call) && topology_hash != world_.impl_->topology_hash) {
    return bad("what is created is not what was recorded; give the same parts in the same order");
  }
  return {};
}

Expected<void> Replay::make_step(double dt, const std::uint64_t* hash) {
  if (const auto stepped = world_.step(dt); !stepped) {
    return bad("a recorded step is refused: " + stepped.error().message);
  }
  dt_ = dt;
  ++steps_;
  if (hash && *hash != world_.state_hash() && !first_difference_) first_difference_ = steps_;
  return {};
}

}  // namespace vp
