// Replays an untrusted recording. The first input byte says whether to repair the checksums, so
// that the fuzzer also reaches the code after them. A world from an accepted recording must step
// and restore its own snapshot.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "world/recording_io.h"

namespace {

constexpr std::size_t kU32Size = sizeof(std::uint32_t);

// A recording with each kind of call.
std::vector<std::byte> good_recording() {
  using namespace vp;
  const auto recorder = std::make_shared<Recorder>();
  World world;
  (void)world.record(recorder);
  BodyDesc desc;
  desc.motion = Motion::fixed;
  ColliderDesc collider;
  collider.shape = HalfSpace{};
  (void)world.add_collider(world.create_body(desc).value(), collider);
  desc.motion = Motion::dynamic;
  desc.inertia = solid_inertia(Sphere{0.1}, 1000.0);
  collider.shape = Sphere{0.1};
  BodyId bodies[3];
  for (int i = 0; i < 3; ++i) {
    desc.T_world_body = SE3(Vec3{0.25 * i, 0, 0.1});
    bodies[i] = world.create_body(desc).value();
    (void)world.add_collider(bodies[i], collider);
  }
  JointDesc joint;
  joint.kind = Hinge{};
  const JointId hinge = world.create_joint(bodies[0], bodies[1], joint).value();
  joint.kind = SixDof{};
  const JointId six = world.create_joint(bodies[1], bodies[2], joint).value();
  ModelBuilder builder;
  LinkSpec link;
  link.joint = CylindricalJoint{};
  link.inertia = Inertia(1.0, Vec3{1, 1, 1});
  link.parent = builder.add(link).value();
  (void)builder.add(link);
  const ArticulationId arm = world.create_articulation({builder.build().value()}).value();
  (void)world.step(0.01);
  const std::vector<double> q(4, 0.1), v(4, -0.1);
  (void)world.set_joint_states(arm, q, v);
  (void)world.set_joint_state(arm, 1, 0, 0.2, 0.1);
  (void)world.set_drive(arm, 0, 1, {0, 1, 0, 10, 5});
  (void)world.set_drive(hinge, {0.5, 0, 10, 1, 5});
  (void)world.set_drive(six, JointAxis::rotation_z, {0.5, 0, 10, 1, 5});
  (void)world.step(0.01);
  (void)world.apply_impulse(bodies[0], {1, 0, 0}, {0, 0, 0});
  (void)world.set_pose(bodies[1], SE3(Vec3{0, 1, 0.2}));
  (void)world.set_velocity(bodies[2], {{0, 1, 0}, {0, 0, 1}});
  (void)world.apply_force(bodies[0], {1, 0, 0}, {0, 0, 0});
  (void)world.apply_torque(bodies[1], {1, 0, 0});
  (void)world.apply_joint_force(arm, 1, 0, 0.5);
  (void)world.step(0.01);
  const ColliderId first{2, 1};
  (void)world.set_material(first, {0.1, 0.2, 0.3, 0.4});
  (void)world.set_filter(first, {3, 5});
  (void)world.set_surface_velocity(first, {1, 0, 0});
  (void)world.set_damping(bodies[1], 1.0, 2.0);
  (void)world.set_gravity_scale(bodies[1], 0.5);
  (void)world.set_allow_sleep(bodies[1], false);
  (void)world.set_inertia(bodies[1], Inertia(1.0, Vec3{1, 1, 1}));
  (void)world.set_motion(bodies[0], Motion::kinematic);
  (void)world.remove_collider(first);
  (void)world.destroy_joint(hinge);
  (void)world.destroy_body(bodies[0]);
  (void)world.step(0.02);
  (void)world.record(nullptr);
  return recorder->take();
}

std::uint32_t u32_at(const std::vector<std::byte>& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, &bytes[at], kU32Size);
  return word;
}

void repair_check(std::vector<std::byte>& bytes, std::size_t begin, std::size_t end) {
  const std::uint32_t check =
      vp::recording::check_of(std::span<const std::byte>(bytes).subspan(begin, end - begin));
  std::memcpy(&bytes[end], &check, kU32Size);
}

// header: the end of the valid recording's header.
void repair_checks(std::vector<std::byte>& bytes, std::size_t header) {
  if (bytes.size() < header + kU32Size) return;
  repair_check(bytes, 0, header);
  for (std::size_t at = header + kU32Size; at + 2 * kU32Size <= bytes.size();) {
    const std::size_t length = u32_at(bytes, at);
    if (length > bytes.size() - at - 2 * kU32Size) return;
    repair_check(bytes, at, at + kU32Size + length);
    at += 2 * kU32Size + length;
  }
}

std::size_t header_of(const std::vector<std::byte>& bytes) {
  const vp::RecordedParts none;
  vp::recording::Reader in(bytes, none);
  std::uint64_t words[3] = {};
  vp::WorldDesc desc;
  bool later = false;
  std::vector<std::byte> snapshot;
  in(words[0], words[1], desc, words[2], later, snapshot);
  return bytes.size() - in.left();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::byte> good = good_recording();
  static const std::size_t header = header_of(good);
  if (size < 3) return 0;
  // The input overwrites a valid recording from an offset that it contains.
  std::vector<std::byte> bytes;
  if (data[0] & 2) bytes = good;
  const std::size_t offset = std::min<std::size_t>(bytes.size(), data[1] + 256u * data[2]);
  if (bytes.size() < offset + size - 3) bytes.resize(offset + size - 3);
  if (size > 3) std::memcpy(bytes.data() + offset, data + 3, size - 3);
  if (data[0] & 1) repair_checks(bytes, header);
  auto replay = vp::Replay::open(bytes);
  if (!replay) return 0;
  for (int i = 0; i < 20; ++i) {
    const auto state = replay->step();
    if (!state || *state == vp::ReplayState::end || *state == vp::ReplayState::cut_short) break;
  }
  std::vector<std::byte> snapshot;
  replay->world().snapshot(snapshot);
  if (!replay->world().restore(snapshot)) std::abort();
  return 0;
}
