#include "world/joint_steps.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "solve/passes.h"
#include "solve/state_vector.h"
#include "world/lane_fields.h"
#include "world/prefetch.h"
#include "world/solver_limits.h"
#include "world/validate.h"

namespace vp {
namespace {

using solve::kLanes;

constexpr std::size_t kBlockGrain = 16;  // blocks: some microseconds
// Blocks that are passed to all passes of one loop before the next ones: they stay in the cache.
constexpr std::size_t kTile = 8;
constexpr std::size_t kAhead = 6;  // joints, whose bodies are requested ahead of their use

// The nearest multiple of 2 pi.
double revolutions_of(double angle) {
  return 2.0 * kPi * std::floor(angle / (2.0 * kPi) + 0.5);
}

solve::JointForm form_of(const BodyJoint& joint) {
  solve::JointForm form;
  const int point = joint.holds_point() ? 3 : 0;
  form.rows = static_cast<std::uint8_t>(joint.count - point);
  form.locked = static_cast<std::uint8_t>(joint.locked - point);
  if (joint.spec.form != JointSpec::Form::axes) return form;
  for (int i = 0; i < form.rows; ++i) {
    const BodyJointRow& row = joint.rows[point + i];
    const bool of_cone = joint.spec.cone && row.slot == solve::kSwingX;
    form.slot[i] = of_cone ? solve::kCone : row.slot;
  }
  return form;
}

// rotated: full revolutions [rad] that are subtracted from the coordinate of a twist.
template <class BLOCK>
void fill_rows(BLOCK& block, int lane, const BodyJoint& joint, double rotated) {
  constexpr int kPoint = BLOCK::kPointRows;
  for (int i = kPoint; i < joint.count; ++i) {
    const BodyJointRow& from = joint.rows[i];
    solve::RowPart& row = block.rows[i - kPoint];
    put(row.impulse, lane, from.impulse);
    put(row.rate, lane, from.rate);
    put(row.loss, lane, from.loss);
    put(row.relaxes, lane, from.relaxes ? 1.0 : 0.0);
    if (i < joint.locked) continue;
    solve::BoundPart& bound = block.bounds[i - kPoint];
    const double from_rotation = from.slot == solve::kTwist ? rotated : 0.0;
    put(bound.stop, lane, from.stop);
    put(bound.holds, lane, from.bounded_hold ? 1.0 : 0.0);
    put(bound.min_impulse, lane, from.min_impulse);
    put(bound.max_impulse, lane, from.max_impulse);
    put(bound.stiffness, lane, from.stiffness);
    put(bound.damping, lane, from.damping);
    put(bound.position, lane, from.position - from_rotation);
    put(bound.speed, lane, from.speed);
    put(bound.lower, lane, from.lower - from_rotation);
    put(bound.upper, lane, from.upper - from_rotation);
  }
}

void fill_point(solve::PointPart& point, int lane, const BodyJoint& joint, const BodyPose& a,
                const BodyPose& b) {
  const Vec3 p_a = a.T * joint.T_a_joint.position(), p_b = b.T * joint.T_b_joint.position();
  put(point.start_arm_a, lane, p_a - a.centre);
  put(point.start_arm_b, lane, p_b - b.centre);
  put(point.start_separation, lane, p_b - p_a);
  put(point.impulse, lane, {joint.rows[0].impulse, joint.rows[1].impulse, joint.rows[2].impulse});
  put(point.rate, lane, joint.rows[0].rate);
  put(point.loss, lane, joint.rows[0].loss);
  put(point.relaxes, lane, joint.rows[0].relaxes ? 1.0 : 0.0);
}

void fill_axes(solve::AxesPart& axes, int lane, const BodyJoint& joint, const BodyPose& a,
               const BodyPose& b, double rotated) {
  const Mat3 R_a = a.T.rotation() * joint.T_a_joint.rotation();
  const Mat3 R_b = b.T.rotation() * joint.T_b_joint.rotation();
  put(axes.a_x, lane, R_a.cx);
  put(axes.a_y, lane, R_a.cy);
  put(axes.b_x, lane, R_b.cx);
  put(axes.b_z, lane, R_b.cz);
  put(axes.twist, lane, joint.rotated[0] - rotated);
  put(axes.cone_x, lane, joint.spec.swing_x);
  put(axes.cone_y, lane, joint.spec.swing_y);
}

template <class BLOCK>
void take_rows(const BLOCK& block, int lane, BodyJoint& joint) {
  constexpr int kPoint = BLOCK::kPointRows;
  if constexpr (kPoint > 0) {
    const Vec3 p = get(block.point.impulse, lane);
    joint.rows[0].impulse = p.x;
    joint.rows[1].impulse = p.y;
    joint.rows[2].impulse = p.z;
  }
  for (int i = kPoint; i < joint.count; ++i) {
    joint.rows[i].impulse = get(block.rows[i - kPoint].impulse, lane);
    if (i >= joint.locked) joint.rows[i].stop = get(block.bounds[i - kPoint].stop, lane);
  }
  joint.force = get(block.force, lane);
  joint.torque = get(block.torque, lane);
}

// The passes for a run.
const auto& passes_for(const JointRun<solve::BallBlock>&) {
  return solve::joint_passes().ball;
}
const auto& passes_for(const JointRun<solve::AxesBlock>&) {
  return solve::joint_passes().axes;
}
const auto& passes_for(const JointRun<solve::FrameBlock>&) {
  return solve::joint_passes().frames;
}
const auto& passes_for(const JointRun<solve::RowsBlock>&) {
  return solve::joint_passes().rows;
}

}  // namespace

// Whether the joint is in a block. Joints of sleeping bodies are not, and keep their impulses.
bool JointSteps::is_active(const BodyJoint& joint) const {
  const Body &a = context_.bodies[joint.a], &b = context_.bodies[joint.b];
  return joint.alive && !joint.in_rows && !(is_still(a) && is_still(b));
}

// Calls f(passes, run of at most kTile blocks), one colour after the other. The blocks of a colour
// run in parallel, except those that share bodies.
template <class F>
void JointSteps::for_runs(const F& f) {
  scratch_.runs.for_each([&](auto& run) {
    const auto& passes = passes_for(run);
    const auto part = [&](std::size_t begin, std::size_t end) {
      using Run = typename std::remove_cvref_t<decltype(passes)>::Run;
      for (std::size_t b = begin; b < end; b += kTile) {
        f(passes,
          Run{run.blocks.data() + b, std::min(kTile, end - b), &run.form, context_.states.data(),
              scratch_.motions.data(),
              static_cast<float>(kMaxJointCorrectionSpeed * context_.speed_unit), some_are_far_});
      }
    };
    if (run.alone) {
      part(0, run.blocks.size());
    } else {
      context_.workers.in_parallel(run.blocks.size(), kBlockGrain, part);
    }
  });
}

void JointSteps::fill(std::uint32_t index) {
  BodyJoint& joint = context_.joints[index];
  const solve::JointForm form = form_of(joint);
  const auto a = end_of(context_.bodies, joint.a), b = end_of(context_.bodies, joint.b);
  const auto add = [&]<class BLOCK>() {
    return scratch_.runs.add<BLOCK>(form, index, a.state, a.moves, b.state, b.moves);
  };
  if (joint.spec.form != JointSpec::Form::axes) {
    const auto [block, lane] = add.operator()<solve::RowsBlock>();
    return fill_rows(block, lane, joint, 0.0);
  }
  const BodyPose at_a = pose_of(context_.bodies[joint.a]), at_b = pose_of(context_.bodies[joint.b]);
  if (joint.holds_point() && form.rows == 0) {
    const auto [block, lane] = add.operator()<solve::BallBlock>();
    return fill_point(block.point, lane, joint, at_a, at_b);
  }
  count_revolutions(joint, at_a, at_b);
  const double rotated = revolutions_of(joint.rotated[0]);
  const auto fill = [&](auto& block, int lane) {
    fill_point(block.point, lane, joint, at_a, at_b);
    fill_axes(block.axes, lane, joint, at_a, at_b, rotated);
    fill_rows(block, lane, joint, rotated);
  };
  if (joint.holds_point()) {
    const auto [block, lane] = add.operator()<solve::AxesBlock>();
    fill(block, lane);
  } else {
    const auto [block, lane] = add.operator()<solve::FrameBlock>();
    fill(block, lane);
  }
}

JointSteps::JointSteps(const JointContext& context, JointScratch& scratch, double h)
    : context_(context), scratch_(scratch), h_(h) {
  const Bodies& bodies = context_.bodies;
  Joints& joints = context_.joints;
  scratch_.active.clear();
  scratch_.joined_bodies.clear();
  if (joints.empty()) return;
  scratch_.runs.clear(context_.states.size());
  for (std::uint32_t i = 0; i < joints.size(); ++i) {
    BodyJoint& joint = joints[i];
    if (i + kAhead < joints.size()) {
      const BodyJoint& next = joints[i + kAhead];
      prefetch_slot(bodies, next.a);
      prefetch_slot(bodies, next.b);
    }
    if (!is_active(joint)) continue;
    scratch_.active.push_back(i);
    if (joint.rows_sub_step != h) build_rows(joint, h);
    joint.rows_sub_step = h;
    fill(i);
  }
  if (empty()) return;
  scratch_.motions.resize(context_.states.size(),
                          solve::StepMotion{{0.0f, 0.0f, 0.0f, 1.0f}, {}, 0.0f});
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].first_joint != kNone && joins_sub_steps(bodies[i]))
      scratch_.joined_bodies.push_back(i);
  }
  prepare([](const auto& passes, const auto& run) { passes.load_inertias(run); },
          [](const auto&, const auto&) {});
}

