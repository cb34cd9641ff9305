// The first pass, base to tip: poses, velocities, accelerations and bias forces of the links.
//
//   X_i = X_parent T_parent,i e^(S_i q_i)
//   S_i = Ad_X of the joint's own subspace: (z, p x z) for a revolute, (0, z) for a prismatic joint
//   V_i = V_parent + S_i q'_i
//   A_i = A_parent + ad_(V_i) (S_i q'_i) + S'_i q'_i + S_i q''_i
//
// S is fixed in the link, hence rotates with V_i. S' is the rate of a user joint's subspace in the
// joint's own frame. Forward dynamics omits the term S_i q''_i from A. For each body, about the
// origin of the tree, with its centre of mass at c:
//   h = m c,  I = I_c + m (|c|^2 - c c^T)
//   f = m (A.v + A.w x c + w x (v + w x c)),  n = I_c A.w + w x I_c w,  F = (n + c x f, f)
// F is the bias force J A - dad_V (J V), in the shorter form about the centre of mass.
//
// The pass completes a group of slots before it starts the next.
#pragma once

#include "multibody/joints.h"
#include "multibody/scan.h"

namespace vp::detail {

// The results that the pass computes.
enum class PassDepth { poses, velocities, accelerations };

// A body in the axes of the tree. Its central inertia is stored as kSpin 1 + a a^T + b b^T:
// rotating two vectors is cheaper than rotating a matrix.
template <class N>
struct Body {
  N mass;
  Vec3T<N> centre;
  Sym3T<N> central;
};
template <class T>
struct BodyInTree {
  using W = Wide<T>;
  Body<W> operator()(const Constants<T, W>& k, const SE3T<W>& X) const {
    const Vec3T<W> a = X.rotate(k.vec(kAxisA)), b = X.rotate(k.vec(kAxisB));
    const W spin = k.get(kSpin);
    return {k.get(kMass),
            X * k.vec(kCentre),
            {(spin + a.x * a.x) + b.x * b.x, (spin + a.y * a.y) + b.y * b.y,
             (spin + a.z * a.z) + b.z * b.z, a.x * a.y + b.x * b.y, a.y * a.z + b.y * b.z,
             a.z * a.x + b.z * b.x}};
  }
};
// The body's inertia about the origin of the tree, from its first moment h.
template <class N>
Sym3T<N> rotational(const Body<N>& body, const Vec3T<N>& h) {
  const Vec3T<N>& c = body.centre;
  const Sym3T<N>& I = body.central;
  const N x = h.x * c.x, y = h.y * c.y, z = h.z * c.z;
  return {I.xx + (y + z),   I.yy + (z + x),   I.zz + (x + y),
          I.xy - h.x * c.y, I.yz - h.y * c.z, I.zx - h.z * c.x};
}
template <class N>
dse3T<N> body_force(const Body<N>& body, const se3T<N>& V, const se3T<N>& A) {
  const Vec3T<N>& c = body.centre;
  const Vec3T<N> f = body.mass * (A.v + cross(A.w, c) + cross(V.w, V.v + cross(V.w, c)));
  const Vec3T<N> n = body.central * A.w + cross(V.w, body.central * V.w);
  return {n + cross(c, f), f};
}

// The steps of the pass for one group of slots. Groups are processed in order.
template <class T>
class SlotMotion {
 public:
  using W = Wide<T>;
  using B = base_t<T>;
  using Group = typename Layout<B>::Group;
  struct Angles {
    W sine, cosine, slide;
  };

  // a: the joint accelerations, or empty.
  SlotMotion(const Tree<B>& tree, Work<T>& work, Span<T> q, Span<T> v, Span<T> a)
      : tree_(tree), layout_(layout_of<T>(tree)), work_(work), q_(q), v_(v), a_(a) {}

