// The first pass, from the roots outwards: where the links are, how they move, what they weigh.
//
//   X_i = X_parent T_parent,i e^(S_i q_i)
//   S_i = Ad_X of the joint's own subspace: (z, p x z) for a revolute, (0, z) for a prismatic joint
//   V_i = V_parent + S_i q'_i
//   A_i = A_parent + ad_(V_i) (S_i q'_i) + S'_i q'_i + S_i q''_i
//
// S is fixed in the link, hence turns with V_i; S' is the rate of a user's joint in its own frame.
// Where the joints' accelerations are what is asked for, A is without them. Of each body, about the
// origin of the tree, with its centre of mass at c:
//   h = m c,  I = I_c + m (|c|^2 - c c^T)
//   f = m (A.v + A.w x c + w x (v + w x c)),  n = I_c A.w + w x I_c w,  F = (n + c x f, f)
// F is the bias force J A - dad_V (J V), written for the centre of mass, where it is shorter.
//
// A group of slots goes through all of it before the next.
#pragma once

#include "multibody/joints.h"

namespace vp::detail {

// How far the pass goes.
enum class Reach { poses, velocities, accelerations };

// A body's central inertia, turned into the axes of the tree, as kSpin 1 + a a^T + b b^T: less to
// turn than a matrix, and less to multiply with.
template <class N>
struct Body {
  N mass, spin;
  Vec3T<N> centre, a, b;
};
template <class T, class N>
Body<N> body_in_tree(const Constants<T, N>& k, const SE3T<N>& X) {
  return {k.get(kMass), k.get(kSpin), X * k.vec(kCentre), X.rotate(k.vec(kAxisA)),
          X.rotate(k.vec(kAxisB))};
}
template <class N>
Vec3T<N> central_times(const Body<N>& body, const Vec3T<N>& w) {
  return body.spin * w + dot(body.a, w) * body.a + dot(body.b, w) * body.b;
}
template <class N>
Sym3T<N> rotational(const Body<N>& body, const Vec3T<N>& h) {
  const Vec3T<N>&a = body.a, &b = body.b, &c = body.centre;
  const N x = h.x * c.x, y = h.y * c.y, z = h.z * c.z;
  return {(body.spin + a.x * a.x) + (b.x * b.x + (y + z)),
          (body.spin + a.y * a.y) + (b.y * b.y + (z + x)),
          (body.spin + a.z * a.z) + (b.z * b.z + (x + y)),
          a.x * a.y + b.x * b.y - h.x * c.y,
          a.y * a.z + b.y * b.z - h.y * c.z,
          a.z * a.x + b.z * b.x - h.z * c.x};
}
template <class N>
dse3T<N> body_force(const Body<N>& body, const se3T<N>& V, const se3T<N>& A) {
  const Vec3T<N>& c = body.centre;
  const Vec3T<N> f = body.mass * (A.v + cross(A.w, c) + cross(V.w, V.v + cross(V.w, c)));
  const Vec3T<N> n = central_times(body, A.w) + cross(V.w, central_times(body, V.w));
  return {n + cross(c, f), f};
}

template <class T, Reach kReach>
class Outwards {
 public:
  // a: of the joints, or empty: none.
  Outwards(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q, Span<T> v, Span<T> a)
      : tree_(tree), layout_(layout_of<T>(tree)), work_(work), q_(q), v_(v), a_(a) {}

  // First of all groups the joints' sines and cosines: long chains of operations, but none waits
  // for another group's.
  void open_angles(int g) {
    const auto& group = layout_.groups[static_cast<std::size_t>(g)];
    const auto k = group_constants<T>(tree_, g);
    const auto fields = work_.group(g);
    const W q = coordinates(g, group);
    W angle = group.revolute ? q : k.get(kTurn) * q;
    if (reduce_) angle = reduced(angle);
    const W limit(Angle<B>::kExactBelow);
    near_ = both(near_, both(angle < limit, -angle < limit));
    const auto [sine, cosine] = sin_cos_near(angle);
    fields.set(kTurned, sine);
    fields.set(kTurned + 1, cosine);
    if (!group.revolute) fields.set(kTurned + 2, k.get(kSlide) * q);
  }
  // Poses, subspaces, velocities and accelerations of group g.
  void move(int g) {
    const auto& group = layout_.groups[static_cast<std::size_t>(g)];
    if (group.simple) {
      move_simple(g, group);
    } else {
      move_any(g, group);
    }
  }

