// Converts nodes to slots, the form that the passes read (tree.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "multibody/principal.h"
#include "multibody/tree.h"

namespace vp::detail {
namespace {

template <class B>
double wider(B x) {
  return static_cast<double>(x);
}
template <class B>
Vec3 wider(const Vec3T<B>& a) {
  return {wider(a.x), wider(a.y), wider(a.z)};
}

template <class B>
class LayOut {
 public:
  explicit LayOut(Tree<B>& tree) : tree_(tree) {}

  void run() {
    make_slots();
    link_slots();
    list_runs();
    measure();
    group(tree_.one, 8);
    group(tree_.states, 1);
  }

 private:
  const Node<B>& node_of(std::size_t slot) const {
    return tree_.nodes[static_cast<std::size_t>(tree_.slots[slot].node)];
  }
  bool ends_node(std::size_t slot) const {
    return static_cast<int>(slot) == node_of(slot).body_slot();
  }

  // Masses and extents of the subtree of each slot.
  void measure() {
    composites_.assign(tree_.slots.size(), 0.0);
    max_distance_.assign(tree_.slots.size(), 0.0);
    for (std::size_t i = 0; i < tree_.slots.size(); ++i) {
      const int parent = tree_.slots[i].parent;
      if (parent == kWorld) continue;
      const bool shifts = static_cast<int>(i) == node_of(i).slot;
      max_distance_[i] = max_distance_[static_cast<std::size_t>(parent)] +
                         (shifts ? norm(wider(node_of(i).T_parent.position())) : 0.0);
    }
    for (std::size_t i = tree_.slots.size(); i-- > 0;) {
      const auto& J = node_of(i).J;
      const double mass = wider(J.mass());
      if (ends_node(i) && mass > 0.0) {
        composites_[i] += mass;
        const auto& I = J.rotational();
        max_distance_[i] += std::sqrt((wider(I.xx) + wider(I.yy) + wider(I.zz)) / mass);
      }
      if (tree_.slots[i].parent == kWorld) continue;
      const auto parent = static_cast<std::size_t>(tree_.slots[i].parent);
      composites_[parent] += composites_[i];
      max_distance_[parent] = std::max(max_distance_[parent], max_distance_[i]);
    }
  }
  // Omega is a difference of numbers about the tree's origin, of the size of a mass times a squared
  // distance. This is the bound of its rounding error. For a flexible chain the bound is far above
  // the inertia at its joints: with the epsilon of float it would reject a hundred links that are
  // computed accurately. Float therefore uses the epsilon of double, which is almost no bound. User
  // joints have no bound, because their units are unknown.
  double min_value(std::size_t i) const {
    constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
    const double mass = rounding * composites_[i];
    switch (node_of(i).kind) {
      case NodeKind::user:
        return 0.0;
      case NodeKind::prismatic:
        return mass;
      default:
        return mass * max_distance_[i] * max_distance_[i];
    }
  }

  Slot& parent_of(const Slot& slot) { return tree_.slots[static_cast<std::size_t>(slot.parent)]; }
  int above(int slot) const { return tree_.slots[static_cast<std::size_t>(slot)].parent; }

  // Whether the numbers of adjacent slots are consecutive: all must have the same first index.
  class Consecutive {
   public:
    void see(int first) {
      follow_ &= first_ == kNone || first_ == first;
      first_ = first;
    }
    int first() const { return follow_ && first_ >= 0 ? first_ : -1; }

   private:
    static constexpr int kNone = std::numeric_limits<int>::min();
    int first_ = kNone;
    bool follow_ = true;
  };