BodyPose pose_within_step(const Body& body, const solve::BodyState& state,
                          const std::array<float, 6>& start_displacement) {
  if (body.motion == Motion::fixed) return pose_of(body);
  const float *displacement = state.displacement, *start = start_displacement.data();
  const auto since = [&](int i) { return vector_of(displacement + i) - vector_of(start + i); };
  const Vec3 centre = reference_point(body) + since(0);
  const Mat3 R = rotated(body.T.rotation(), since(3));
  const bool at_centre = body.motion == Motion::dynamic;
  return {SE3(R, at_centre ? centre - R * body.centre : centre), centre};
}
BodyPose JointSteps::pose_within_step(std::uint32_t body) const {
  return vp::pose_within_step(context_.bodies[body], context_.states[body + 1],
                              context_.start_displacements[body]);
}

// For rows that the SIMD passes do not evaluate.
void JointSteps::evaluate_rows(solve::RowsBlock& block) {
  JointEvaluation found;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (block.a.lane[lane] + block.b.lane[lane] == 2 * solve::kWorldState) return;  // empty
    BodyJoint& joint = context_.joints[block.joint.lane[lane]];
    const BodyPose b = pose_within_step(joint.b);
    evaluate(joint, pose_within_step(joint.a), b, found);
    for (int i = 0; i < joint.count; ++i) {
      const RowJacobian& J = found.jacobian[i];
      put(block.rows[i].residual, lane, found.residual[i]);
      put(block.jacobian[i].linear_a, lane, J.linear_a);
      put(block.jacobian[i].angular_a, lane, J.angular_a);
      put(block.jacobian[i].linear_b, lane, J.linear_b);
      put(block.jacobian[i].angular_b, lane, J.angular_b);
    }
    const bool user = joint.spec.form == JointSpec::Form::user;
    put(block.anchor, lane, user ? Vec3{} : b.T * joint.T_b_joint.position() - b.centre);
  }
}

