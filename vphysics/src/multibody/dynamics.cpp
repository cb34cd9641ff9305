// The public calls: each selects the kernel for its scalar and for this machine's instruction set.
#include "vphysics/multibody/dynamics.h"

#include <string>
#include <type_traits>

#include "multibody/instantiate.h"
#include "multibody/instruction_set.h"
#include "multibody/joints.h"
#include "multibody/kernels.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

using vphysics_kernels::Arguments;
using vphysics_kernels::Kernels;

template <class T>
const Kernels& kernels_of(const DataT<T>& data) {
#ifdef VP_INSTRUCTION_SETS
  if constexpr (std::is_same_v<T, double>) {
    const InstructionSet set = data.work().instruction_set;
    if (set == InstructionSet::avx512_same_bits) return vphysics_kernels::kAvx512SameBits;
    if (set == InstructionSet::avx2_same_bits) return vphysics_kernels::kAvx2SameBits;
  }
#endif
  switch (data.work().instruction_set) {
#ifdef VP_INSTRUCTION_SETS
    case InstructionSet::avx512:
      return vphysics_kernels::kAvx512[scalar_index<T>()];
    case InstructionSet::avx2:
      return vphysics_kernels::kAvx2[scalar_index<T>()];
#endif
    default:
      return vphysics_kernels::kBaseline[scalar_index<T>()];
  }
}

// Whether the data was made for the model, or for one of the same dimensions.
template <class T>
[[maybe_unused]] bool is_of(const ModelT<base_t<T>>& model, const DataT<T>& data) {
  const Work<T>& work = data.work();
  return work.factors.size() == static_cast<std::size_t>(model.velocities()) &&
         work.body_slot.size() == model.tree().nodes.size();
}
template <class T>
Arguments start(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(is_of(model, data));
  Arguments args{&model.tree(), &data.work()};
  args.q = q.data();
  return args;
}
// An array with one number for each velocity.
template <class T>
const void* checked([[maybe_unused]] const ModelT<base_t<T>>& model, std::span<const T> x) {
  VP_ASSERT(x.size() == static_cast<std::size_t>(model.velocities()));
  return x.data();
}
template <class T>
void add_loads(Arguments& args, [[maybe_unused]] const ModelT<base_t<T>>& model,
               const LoadsT<T>& loads) {
  args.gravity = &loads.gravity;
  if (loads.external.empty()) return;
  VP_ASSERT(loads.external.size() == static_cast<std::size_t>(model.links()));
  args.external = loads.external.data();
}

Expected<void> no_inertia(const char* call) {
  return tl::make_unexpected(
      Error{Errc::singular, std::string(call) +
                                ": a joint moves no inertia in this configuration, or a number "
                                "given is not finite; give its links an inertia, or the joint an "
                                "armature"});
}

}  // namespace

template <class T>
Work<T>::Work(const Tree<base_t<T>>& tree, Arithmetic arithmetic)
    : instruction_set(instruction_set_for(arithmetic)),
      rows(kSlots<T> > 1
               ? static_cast<std::size_t>(kRowSize * kSlots<T>) * layout_of<T>(tree).groups.size()
               : 0),
      fields(static_cast<std::size_t>(kFields * kSlots<T>) * layout_of<T>(tree).groups.size()),
      factors(static_cast<std::size_t>(tree.velocities)),
      articulated_flow(static_cast<std::size_t>(tree.child_slots)),
      row_flow(static_cast<std::size_t>(tree.child_slots)),
      force_flow(static_cast<std::size_t>(tree.child_slots)),
      moment_flow(static_cast<std::size_t>(tree.child_slots)),
      added(tree.slots.size()),
      zeros(static_cast<std::size_t>(tree.velocities), T(0)) {
  int general = 0;
  for (const auto& node : tree.nodes) {
    columns_of.push_back(node.simple() ? -1 : general++);
    body_slot.push_back(node.body_slot());
    root.push_back(node.root);
  }
  columns.resize(static_cast<std::size_t>(general));
  for (const auto& p : tree.roots) origins.push_back({T(p.x), T(p.y), T(p.z)});
}

}  // namespace detail

template <class T>
DataT<T>::DataT(const ModelT<base_t<T>>& model, Arithmetic arithmetic)
    : work_(std::make_unique<detail::Work<T>>(model.tree(), arithmetic)) {}
template <class T>
DataT<T>::~DataT() = default;
template <class T>
DataT<T>::DataT(DataT&&) noexcept = default;
template <class T>
DataT<T>& DataT<T>::operator=(DataT&&) noexcept = default;