  // An angle is so large that it has to be taken modulo 2 pi first.
  bool far() const { return !all(near_); }
  void reduce_angles() { reduce_ = true; }

 private:
  using W = Wide<T>;
  using Group = typename Layout<base_t<T>>::Group;
  using B = base_t<T>;

  // Apart, so that simple joints' numbers need not be in memory for what others call.
  void move_simple(int g, const Group& group) { move<true>(g, group); }
  VP_FLATTEN VP_APART void move_any(int g, const Group& group) { move<false>(g, group); }

  template <bool kSimple>
  void move(int g, const Group& group) {
    turn(g, group);
    const int first = g * kSlots<T>, end = first + group.count;
    if constexpr (kByRows<T>) {
      place_by_rows<kSimple>(g, group);
    } else {
      for (int i = first; i < end; ++i) place<kSimple>(i);
    }
    open_subspaces<kSimple>(g, group);
    if constexpr (kReach != Reach::poses) {
      for (int i = first; i < end; ++i) add_to_parent<kSimple>(i, kV);
    }
    if constexpr (kReach == Reach::accelerations) {
      const auto fields = work_.group(g);
      fields.set(kA, ad(fields.twist(kV), fields.twist(kOwn)));
      if constexpr (!kSimple) {
        for (int i = first; i < end; ++i) bias_of_columns(i);
      }
      if (!a_.empty()) {
        fields.set(kA, fields.twist(kA) + along(a_, first, group.count) * fields.twist(kS));
      }
      if constexpr (!kSimple) {
        for (int i = first; i < end; ++i) accelerate_root(i);
      }
      for (int i = first; i < end; ++i) add_to_parent<kSimple>(i, kA);
    }
  }

  const Slot& slot(int i) const { return tree_.slots[static_cast<std::size_t>(i)]; }

  // Numbers of the slots of a group from an array in the order of the slots.
  W along(Span<T> x, int first, int count) const {
    if (count == kSlots<T>) return load_unaligned<W>(&x[static_cast<std::size_t>(first)]);
    W out(B(0));
    if constexpr (kSlots < T >> 1) {
      for (int k = 0; k < count; ++k) out.set(k, x[static_cast<std::size_t>(first + k)]);
    }
    return out;
  }
  W coordinates(int g, const Group& group) const {
    if (group.first_q >= 0) return along(q_, group.first_q, group.count);
    W out(B(0));
    for (int k = 0; k < group.count; ++k) {
      const int q = slot(g * kSlots<T> + k).q;
      if (q < 0) continue;
      if constexpr (kSlots < T >> 1) {
        out.set(k, q_[static_cast<std::size_t>(q)]);
      } else {
        out = q_[static_cast<std::size_t>(q)];
      }
    }
    return out;
  }

  // e^(S q) behind the pose at zero: two columns mix, and z leads along.
  void turn(int g, const Group& group) {
    const auto k = group_constants<T>(tree_, g);
    const auto fields = work_.group(g);
    const W sine = fields.get(kTurned), cosine = fields.get(kTurned + 1);
    const Vec3T<W> x = k.vec(kTurn0), y = k.vec(kTurn0 + 3), z = k.vec(kTurn0 + 6);
    fields.set(kX, cosine * x + sine * y);
    fields.set(kX + 3, cosine * y - sine * x);
    fields.set(kX + 6, z);
    Vec3T<W> p = k.vec(kShift0);
    if (!group.revolute) p += fields.get(kTurned + 2) * z;
    fields.set(kX + 9, p);
  }
  VP_APART static W reduced(const W& angle) {
    W out = angle;
    for (int k = 0; k < W::kLanes; ++k) {
      out.set(k, static_cast<B>(std::fmod(static_cast<double>(angle[k]), 2 * kPi)));
    }
    return out;
  }

  Fields<T, T> parent_of(int i) const {
    const int parent = slot(i).parent;
    return parent == kWorld ? Fields<T, T>(work_.world.data()) : work_.slot(parent);
  }