// Calls before and after with the passes and blocks that it prepares. Until it returns, some_far of
// a run is that of the last time: `after` may not read it.
template <class Before, class After>
void JointSteps::prepare(const Before& before, const After& after) {
  context_.workers.in_parallel(
      scratch_.joined_bodies.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        solve::joint_passes().find_step_motions(
            context_.states.data(), context_.start_displacements.data(),
            scratch_.joined_bodies.data() + begin, end - begin, scratch_.motions.data());
      });
  std::atomic<bool> far = false;
  for_runs([&](const auto& passes, const auto& run) {
    before(passes, run);
    if constexpr (std::is_same_v<decltype(run.blocks), solve::RowsBlock*>) {
      for (std::size_t i = 0; i < run.count; ++i) evaluate_rows(run.blocks[i]);
    }
    if (passes.prepare(run)) far.store(true, std::memory_order_relaxed);
    after(passes, run);
  });
  some_are_far_ = far;
}
void JointSteps::warm_start() {
  if (empty()) return;
  for_runs([](const auto& passes, const auto& run) { passes.warm_start(run); });
}
void JointSteps::solve(int iteration) {
  if (empty()) return;
  for_runs([&](const auto& passes, const auto& run) {
    (iteration == 0 ? passes.solve_first : passes.solve_again)(run, static_cast<float>(h_));
  });
}
void JointSteps::prepare_and_relax() {
  if (empty()) return;
  prepare([](const auto&, const auto&) {},
          [&](const auto& passes, const auto& run) { passes.relax(run, static_cast<float>(h_)); });
}