template <class T>
void forward_kinematics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                        std::span<const T> v) {
  auto args = detail::start<T>(model, data, q);
  if (!v.empty()) args.v = detail::checked<T>(model, v);
  detail::kernels_of(data).kinematics(args);
}

template <class T>
SE3T<T> T_world_link(const ModelT<base_t<T>>& model, const DataT<T>& data, int link) {
  VP_ASSERT(link >= 0 && link < model.links());
  const auto& frame = model.tree().frames[static_cast<std::size_t>(link)];
  const SE3T<T> T_node_link = detail::wide<T>(frame.T_node_link);
  if (frame.node == kWorld) return T_node_link;
  const SE3T<T> X = detail::pose_of<T>(data.work(), frame.node);
  const Vec3T<T> origin = detail::origin_of<T>(data.work(), frame.node);
  return SE3T<T>(X.rotation(), X.position() + origin) * T_node_link;
}

template <class T>
se3T<T> link_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data, int link) {
  VP_ASSERT(link >= 0 && link < model.links());
  const auto& frame = model.tree().frames[static_cast<std::size_t>(link)];
  if (frame.node == kWorld) return {};
  const SE3T<T> X = detail::pose_of<T>(data.work(), frame.node);
  return InvAd(X * detail::wide<T>(frame.T_node_link),
               detail::velocity_of<T>(data.work(), frame.node));
}

template <class T>
Expected<void> forward_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data,
                                std::span<const T> q, std::span<const T> v, std::span<const T> tau,
                                const LoadsT<T>& loads, std::span<T> a) {
  auto args = detail::start<T>(model, data, q);
  args.v = detail::checked<T>(model, v);
  args.given = detail::checked<T>(model, tau);
  detail::add_loads<T>(args, model, loads);
  detail::checked<T>(model, a);
  args.out = a.data();
  if (detail::kernels_of(data).forward_dynamics(args)) return {};
  return detail::no_inertia("forward_dynamics");
}

template <class T>
Expected<void> factor_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q) {
  if (detail::kernels_of(data).factor_mass(detail::start<T>(model, data, q))) return {};
  return detail::no_inertia("factor_mass");
}

template <class T>
void solve_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<T> x) {
  detail::Arguments args{&model.tree(), &data.work()};
  VP_ASSERT(detail::is_of(model, data));
  detail::checked<T>(model, x);
  args.out = x.data();
  detail::kernels_of(data).solve_mass(args);
}

template <class T>
void inverse_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                      std::span<const T> v, std::span<const T> a, const LoadsT<T>& loads,
                      std::span<T> tau) {
  auto args = detail::start<T>(model, data, q);
  args.v = detail::checked<T>(model, v);
  args.given = detail::checked<T>(model, a);
  detail::add_loads<T>(args, model, loads);
  detail::checked<T>(model, tau);
  args.out = tau.data();
  detail::kernels_of(data).inverse_dynamics(args);
}

template <class T>
void mass_matrix(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<T> M) {
  auto args = detail::start<T>(model, data, q);
  VP_ASSERT(M.size() == static_cast<std::size_t>(model.velocities() * model.velocities()));
  args.out = M.data();
  detail::kernels_of(data).mass_matrix(args);
}

#define VP_DYNAMICS(T)                                                                          \
  template struct detail::Work<T>;                                                              \
  template class DataT<T>;                                                                      \
  template void forward_kinematics(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>,     \
                                   std::span<const T>);                                         \
  template SE3T<T> T_world_link(const ModelT<base_t<T>>&, const DataT<T>&, int);                \
  template se3T<T> link_velocity(const ModelT<base_t<T>>&, const DataT<T>&, int);               \
  template Expected<void> forward_dynamics(const ModelT<base_t<T>>&, DataT<T>&,                 \
                                           std::span<const T>, std::span<const T>,              \
                                           std::span<const T>, const LoadsT<T>&, std::span<T>); \
  template Expected<void> factor_mass(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>); \
  template void solve_mass(const ModelT<base_t<T>>&, DataT<T>&, std::span<T>);                  \
  template void inverse_dynamics(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>,       \
                                 std::span<const T>, std::span<const T>, const LoadsT<T>&,      \
                                 std::span<T>);                                                 \
  template void mass_matrix(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>, std::span<T>);
VP_FOR_EACH_SCALAR(VP_DYNAMICS)

}  // namespace vp