  void make_slots() {
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      Node<B>& node = tree_.nodes[n];
      if (node.parent == kWorld) {
        node.root = static_cast<int>(tree_.roots.size());
        tree_.roots.push_back(node.T_parent.position());
      } else {
        node.root = tree_.nodes[static_cast<std::size_t>(node.parent)].root;
      }
      node.slot = static_cast<int>(tree_.slots.size());
      for (int k = 0; k < node.slots(); ++k) {
        Slot slot{};
        slot.parent = k > 0 ? node.slot + k - 1
                      : node.parent == kWorld
                          ? kWorld
                          : tree_.nodes[static_cast<std::size_t>(node.parent)].body_slot();
        slot.kind = node.simple()      ? SlotKind::simple
                    : node.free_root() ? SlotKind::root
                                       : SlotKind::column;
        slot.v = node.v + k;
        slot.q = node.simple() ? node.q : -1;
        slot.node = static_cast<int>(n);
        slot.root = node.free_root()        ? node.slot
                    : slot.parent == kWorld ? kWorld
                                            : parent_of(slot).root;
        slot.from = Slot::kNone;
        slot.to = Slot::kNext;
        tree_.slots.push_back(slot);
      }
    }
  }

  void link_slots() {
    for (int i = static_cast<int>(tree_.slots.size()); i-- > 0;) {
      Slot& slot = tree_.slots[static_cast<std::size_t>(i)];
      if (slot.parent == kWorld) continue;
      Slot& parent = parent_of(slot);
      if (slot.parent == i - 1) {
        slot.to_previous = true;
        if (parent.from == Slot::kNone) {
          parent.from = Slot::kNext;
        } else {
          parent.from_next_too = true;
        }
        continue;
      }
      parent.forks = true;
      slot.adds = parent.from >= Slot::kOthers;
      if (!slot.adds) parent.from = tree_.child_slots++;
      slot.to = parent.from;
    }
  }

  void list_runs() {
    tree_.all_related = true;
    for (int i = 0; i < static_cast<int>(tree_.slots.size()); ++i) {
      tree_.first_run.push_back(static_cast<int>(tree_.runs.size()));
      const Slot& slot = tree_.slots[static_cast<std::size_t>(i)];
      tree_.all_related &= slot.parent == i - 1;
      for (int j = i; j != slot.root;) {
        int begin = j;
        while (above(begin) == begin - 1 && begin - 1 != slot.root) --begin;
        tree_.runs.push_back({begin, j + 1});
        j = above(begin);
      }
    }
    tree_.first_run.push_back(static_cast<int>(tree_.runs.size()));
  }

  void group(Layout<B>& layout, int width) {
    const int slots = static_cast<int>(tree_.slots.size());
    const int groups = (slots + width - 1) / width;
    layout.constants = AlignedArray<B>(static_cast<std::size_t>(groups * kConstants * width));
    for (int g = 0; g < groups; ++g) {
      const int first = g * width, count = std::min(width, slots - first);
      typename Layout<B>::Group group{count, true, true, -1, -1, 0, 0, 0, 0};
      Consecutive q, v;
      for (int i = first; i < first + count; ++i) {
        const Slot& slot = tree_.slots[static_cast<std::size_t>(i)];
        const NodeKind kind = node_of(static_cast<std::size_t>(i)).kind;
        group.revolute &= kind == NodeKind::revolute;
        group.simple &= kind <= NodeKind::helical;
        if (slot.kind == SlotKind::simple) q.see(slot.q - (i - first));
        if (slot.kind != SlotKind::root) v.see(slot.v - (i - first));
        write(static_cast<std::size_t>(i),
              layout.constants.data() + g * kConstants * width + i - first, width);
      }
      group.first_q = q.first();
      group.first_v = v.first();
      if (width == 8) scan(layout, group, first);
      layout.groups.push_back(group);
    }
  }