  const Layout<B>& layout() const { return layout_; }
  Constants<T, W> constants(int g) const { return group_constants<T>(tree_, g); }
  Fields<T, W> fields(int g) const { return work_.group(g); }
  W rates(int g, const Group& group) const { return velocities(v_, g, group); }
  bool has_accelerations() const { return !a_.empty(); }
  W accelerations(int g, const Group& group) const { return velocities(a_, g, group); }

  // True if an angle is so large that it must first be reduced modulo 2 pi.
  bool far() const { return !reduce_ && !all(near_); }
  void reduce_angles() { reduce_ = true; }

  Angles begin_angles(int g) {
    const auto& group = layout_.groups[static_cast<std::size_t>(g)];
    const auto k = group_constants<T>(tree_, g);
    const W q = coordinates(g, group);
    W angle = group.revolute ? q : k.get(kRotation) * q;
    if (reduce_) angle = reduced(angle);
    const W limit(Angle<B>::kExactBelow);
    near_ = both(near_, both(angle < limit, -angle < limit));
    const auto [sine, cosine] = sin_cos_near(angle);
    return {sine, cosine, group.revolute ? W(B(0)) : k.get(kSlide) * q};
  }
  VP_NOINLINE static W reduced(const W& angle) {
    W out = angle;
    for (int k = 0; k < W::kLanes; ++k) {
      if (std::fabs(angle[k]) < Angle<B>::kExactBelow) continue;
      out.set(k, static_cast<B>(std::fmod(static_cast<double>(angle[k]), 2 * kPi)));
    }
    return out;
  }

  const Slot& slot(int i) const { return tree_.slots[static_cast<std::size_t>(i)]; }

  // Gathers the number of each slot of a group from an array; zero for slots that have none.
  W coordinates(int g, const Group& group) const {
    return along(q_, g, group, group.first_q, [](const Slot& s) { return s.q; });
  }
  W velocities(Span<T> x, int g, const Group& group) const {
    return along(x, g, group, group.first_v,
                 [](const Slot& s) { return s.kind == SlotKind::root ? -1 : s.v; });
  }
  template <class IndexOf>
  W along(Span<T> x, int g, const Group& group, int first, const IndexOf& index_of) const {
    if constexpr (kSlots<T> == 1) {
      return first < 0 ? W(B(0)) : x[static_cast<std::size_t>(first)];
    } else {
      if (first >= 0) {
        return load_until<W>(x.data() + first, static_cast<int>(x.size()) - first, group.count);
      }
      W out(B(0));
      for (int k = 0; k < group.count; ++k) {
        const int i = index_of(slot(g * kSlots<T> + k));
        if (i >= 0) out.set(k, x[static_cast<std::size_t>(i)]);
      }
      return out;
    }
  }

  // The pose at zero coordinates times e^(S q): rotates two columns and translates along z.
  SE3T<W> turned(int g, const Group& group, const Angles& angles) const {
    const auto k = group_constants<T>(tree_, g);
    const Vec3T<W> x = k.vec(kRotation0), y = k.vec(kRotation0 + 3), z = k.vec(kRotation0 + 6);
    Vec3T<W> p = k.vec(kShift0);
    if (!group.revolute) p += angles.slide * z;
    return {Mat3T<W>{angles.cosine * x + angles.sine * y, angles.cosine * y - angles.sine * x, z},
            p};
  }

  // Poses in the tree's frame, from the poses in the parents' frames.
  SE3T<W> placed(int g, const Group& group, const SE3T<W>& local) {
    if constexpr (kByRows<T>) {
      const SE3T<W> X = multiplied_in_group(layout_, group, local);
      SE3T<W> above;
      bool has_no_external = true;
      for (int i = group.first_external; i < group.end_external; ++i) {
        const External& external = layout_.externals[static_cast<std::size_t>(i)];
        if (external.slot == kWorld) continue;
        above = pose_in_lanes(external, work_.slot(external.slot).pose(kX), above);
        has_no_external = false;
      }
      return has_no_external ? X : above * X;
    } else if constexpr (kSlots<T> == 1) {
      return has_parent(g) ? work_.slot(slot(g).parent).pose(kX) * local : local;
    } else {
      work_.group(g).set(kX, local);
      for (int i = g * kSlots<T>; i < g * kSlots<T> + group.count; ++i) {
        if (!has_parent(i)) continue;
        const auto fields = work_.slot(i);
        fields.set(kX, work_.slot(slot(i).parent).pose(kX) * fields.pose(kX));
      }
      return work_.group(g).pose(kX);
    }
  }
  bool has_parent(int i) const { return slot(i).parent != kWorld; }

