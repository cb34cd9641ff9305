#include "multibody/impulse_factor.h"

#include <algorithm>

#include "multibody/factor_passes.h"
#include "multibody/instruction_set.h"
#include "multibody/work.h"

namespace vp::detail {
namespace {

using vphysics_factor::kInertia;
using vphysics_factor::Passes;

const Passes& best_passes() {
  switch (instruction_set_for(Arithmetic::reproducible)) {
#ifdef VP_INSTRUCTION_SETS
    case InstructionSet::avx512_same_bits:
      return vphysics_factor::kAvx512;
    case InstructionSet::avx2_same_bits:
      return vphysics_factor::kAvx2;
#endif
    default:
      return vphysics_factor::kBaseline;
  }
}
const Passes& passes() {
  static const Passes& best = best_passes();
  return best;
}

}  // namespace

ImpulseFactor::ImpulseFactor(const Model& model) {
  const Tree<double>& tree = model.tree();
  const auto n = static_cast<std::size_t>(model.velocities());
  columns_.resize(n);
  next_.resize(n, kEnd);
  depth_.resize(n);
  a_.resize(n);
  A_.resize(n);
  r_.resize(n);
  J_ = AlignedArray<double>(vphysics_factor::kArticulated * tree.nodes.size());
  constexpr std::size_t kGroup = kSlots<double>;
  const std::size_t numbers = kInertia * kGroup * tree.one.groups.size();
  bodies_ = AlignedArray<double>(numbers);
  inertias_ = AlignedArray<double>(numbers);
  for (const auto& node : tree.nodes) {
    const auto slot = static_cast<std::size_t>(node.body_slot());
    const std::size_t at = slot / kGroup * kGroup * kInertia + slot % kGroup;
    inertia_at_.push_back(static_cast<std::uint32_t>(at));
    const Fields<double, double> body(bodies_.data() + at);
    body.set(0, node.J.mass());
    body.set(1, node.J.first_moment());
    body.set(4, node.J.rotational());
    body_dof_.push_back(static_cast<std::uint32_t>(node.v));
    const bool root = node.parent == kWorld;
    std::uint32_t next =
        root ? kEnd
             : static_cast<std::uint32_t>(tree.nodes[static_cast<std::size_t>(node.parent)].v);
    parent_dof_.push_back(next);
    // Within a node, the last degree of freedom is nearest to the root.
    for (int k = node.dofs; k-- > 0;) {
      const auto dof = static_cast<std::uint32_t>(node.v + k);
      next_[dof] = next;
      depth_[dof] = next == kEnd ? 1 : depth_[next] + 1;
      deepest_ = std::max(deepest_, depth_[dof]);
      next = dof;
      tip_to_base_order_.push_back(dof);
    }
  }
  std::reverse(tip_to_base_order_.begin(), tip_to_base_order_.end());
  joint_rows_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    joint_rows_[i].begin = static_cast<std::uint32_t>(cached_.size());
    cached_.resize(cached_.size() + depth_[i]);
  }
  for (const auto& frame : tree.frames) {
    if (frame.node == kWorld) {
      links_.push_back({kEnd, 0, {}});
    } else {
      const auto dof =
          static_cast<std::uint32_t>(tree.nodes[static_cast<std::size_t>(frame.node)].v);
      links_.push_back({dof, depth_[dof], {}});
    }
  }
}

void ImpulseFactor::find_inertias(const Model& model, const Data& data) {
  passes().inertias(&model.tree(), &data.work(), bodies_.data(), inertias_.data());
}

bool ImpulseFactor::factor(const Model& model, const Data& data, double damping_time,
                           bool inertias_are_found, std::span<const double> gains) {
  if (!inertias_are_found) find_inertias(model, data);
  const Tree<double>& tree = model.tree();
  const Work<double>& work = data.work();
  for (CachedRow& cached : joint_rows_) cached.valid = false;
  const bool fine =
      passes().factor(&tree, &work, damping_time, gains.empty() ? nullptr : gains.data(),
                      inertias_.data(), columns_.data(), J_.data());
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const int node = tree.frames[l].node;
    if (node != kWorld) links_[l].origin = origin_of(work, node);
  }
  return fine;
}

void ImpulseFactor::row(std::uint32_t dof, dse3 r, double* y) const {
  for (std::uint32_t d = dof; d != kEnd; d = next_[d], ++y) {
    const Column& c = columns_[d];
    *y = c.s * r;
    r = r - *y * c.G;
  }
}

