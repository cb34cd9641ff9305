// Creates articulations in a world, and reads and sets their state.
#include <algorithm>

#include "vphysics/assert.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/recorded_call.h"
#include "world/topology_hash.h"
#include "world/validate.h"

namespace vp {

const Articulation* World::Impl::find(ArticulationId id) const {
  if (id.index == 0 || id.index > articulations.size()) return nullptr;
  const Articulation& art = articulations[id.index - 1];
  return art.alive && id.generation == art.generation ? &art : nullptr;
}
Articulation* World::Impl::find(ArticulationId id) {
  return const_cast<Articulation*>(std::as_const(*this).find(id));
}

namespace {

bool rotates_about_a_point(const Joint& joint) {
  return std::holds_alternative<RevoluteJoint>(joint) ||
         std::holds_alternative<UniversalJoint>(joint) || std::holds_alternative<BallJoint>(joint);
}

// A parent comes before its children.
void find_neighbours(const Model& model, const Articulation& art, Bodies& bodies) {
  constexpr double kOnePoint = 1e-6;  // [m]: positions in files are rounded
  std::vector<SE3> T_leader_link;
  for (int l = 0; l < model.links(); ++l) {
    const LinkSpec& link = model.link(l);
    LinkNeighbours parent;
    SE3 T_leader_joint = link.T_parent_joint;
    if (link.parent != kWorld) {
      parent = bodies[art.body_of(link.parent)].neighbours;
      T_leader_joint = T_leader_link[static_cast<std::size_t>(link.parent)] * T_leader_joint;
    }
    LinkNeighbours& neighbours = bodies[art.body_of(l)].neighbours;
    if (velocities_of(link.joint) == 0) {
      neighbours = parent;
      T_leader_link.push_back(T_leader_joint);
      continue;
    }
    const bool continues_joint = parent.leader != kWorld && rotates_about_a_point(link.joint) &&
                                 rotates_about_a_point(model.link(parent.leader).joint) &&
                                 norm(T_leader_joint.position()) <= kOnePoint;
    neighbours = continues_joint ? LinkNeighbours{l, parent.head, parent.base}
                                 : LinkNeighbours{l, l, parent.leader};
    T_leader_link.emplace_back();
  }
}

}  // namespace

Expected<ArticulationId> World::create_articulation(const ArticulationDesc& desc) {
  if (auto problem = problem_with(desc)) return invalid("create_articulation: " + *problem);
  Articulation art(desc.model, impl_->desc.gravity);
  if (!art.is_regular()) {
    return invalid(Errc::singular,
                   "create_articulation: a joint moves no inertia; give its links an inertia about "
                   "its axis, or the joint an armature");
  }
  auto number = static_cast<std::uint32_t>(impl_->articulations.size());
  if (!impl_->free_articulations.empty()) {
    number = impl_->free_articulations.back();
    impl_->free_articulations.pop_back();
    art.generation = impl_->articulations[number].generation + 1;
  }
  const ArticulationId id{number + 1, art.generation};
  for (int link = 0; link < desc.model.links(); ++link) {
    const std::uint32_t index = impl_->bodies.take();
    Body& body = impl_->bodies[index];
    body.motion = art.is_fixed(link) ? Motion::fixed : Motion::dynamic;
    body.is_link = true;
    body.articulation = number;
    body.link = link;
    art.bodies.push_back(index);
  }
  if (desc.links_collide) find_neighbours(desc.model, art, impl_->bodies);
  TopologyHash topology_hash(impl_->topology_hash);
  topology_hash.add(0x400u + art.bodies.front());
  topology_hash.add(desc);
  impl_->follow(art);
  if (number < impl_->articulations.size()) {
    impl_->articulations[number] = std::move(art);
  } else {
    impl_->articulations.push_back(std::move(art));
  }
  impl_->lists.invalidate();
  if (impl_->recorder) {
    std::vector<LinkSpec> links;
    links.reserve(static_cast<std::size_t>(desc.model.links()));
    for (int l = 0; l < desc.model.links(); ++l) links.push_back(desc.model.link(l));
    if (desc.links_collide) {
      impl_->log({calls::CreateArticulationWithOptions{std::move(links), true}});
    } else {
      impl_->log({calls::CreateArticulation{std::move(links)}});
    }
  }
  return id;
}

BodyId World::link_body(ArticulationId id, int link) const {
  const Articulation* art = impl_->find(id);
  if (!art || link < 0 || link >= art->model().links()) return {};
  return impl_->bodies.id(art->bodies[static_cast<std::size_t>(link)]);
}

const Model* World::model(ArticulationId id) const {
  const Articulation* art = impl_->find(id);
  return art ? &art->model() : nullptr;
}

std::span<const double> World::coordinates(ArticulationId id) const {
  const Articulation* art = impl_->find(id);
  VP_ASSERT(art && "coordinates: no such articulation");
  return art ? std::span<const double>(art->q) : std::span<const double>{};
}
std::span<const double> World::velocities(ArticulationId id) const {
  const Articulation* art = impl_->find(id);
  VP_ASSERT(art && "velocities: no such articulation");
  return art ? std::span<const double>(art->v) : std::span<const double>{};
}

Expected<void> World::set_joint_states(ArticulationId id, std::span<const double> q,
                                       std::span<const double> v) {
  Articulation* art = impl_->find(id);
  if (!art) return invalid("set_joint_states: no such articulation");
  if (auto problem = problem_with(*art, q, v)) return invalid("set_joint_states: " + *problem);
  art->keep_end_of_step();
  std::copy(q.begin(), q.end(), art->q.begin());
  std::copy(v.begin(), v.end(), art->v.begin());
  art->refresh();
  impl_->follow(*art);
  if (impl_->recorder) {
    impl_->log({calls::SetJointStates{id, {q.begin(), q.end()}, {v.begin(), v.end()}}});
  }
  return {};
}

namespace {

// The index of a degree of freedom that has a coordinate, or -1.
int coordinate_dof(const Articulation* art, int link, int dof) {
  const int i = art ? art->dof_index(link, dof) : -1;
  return i >= 0 && art->dofs[static_cast<std::size_t>(i)].coordinate >= 0 ? i : -1;
}

}  // namespace

double World::joint_position(ArticulationId id, int link, int dof) const {
  const Articulation* art = impl_->find(id);
  const int i = coordinate_dof(art, link, dof);
  VP_ASSERT(i >= 0 && "joint_position: no such joint coordinate");
  if (i < 0) return 0.0;
  return art->q[static_cast<std::size_t>(art->dofs[static_cast<std::size_t>(i)].coordinate)];
}

double World::joint_velocity(ArticulationId id, int link, int dof) const {
  const Articulation* art = impl_->find(id);
  const int i = coordinate_dof(art, link, dof);
  VP_ASSERT(i >= 0 && "joint_velocity: no such joint coordinate");
  return i >= 0 ? art->v[static_cast<std::size_t>(i)] : 0.0;
}

Expected<void> World::set_joint_state(ArticulationId id, int link, int dof, double position,
                                      double velocity) {
  Articulation* art = impl_->find(id);
  const int i = coordinate_dof(art, link, dof);
  if (i < 0) {
    return invalid(
        "set_joint_state: no such joint coordinate; check articulation, link and dof, and set ball "
        "and free joints by set_joint_states");
  }
  if (!in_range(position) || !in_range(velocity)) {
    return invalid("set_joint_state: position and velocity must be finite and at most 1e9");
  }
  const JointDof& joint = art->dofs[static_cast<std::size_t>(i)];
  if (position < joint.lower || position > joint.upper) {
    return invalid("set_joint_state: the position must lie between the joint's stops");
  }
  art->keep_end_of_step();
  art->q[static_cast<std::size_t>(joint.coordinate)] = position;
  art->v[static_cast<std::size_t>(i)] = velocity;
  art->refresh();
  impl_->follow(*art);
  if (impl_->recorder) {
    impl_->log({calls::SetJointState{id, static_cast<std::uint32_t>(link),
                                     static_cast<std::uint32_t>(dof), position, velocity}});
  }
  return {};
}

namespace {

bool can_drive(const JointDof& joint, const JointDrive& drive) {
  return is_drive(drive) && (joint.coordinate >= 0 || drive.stiffness == 0.0);
}

}  // namespace

// Called at every step for many joints: error texts are built out of line, because inline they cost
// registers.
Expected<void> World::set_drive(ArticulationId id, int link, int dof, const JointDrive& drive) {
  Articulation* art = impl_->find(id);
  const int i = art ? art->dof_index(link, dof) : -1;
  JointDof* joint = i >= 0 ? &art->dofs[static_cast<std::size_t>(i)] : nullptr;
  if (!joint || !can_drive(*joint, drive)) {
    return invalid("set_drive: " + why_no_drive(joint != nullptr, drive));
  }
  joint->drive = drive;
  art->drives_changed();
  if (impl_->recorder) impl_->log_drive(id, link, dof, drive);
  return {};
}

Expected<void> World::set_drives(ArticulationId id, std::span<const JointDrive> drives) {
  Articulation* art = impl_->find(id);
  if (!art || drives.size() != art->dofs.size()) {
    return invalid("set_drives: give each degree of freedom of an articulation a drive");
  }
  bool changed = false;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (art->dofs[i].drive == drives[i]) continue;  // accepted before
    if (!can_drive(art->dofs[i], drives[i]))
      return invalid("set_drives: " + why_no_drive(true, drives[i]));
    changed = true;
  }
  if (changed) {
    for (std::size_t i = 0; i < drives.size(); ++i) art->dofs[i].drive = drives[i];
    art->drives_changed();
  }
  if (!impl_->recorder) return {};
  for (int link = 0, i = 0; link < art->model().links(); ++link) {
    for (int dof = 0; art->dof_index(link, dof) >= 0; ++dof, ++i) {
      impl_->log_drive(id, link, dof, drives[static_cast<std::size_t>(i)]);
    }
  }
  return {};
}

void World::Impl::log_drive(ArticulationId id, int link, int dof, const JointDrive& drive) {
  log({calls::SetLinkDrive{id, static_cast<std::uint32_t>(link), static_cast<std::uint32_t>(dof),
                           drive}});
}

}  // namespace vp
