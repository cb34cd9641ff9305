// World::restore on untrusted bytes. The first input byte says whether to repair the checksum, so
// that the fuzzer also reaches the code after it. A restored world must step.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "world/impl.h"

namespace {

vp::World make_world() {
  using namespace vp;
  WorldDesc desc;
  desc.region_bodies = 1;
  World world(desc);
  BodyDesc fixed;
  fixed.motion = Motion::fixed;
  ColliderDesc collider;
  collider.shape = HalfSpace{};
  (void)world.add_collider(world.create_body(fixed).value(), collider);
  BodyDesc ball;
  ball.inertia = solid_inertia(Sphere{0.1}, 1000.0);
  ball.T_world_body = SE3(Vec3{0, 0, 0.1});
  ball.continuous = true;
  collider.shape = Sphere{0.1};
  (void)world.add_collider(world.create_body(ball).value(), collider);
  // A stool on a mesh. The ball touches both.
  const Vec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const TriangleMesh::Triangle triangles[] = {{0, 1, 2}, {0, 2, 3}};
  BodyDesc mesh = fixed;
  collider.shape = TriangleMesh::of(corners, triangles).value();
  (void)world.add_collider(world.create_body(mesh).value(), collider);
  const CompoundPart parts[] = {{Box{{0.2, 0.2, 0.02}}, SE3(Vec3{0, 0, 0.3})},
                                {Box{{0.02, 0.02, 0.15}}, SE3(Vec3{0.15, 0, 0.14})},
                                {Sphere{0.1}, SE3(Vec3{-0.1, 0, 0.1})}};
  BodyDesc stool;
  stool.T_world_body = SE3(Vec3{0.3, 0, -0.001});
  collider.shape = Compound::of(parts).value();
  stool.inertia = solid_inertia(collider.shape, 100.0);
  (void)world.add_collider(world.create_body(stool).value(), collider);
  // A floating link with a child link.
  ModelBuilder builder;
  LinkSpec link;
  link.joint = FreeJoint{};
  link.inertia = Inertia(1.0, Vec3{1, 1, 1});
  link.parent = builder.add(link).value();
  link.joint = CylindricalJoint{};
  (void)builder.add(link);
  (void)world.create_articulation({builder.build().value()});
  (void)world.step(0.001);
  return world;
}

void repair_checksum(std::vector<std::byte>& bytes) {
  std::uint64_t digest = 0x31534359'48505650u, word = 0;
  for (std::size_t i = 0; i + 16 <= bytes.size(); i += 8) {
    std::memcpy(&word, &bytes[i], 8);
    digest = vp::mixed(digest, word);
  }
  std::memcpy(&bytes[bytes.size() - 8], &digest, 8);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  vp::World world = make_world();
  // The input overwrites a valid snapshot, u64 by u64, from an offset that it contains.
  std::vector<std::byte> bytes;
  if (data[0] & 2) world.snapshot(bytes);
  const std::size_t offset = std::min<std::size_t>(bytes.size(), 8u * data[1]);
  if (bytes.size() < offset + size - 2) bytes.resize(offset + size - 2);
  if (size > 2) std::memcpy(bytes.data() + offset, data + 2, size - 2);
  if ((data[0] & 1) && bytes.size() >= 16) repair_checksum(bytes);
  const std::uint64_t before = world.state_hash();
  if (world.restore(bytes)) {
    for (int i = 0; i < 3; ++i) (void)world.step(0.001);
    std::vector<std::byte> again;
    world.snapshot(again);
    if (!world.restore(again)) std::abort();
  } else if (world.state_hash() != before) {
    std::abort();
  }
  return 0;
}