  template <bool kSimple>
  void place(int i) {
    const Slot& s = slot(i);
    const auto fields = work_.slot(i);
    if (kSimple || s.kind == SlotKind::simple) {
      fields.set(kX, parent_of(i).pose(kX) * fields.pose(kX));
    } else if (s.kind == SlotKind::column) {
      fields.set(kX, place_general(i, parent_of(i).pose(kX)));
    } else if (s.last) {
      fields.set(kX, place_root(i));
    }
  }
  template <bool kSimple>
  void place_by_rows(int g, const Group& group) {
    const int first = g * kSlots<T>, end = first + group.count;
    const auto world = ColumnPose<T>::from(kOrigin<T>);
    ColumnPose<T> pose = world;
    for (int i = first; i < end; ++i) {
      const Slot& s = slot(i);
      T* const row = work_.row(i);
      if (kSimple || s.kind == SlotKind::simple) {
        if (i == first || !s.to_previous) {
          pose = s.parent == kWorld ? world : ColumnPose<T>::from(work_.row(s.parent));
        }
        pose = pose.times(work_.slot(i).pose(kX));
        pose.to(row);
      } else if (s.kind == SlotKind::column) {
        const SE3T<T> parent = s.parent == kWorld ? SE3T<T>() : pose_from(work_.row(s.parent));
        pose_to(row, place_general(i, parent));
        pose = ColumnPose<T>::from(row);
      } else if (s.last) {
        pose_to(row, place_root(i));
        pose = ColumnPose<T>::from(row);
      }
    }
    const auto fields = work_.group(g);
    for (int k = 0; k < 4; ++k) {
      fields.set(kX + 3 * k, gathered(work_.row(first), kRowSize, k));
    }
  }
  // A slot of a node that is not simple: the first places the node, the others are with it.
  VP_APART SE3T<T> place_general(int i, const SE3T<T>& parent) {
    const auto n = static_cast<std::size_t>(slot(i).node);
    const auto& node = tree_.nodes[n];
    if (i != node.v) return parent;
    return place_columns<T>(node, parent, q_, v_, columns(n));
  }
  SE3T<T> place_root(int i) {
    const auto& node = tree_.nodes[static_cast<std::size_t>(slot(i).node)];
    const auto root = static_cast<std::size_t>(node.root);
    const auto k = static_cast<std::size_t>(node.q);
    const Mat3T<T> R0 = wide<T>(node.T_parent).rotation();
    work_.origins[root] = wide<T>(tree_.roots[root]) + R0 * Vec3T<T>{q_[k], q_[k + 1], q_[k + 2]};
    const Vec3T<T> nowhere{T(0), T(0), T(0)};
    return {R0 * from_quaternion(quaternion_at<T>(q_, node.q + 3)), nowhere};
  }
  // Six numbers of a free root, from its axes to the tree's.
  se3T<T> of_root(int last, const Mat3T<T>& R, Span<T> x) const {
    const auto i = static_cast<std::size_t>(last);
    return {R * Vec3T<T>{x[i - 5], x[i - 4], x[i - 3]}, R * Vec3T<T>{x[i - 2], x[i - 1], x[i]}};
  }
  void open_root(int i) {
    const auto fields = work_.slot(i);
    const Mat3T<T> R = fields.mat(kX);
    const Vec3T<T> nowhere{T(0), T(0), T(0)};
    const auto open = [&](int k, const Vec3T<T>& axis) {
      work_.slot(i - 5 + k).set(kS, se3T<T>{axis, nowhere});
      work_.slot(i - 2 + k).set(kS, se3T<T>{nowhere, axis});
    };
    open(0, R.cx);
    open(1, R.cy);
    open(2, R.cz);
    if constexpr (kReach != Reach::poses) fields.set(kV, of_root(i, R, v_));
  }
  void accelerate_root(int i) {
    if (slot(i).kind != SlotKind::root || !slot(i).last) return;
    const auto fields = work_.slot(i);
    se3T<T> A = Fields<T, T>(work_.world.data()).twist(kA);
    if (!a_.empty()) A = A + of_root(i, fields.mat(kX), a_);
    fields.set(kA, A);
  }
  Columns<T>& columns(std::size_t node) {
    return work_.columns[static_cast<std::size_t>(work_.columns_of[node])];
  }