  void scan(Layout<B>& layout, typename Layout<B>::Group& group, int first) const {
    group.first_step = static_cast<int>(layout.steps.size());
    group.first_external = static_cast<int>(layout.externals.size());
    // For each lane the lane of an ancestor, or -1; initially the parent's lane.
    std::array<int, 8> ancestor{}, top{};
    bool any = false;
    for (int k = 0; k < 8; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const int parent = k < group.count ? above(first + k) : kWorld;
      ancestor[n] = parent >= first ? parent - first : -1;
      top[n] = ancestor[n] < 0 ? k : top[static_cast<std::size_t>(ancestor[n])];
      any |= ancestor[n] >= 0;
      if (k < group.count) hang(layout, group, first + top[n], k);
    }
    while (any) {
      ScanStep<B> step{};
      auto next = ancestor;
      any = false;
      for (std::size_t k = 0; k < 8; ++k) {
        if (ancestor[k] < 0) continue;
        step.from[k] = ancestor[k];
        step.lanes = static_cast<std::uint8_t>(step.lanes | 1U << k);
        next[k] = ancestor[static_cast<std::size_t>(ancestor[k])];
        any |= next[k] >= 0;
      }
      layout.steps.push_back(step);
      ancestor = next;
    }
    group.end_step = static_cast<int>(layout.steps.size());
    group.end_external = static_cast<int>(layout.externals.size());
  }
  // Assigns to lane k the external parent of slot `top`, its topmost ancestor in the group.
  void hang(Layout<B>& layout, const typename Layout<B>::Group& group, int top, int k) const {
    const Slot& slot = tree_.slots[static_cast<std::size_t>(top)];
    if (slot.kind == SlotKind::root) return;
    const auto lane = static_cast<std::uint8_t>(1U << k);
    for (auto i = static_cast<std::size_t>(group.first_external); i < layout.externals.size();
         ++i) {
      External& external = layout.externals[i];
      if (external.slot != slot.parent) continue;
      external.lanes = static_cast<std::uint8_t>(external.lanes | lane);
      return;
    }
    layout.externals.push_back({slot.parent, lane});
  }

  void write(std::size_t i, B* to, int width) const {
    const Node<B>& node = node_of(i);
    const auto set = [&](int f, double x) { to[f * width] = static_cast<B>(x); };
    const auto set3 = [&](int f, const Vec3& a) {
      for (int k = 0; k < 3; ++k) set(f + k, a[k]);
    };
    const auto& R = node.T_parent.rotation();
    set3(kRotation0, wider(R.cx));
    set3(kRotation0 + 3, wider(R.cy));
    set3(kRotation0 + 6, wider(R.cz));
    if (node.parent != kWorld) set3(kShift0, wider(node.T_parent.position()));
    const bool revolute = node.kind == NodeKind::revolute, helical = node.kind == NodeKind::helical;
    set(kRotation, revolute || helical ? 1.0 : 0.0);
    set(kSlide, node.kind == NodeKind::prismatic ? 1.0 : helical ? wider(node.pitch) : 0.0);
    set(kArmature, wider(node.armature));
    set(kDamping, wider(node.damping));
    set(kSubtreeMass, composites_[i]);
    set(kMin, min_value(i));
    if (!ends_node(i) || node.J == InertiaT<B>{}) return;
    const auto& I = node.J.rotational();
    const Inertia J(wider(node.J.mass()), wider(node.J.first_moment()),
                    {wider(I.xx), wider(I.yy), wider(I.zz), wider(I.xy), wider(I.yz), wider(I.zx)});
    const bool has_centre = J.mass() > 0.0;  // robot files have moments without a mass
    const Principal p = principal_of(has_centre ? J.central() : J.rotational());
    set(kMass, J.mass());
    if (has_centre) set3(kCentre, J.centre_of_mass());
    set(kSpin, p.moments[0]);
    set3(kAxisA, std::sqrt(p.moments[1] - p.moments[0]) * p.axes[1]);
    set3(kAxisB, std::sqrt(p.moments[2] - p.moments[0]) * p.axes[2]);
  }

  Tree<B>& tree_;
  std::vector<double> composites_;    // [kg]
  std::vector<double> max_distance_;  // from the root, along the links [m]
};

}  // namespace

template <class B>
void Tree<B>::build_rows() {
  LayOut<B>(*this).run();
}

template struct Tree<double>;
template struct Tree<float>;

}  // namespace vp::detail