  // Handles a slot of a node that is not simple. Its first slot has the node's pose, the others the
  // identity.
  VP_NOINLINE void take_general(int i, int k, SE3T<W>& local) {
    if (slot(i).kind == SlotKind::simple) return;
    const auto n = static_cast<std::size_t>(slot(i).node);
    const auto& node = tree_.nodes[n];
    const SE3T<T> X = slot(i).kind == SlotKind::root ? place_root(node)
                      : i == node.slot               ? place_columns<T>(node, q_, v_, columns(n))
                                                     : SE3T<T>();
    if constexpr (kSlots<T> == 1) {
      local = X;
    } else {
      Mat3T<W> R = local.rotation();
      Vec3T<W> p = local.position();
      set_lane_of(R.cx, k, X.rotation().cx);
      set_lane_of(R.cy, k, X.rotation().cy);
      set_lane_of(R.cz, k, X.rotation().cz);
      set_lane_of(p, k, X.position());
      local = {R, p};
    }
  }
  SE3T<T> place_root(const Node<B>& node) {
    const auto root = static_cast<std::size_t>(node.root);
    const auto k = static_cast<std::size_t>(node.q);
    const Mat3T<T> R0 = wide<T>(node.T_parent).rotation();
    work_.origins[root] = wide<T>(tree_.roots[root]) + R0 * Vec3T<T>{q_[k], q_[k + 1], q_[k + 2]};
    const Vec3T<T> nowhere{T(0), T(0), T(0)};
    return {R0 * from_quaternion(quaternion_at<T>(q_, node.q + 3)), nowhere};
  }
  Columns<T>& columns(std::size_t node) {
    return work_.columns[static_cast<std::size_t>(work_.columns_of[node])];
  }

  se3T<W> subspaces(int g, const Group& group, const SE3T<W>& X) const {
    const Vec3T<W> z = X.rotation().cz, s = cross(X.position(), z);
    if (group.revolute) return {z, s};
    const auto k = group_constants<T>(tree_, g);
    const W turn = k.get(kRotation), slide = k.get(kSlide);
    return {turn * z, turn * s + slide * z};
  }