void ImpulseFactor::force_row(int link, const Vec3& point, const Vec3& direction, double* y) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  row(path.first, {cross(point - path.origin, direction), direction}, y);
}
void ImpulseFactor::moment_row(int link, const Vec3& direction, double* y) const {
  row(links_[static_cast<std::size_t>(link)].first, {direction, {}}, y);
}
void ImpulseFactor::force_rows(int link, const Vec3& point, const Vec3 (&directions)[3],
                               double* y) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  const Vec3 arm = point - path.origin;
  const auto force = [&](const Vec3& d) { return dse3{cross(arm, d), d}; };
  const dse3 wrenches[] = {force(directions[0]), force(directions[1]), force(directions[2])};
  passes().rows(columns_.data(), next_.data(), path.first, wrenches, path.depth, y);
}
void ImpulseFactor::moment_rows(int link, const Vec3 (&directions)[3], double* y) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  const dse3 wrenches[] = {{directions[0], {}}, {directions[1], {}}, {directions[2], {}}};
  passes().rows(columns_.data(), next_.data(), path.first, wrenches, path.depth, y);
}
ImpulseFactor::JointRow ImpulseFactor::joint_row(std::uint32_t dof) {
  CachedRow& cached = joint_rows_[dof];
  double* const y = cached_.data() + cached.begin;
  if (!cached.valid) {
    const Column& c = columns_[dof];
    y[0] = c.g;
    row(next_[dof], -c.g * c.G, y + 1);
    cached.response = 0.0;
    for (std::uint32_t k = 0; k < depth_[dof]; ++k) cached.response += y[k] * y[k];
    cached.valid = true;
  }
  return {y, cached.response};
}

void ImpulseFactor::to_velocities(std::span<double> x) {
  for (std::size_t i = tip_to_base_order_.size(); i-- > 0;) {
    const std::uint32_t d = tip_to_base_order_[i], next = next_[d];
    const Column& c = columns_[d];
    const se3 a = next == kEnd ? se3{} : A_[next];
    const double t = x[d] - c.G * a;
    x[d] = c.g * t;
    A_[d] = a + t * c.s;
  }
}

void ImpulseFactor::solve(std::span<double> x) {
  for (dse3& r : r_) r = {};
  for (const std::uint32_t d : tip_to_base_order_) {
    const Column& c = columns_[d];
    x[d] = c.g * x[d] + c.s * r_[d];
    if (next_[d] != kEnd) r_[next_[d]] = r_[next_[d]] + (r_[d] - x[d] * c.G);
  }
  to_velocities(x);
}

void ImpulseFactor::twists(std::span<const double> v) {
  passes().twists(columns_.data(), tip_to_base_order_.data(), next_.data(),
                  tip_to_base_order_.size(), v.data(), a_.data());
}

ImpulseFactor::Momentum ImpulseFactor::momentum_at(std::span<const int> nodes, const Data& data,
                                                   const void* twists) const {
  Momentum sum;
  passes().momenta({body_dof_.size(), inertias_.data(), inertia_at_.data(), body_dof_.data(),
                    parent_dof_.data(), twists, nullptr, nullptr},
                   nodes.data(), nodes.size(), &data.work(), &sum.inertia, &sum.momentum);
  return sum;
}

void ImpulseFactor::kinematics_of(const Model& model, Data& data, std::span<const double> q,
                                  std::span<const double> v) {
  passes().velocities(&model.tree(), &data.work(), q.data(), v.data());
}

void ImpulseFactor::bias(const Vec3& gravity, std::span<double> force) {
  for (dse3& r : r_) r = {};
  passes().body_forces({body_dof_.size(), inertias_.data(), inertia_at_.data(), body_dof_.data(),
                        parent_dof_.data(), a_.data(), A_.data(), r_.data()},
                       &gravity.x);
  for (const std::uint32_t d : tip_to_base_order_) {
    const std::uint32_t next = next_[d];
    force[d] = columns_[d].S * r_[d];
    if (next != kEnd) r_[next] = r_[next] + r_[d];
  }
}

void ImpulseFactor::add_load(int link, const Vec3& point, const dse3& load,
                             std::span<double> force) const {
  const LinkPath& path = links_[static_cast<std::size_t>(link)];
  const dse3 F{load.m + cross(point - path.origin, load.f), load.f};
  for (std::uint32_t d = path.first; d != kEnd; d = next_[d]) force[d] += columns_[d].S * F;
}

}  // namespace vp::detail