// Whether a hard constraint of the joint is open by more than kMaxJointSeparation times the smaller
// body's radius, or by more than kRotationError. Tests only errors whose bias velocity has reached
// its limit. A gear and a user constraint have no size to compare with.
template <class BLOCK>
bool JointSteps::is_far_open(const BodyJoint& joint, const BLOCK& block, int lane) const {
  constexpr float kAtLimit = 0.999f;
  if (joint.spec.form == JointSpec::Form::gear || joint.spec.form == JointSpec::Form::user)
    return false;
  const auto exceeds = [&](int row, double fastest) {
    return std::fabs(block.bias[row].lane[lane]) >= kAtLimit * static_cast<float>(fastest);
  };
  double size = 1e30;
  const auto find_size = [&](std::uint32_t index, const SE3& T_body_joint) {
    const Body& body = context_.bodies[index];
    if (body.motion != Motion::dynamic) return;
    size =
        std::min(size, std::max(body.bounding_radius, norm(T_body_joint.position() - body.centre)));
  };
  const auto is_open = [&](double separation) {
    find_size(joint.a, joint.T_a_joint);
    find_size(joint.b, joint.T_b_joint);
    return separation > kMaxJointSeparation * size;
  };
  const double fastest = kMaxJointCorrectionSpeed * context_.speed_unit;
  constexpr int kPoint = BLOCK::kPointRows;
  if (kPoint > 0 && joint.rows[0].relaxes &&
      (exceeds(0, fastest) || exceeds(1, fastest) || exceeds(2, fastest))) {
    const SE3 T_a = pose_within_step(joint.a).T, T_b = pose_within_step(joint.b).T;
    if (is_open(norm(T_b * joint.T_b_joint.position() - T_a * joint.T_a_joint.position())))
      return true;
  }
  for (int i = kPoint; i < joint.locked; ++i) {
    const BodyJointRow& row = joint.rows[i];
    const bool linear = joint.spec.form == JointSpec::Form::distance || row.slot < solve::kSwingX;
    if (!row.relaxes || !exceeds(i, linear ? fastest : double{solve::kMaxAngularBias})) continue;
    const double error = std::fabs(get(block.rows[i - kPoint].residual, lane));
    if (linear ? is_open(error) : error > kRotationError) return true;
  }
  return false;
}

bool JointSteps::end(double dt) {
  if (empty()) return false;
  bool some_are_far_open = false;
  scratch_.runs.for_each([&](const auto& run) {
    const std::uint32_t each = run.alone ? 1 : std::uint32_t{kLanes};
    for (std::uint32_t i = 0; i < run.lanes; ++i) {
      const auto& block = run.blocks[i / each];
      const int lane = static_cast<int>(i % each);
      BodyJoint& joint = context_.joints[block.joint.lane[lane]];
      take_rows(block, lane, joint);
      if (some_are_far_ && !some_are_far_open) some_are_far_open = is_far_open(joint, block, lane);
      joint.force *= 1.0 / dt;
      joint.torque *= 1.0 / dt;
      if (!in_range(joint.force) || !in_range(joint.torque)) joint.force = joint.torque = {};
      if constexpr (std::is_same_v<decltype(block.axes), solve::AxesPart>) {
        const double rotated = revolutions_of(joint.rotated[0]) + get(block.axes.twist, lane);
        if (in_range(rotated)) joint.rotated[0] = rotated;  // else the bodies are restored
      }
    }
  });
  return some_are_far_open;
}

}  // namespace vp