  template <bool kSimple>
  void open_subspaces(int g, const Group& group) {
    const auto k = group_constants<T>(tree_, g);
    const auto fields = work_.group(g);
    const Vec3T<W> z = fields.vec(kX + 6), s = cross(fields.vec(kX + 9), z);
    if (group.revolute) {
      fields.set(kS, z);
      fields.set(kS + 3, s);
    } else {
      const W turn = k.get(kTurn), slide = k.get(kSlide);
      fields.set(kS, turn * z);
      fields.set(kS + 3, turn * s + slide * z);
    }
    const int first = g * kSlots<T>, end = first + group.count;
    if constexpr (!kSimple) {
      for (int i = first; i < end; ++i) {
        if (slot(i).kind != SlotKind::column) continue;
        const auto n = static_cast<std::size_t>(slot(i).node);
        const int column = i - tree_.nodes[n].v;
        work_.slot(i).set(kS, columns(n).S[static_cast<std::size_t>(column)]);
      }
    }
    if constexpr (kReach != Reach::poses) {
      const se3T<W> own = along(v_, first, group.count) * fields.twist(kS);
      fields.set(kOwn, own);
      fields.set(kV, own);
    }
    if constexpr (!kSimple) {
      for (int i = first; i < end; ++i) {
        if (slot(i).kind == SlotKind::root && slot(i).last) open_root(i);
      }
    }
  }

  template <bool kSimple>
  void add_to_parent(int i, int field) {
    if (!kSimple && slot(i).kind == SlotKind::root) return;
    const auto fields = work_.slot(i);
    fields.set(field, parent_of(i).twist(field) + fields.twist(field));
  }

  // The columns of a node turn with its link, all of them: the sum is due at its last slot.
  VP_APART void bias_of_columns(int i) {
    const Slot& s = slot(i);
    if (s.kind != SlotKind::column) return;
    const auto n = static_cast<std::size_t>(s.node);
    const auto& node = tree_.nodes[n];
    const auto fields = work_.slot(i);
    se3T<T> bias{Vec3T<T>{T(0), T(0), T(0)}, Vec3T<T>{T(0), T(0), T(0)}};
    if (i == node.body_slot()) {
      se3T<T> own = work_.slot(node.v).twist(kOwn);
      for (int k = node.v + 1; k <= i; ++k) own = own + work_.slot(k).twist(kOwn);
      bias = ad(fields.twist(kV), own) + columns(n).rate;
    }
    fields.set(kA, bias);
  }

  const Tree<B>& tree_;
  const Layout<B>& layout_;
  Work<T>& work_;
  Span<T> q_, v_, a_;
  bool reduce_ = false;
  typename W::Mask near_ = W(0) == W(0);
};

// Runs a pass over all groups: with each, what is to be done once it has moved.
template <class T, Reach kReach, class Then>
void outwards(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q, Span<T> v, Span<T> a,
              const Then& then) {
  Outwards<T, kReach> pass(tree, work, q, v, a);
  const auto& groups = layout_of<T>(tree).groups;
  const int count = static_cast<int>(groups.size());
  for (int g = 0; g < count; ++g) pass.open_angles(g);
  if (pass.far()) {
    pass.reduce_angles();
    for (int g = 0; g < count; ++g) pass.open_angles(g);
  }
  for (int g = 0; g < count; ++g) {
    if (groups[static_cast<std::size_t>(g)].idle) continue;
    pass.move(g);
    then(g, group_constants<T>(tree, g));
  }
}

// The loads' forces on the links, from the bodies' bias forces.
template <class T, bool kInRows>
VP_APART void subtract_external(const Tree<base_t<T>>& tree, Work<T>& work,
                                Span<dse3T<T>> external) {
  if (external.empty()) return;
  for (std::size_t l = 0; l < tree.places.size(); ++l) {
    const auto& place = tree.places[l];
    if (place.node == kWorld) continue;
    const int slot = tree.nodes[static_cast<std::size_t>(place.node)].body_slot();
    const auto fields = work.slot(slot);
    const dse3T<T> F = InvdAd(fields.pose(kX) * wide<T>(place.T_node_link), external[l]);
    if constexpr (kInRows) {
      T* const at = work.row(slot) + kRowForce;
      const T parts[6] = {F.m.x, F.m.y, F.m.z, F.f.x, F.f.y, F.f.z};
      for (int k = 0; k < 6; ++k) at[k] = at[k] - parts[k];
    } else {
      fields.set(kF, fields.wrench(kF) - F);
    }
  }
}

}  // namespace vp::detail