  // Replaces lane k of a group by the value of slot i, whose node is not simple.
  static void set(se3T<W>& to, [[maybe_unused]] int k, const se3T<T>& V) {
    if constexpr (kSlots<T> == 1) {
      to = V;
    } else {
      set_lane_of(to.w, k, V.w);
      set_lane_of(to.v, k, V.v);
    }
  }
  void take_column(int i, int k, se3T<W>& S) {
    if (slot(i).kind != SlotKind::column) return;
    const auto n = static_cast<std::size_t>(slot(i).node);
    const auto& node = tree_.nodes[n];
    if (i == node.slot) open_columns<T>(node, work_.slot(i).pose(kX), columns(n));
    set(S, k, columns(n).S[static_cast<std::size_t>(i - node.slot)]);
  }
  // Rotates six components of a free root from the link's axes to the tree's axes.
  se3T<T> root_twist(int i, Span<T> x) const {
    const Mat3T<T> R = work_.slot(i).mat(kX);
    const auto k = static_cast<std::size_t>(slot(i).v);
    return {R * Vec3T<T>{x[k], x[k + 1], x[k + 2]}, R * Vec3T<T>{x[k + 3], x[k + 4], x[k + 5]}};
  }
  void take_root_velocity(int i, int k, se3T<W>& own) const {
    if (slot(i).kind == SlotKind::root) set(own, k, root_twist(i, v_));
  }
  void take_root_acceleration(int i, int k, se3T<W>& own) const {
    if (slot(i).kind != SlotKind::root) return;
    se3T<T> A = work_.A_world;
    if (!a_.empty()) A = A + root_twist(i, a_);
    set(own, k, A);
  }
  // All columns of a node rotate with its link. The last slot therefore adds ad_V of the joint's
  // total velocity, which is V - V_parent, and ad_V V = 0.
  VP_NOINLINE void take_bias(int i, int k, se3T<W>& own) {
    const Slot& s = slot(i);
    if (s.kind != SlotKind::column) return;
    const auto n = static_cast<std::size_t>(s.node);
    const auto& node = tree_.nodes[n];
    const Vec3T<T> nowhere{T(0), T(0), T(0)};
    se3T<T> bias{nowhere, nowhere};
    if (i == node.body_slot()) {
      bias = columns(n).rate;
      const int parent = slot(node.slot).parent;
      if (parent != kWorld) {
        bias = bias + ad(work_.slot(parent).twist(kV), work_.slot(i).twist(kV));
      }
    }
    set(own, k, bias);
  }

  // Adds the parent's value to each slot's value, in field kV or kA. A root keeps its own value.
  se3T<W> summed(int g, const Group& group, const se3T<W>& own, int field) {
    const auto fields = work_.group(g);
    if constexpr (kByRows<T>) {
      se3T<W> sum = summed_in_group(layout_, group, own);
      for (int i = group.first_external; i < group.end_external; ++i) {
        const External& external = layout_.externals[static_cast<std::size_t>(i)];
        if (external.slot != kWorld) {
          sum = sum + in_blocks<T>(external, work_.slot(external.slot).twist(field));
        } else if (field == kA) {
          sum = sum + in_blocks<T>(external, work_.A_world);
        }
      }
      fields.set(field, sum);
      return sum;
    } else if constexpr (kSlots<T> == 1) {
      const se3T<W> sum = sum_of(g, own, field);
      fields.set(field, sum);
      return sum;
    } else {
      fields.set(field, own);
      for (int i = g * kSlots<T>; i < g * kSlots<T> + group.count; ++i) {
        const auto its = work_.slot(i);
        its.set(field, sum_of(i, its.twist(field), field));
      }
      return fields.twist(field);
    }
  }
  se3T<T> sum_of(int i, const se3T<T>& own, int field) const {
    if (has_parent(i)) return work_.slot(slot(i).parent).twist(field) + own;
    return field == kA && slot(i).kind != SlotKind::root ? work_.A_world + own : own;
  }

 private:
  const Tree<B>& tree_;
  const Layout<B>& layout_;
  Work<T>& work_;
  Span<T> q_, v_, a_;
  bool reduce_ = false;
  typename W::Mask near_ = W(0) == W(0);
};

// body_of(k, X) computes the bodies from a group's constants and poses. take(g, body, V, A) then
// receives them, with V and A as far as kDepth goes. This order keeps few values live at a time.
template <class T, PassDepth kDepth, class BodyOf, class Take>
class BaseToTip {
 public:
  BaseToTip(SlotMotion<T>& motion, const BodyOf& body_of, const Take& take)
      : motion_(motion), body_of_(body_of), take_(take) {}

  // Processes the groups in order. The sine and cosine of a joint are a long dependency chain:
  // those of the next group start before the poses of the current group.
  void begin() { angles_ = motion_.begin_angles(0); }
  void move(int g) {
    const auto& groups = motion_.layout().groups;
    const auto& group = groups[static_cast<std::size_t>(g)];
    const Angles angles = angles_;
    if (g + 1 < static_cast<int>(groups.size())) angles_ = motion_.begin_angles(g + 1);
    if (group.simple) {
      move_as<true>(g, group, angles);
    } else {
      move_any(g, group, angles);
    }
  }

 private:
  using W = Wide<T>;
  using Angles = typename SlotMotion<T>::Angles;
  using Group = typename SlotMotion<T>::Group;

  // Not inlined, so that the values of simple joints need not be in memory for the calls that other
  // joints make.
  VP_FLATTEN VP_NOINLINE void move_any(int g, const Group& group, const Angles& angles) {
    move_as<false>(g, group, angles);
  }

  template <bool kSimple>
  void move_as(int g, const Group& group, const Angles& angles) {
    const auto fields = motion_.fields(g);
    SE3T<W> X = motion_.turned(g, group, angles);
    if constexpr (!kSimple) {
      for (int k = 0; k < group.count; ++k) motion_.take_general(g * kSlots<T> + k, k, X);
    }
    X = motion_.placed(g, group, X);
    fields.set(kX, X);
    const auto body = body_of_(motion_.constants(g), X);
    se3T<W> S = motion_.subspaces(g, group, X);
    if constexpr (!kSimple) {
      for (int k = 0; k < group.count; ++k) motion_.take_column(g * kSlots<T> + k, k, S);
    }
    fields.set(kS, S);
    if constexpr (kDepth == PassDepth::poses) {
      take_(g, body, se3T<W>{}, se3T<W>{});
      return;
    }

    se3T<W> own = motion_.rates(g, group) * S;
    if constexpr (!kSimple) {
      for (int k = 0; k < group.count; ++k) motion_.take_root_velocity(g * kSlots<T> + k, k, own);
    }
    const se3T<W> V = motion_.summed(g, group, own, kV);
    if constexpr (kDepth != PassDepth::accelerations) {
      take_(g, body, V, se3T<W>{});
      return;
    }

    own = ad(V, own);
    if constexpr (!kSimple) {
      for (int k = 0; k < group.count; ++k) motion_.take_bias(g * kSlots<T> + k, k, own);
    }
    if (motion_.has_accelerations()) own = own + motion_.accelerations(g, group) * S;
    if constexpr (!kSimple) {
      for (int k = 0; k < group.count; ++k)
        motion_.take_root_acceleration(g * kSlots<T> + k, k, own);
    }
    take_(g, body, V, motion_.summed(g, group, own, kA));
  }

  SlotMotion<T>& motion_;
  const BodyOf& body_of_;
  const Take& take_;
  Angles angles_;
};

// Runs a pass over all groups. Repeats it with reduced angles if an angle is too large.
template <class T, PassDepth kDepth, class BodyOf, class Take>
void pass_base_to_tip(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q, Span<T> v, Span<T> a,
                      const BodyOf& body_of, const Take& take) {
  SlotMotion<T> motion(tree, work, q, v, a);
  BaseToTip<T, kDepth, BodyOf, Take> pass(motion, body_of, take);
  const int count = static_cast<int>(layout_of<T>(tree).groups.size());
  if (count == 0) return;
  for (;;) {
    pass.begin();
    for (int g = 0; g < count; ++g) pass.move(g);
    if (!motion.far()) return;
    motion.reduce_angles();
  }
}

// Subtracts the external loads on the links from the bodies' bias forces.
template <class T, bool kInRows>
VP_NOINLINE void subtract_external(const Tree<base_t<T>>& tree, Work<T>& work,
                                   Span<dse3T<T>> external) {
  if (external.empty()) return;
  for (std::size_t l = 0; l < tree.frames.size(); ++l) {
    const auto& frame = tree.frames[l];
    if (frame.node == kWorld) continue;
    const int slot = tree.nodes[static_cast<std::size_t>(frame.node)].body_slot();
    const auto fields = work.slot(slot);
    const dse3T<T> F = InvdAd(fields.pose(kX) * wide<T>(frame.T_node_link), external[l]);
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
