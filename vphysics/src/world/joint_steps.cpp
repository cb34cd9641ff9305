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
constexpr std::size_t kAhead = 6;  // joints, which are requested ahead of their use
// Cache lines of a joint: those with its impulses, and all that a ball joint needs.
constexpr std::size_t kImpulseLines = 3, kJointLines = 7;

// The nearest multiple of 2 pi.
double revolutions_of(double angle) {
  return 2.0 * kPi * std::floor(angle / (2.0 * kPi) + 0.5);
}

// rotated: full revolutions [rad] that are subtracted from the coordinate of a twist.
template <class BLOCK>
void fill_rows(BLOCK& block, int lane, const BodyJoint& joint, double rotated) {
  constexpr int kPoint = BLOCK::kPointRows;
  for (int i = kPoint; i < joint.count; ++i) {
    const BodyJointRow& from = joint.rows[i];
    solve::RowPart& row = block.rows[i - kPoint];
    put(row.impulse, lane, joint.impulse[i]);
    put(row.rate, lane, from.rate);
    put(row.loss, lane, from.loss);
    put(row.relaxes, lane, from.relaxes ? 1.0 : 0.0);
    if (i < joint.locked) continue;
    solve::BoundPart& bound = block.bounds[i - kPoint];
    const double from_rotation = from.slot == solve::kTwist ? rotated : 0.0;
    put(bound.stop, lane, joint.stop[i]);
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
  put(point.impulse, lane, {joint.impulse[0], joint.impulse[1], joint.impulse[2]});
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
    joint.impulse[0] = p.x;
    joint.impulse[1] = p.y;
    joint.impulse[2] = p.z;
  }
  joint.force = get(block.force, lane);
  if constexpr (BLOCK::kOtherRows > 0) {
    for (int i = kPoint; i < joint.count; ++i) {
      joint.impulse[i] = get(block.rows[i - kPoint].impulse, lane);
      if (i >= joint.locked) joint.stop[i] = get(block.bounds[i - kPoint].stop, lane);
    }
    joint.torque = get(block.torque, lane);
  }
}

// The passes over blocks of a kind.
const auto& passes_for(std::span<solve::BallBlock>) {
  return solve::joint_passes().ball;
}
const auto& passes_for(std::span<solve::AxesBlock>) {
  return solve::joint_passes().axes;
}
const auto& passes_for(std::span<solve::FrameBlock>) {
  return solve::joint_passes().frames;
}
const auto& passes_for(std::span<solve::RowsBlock>) {
  return solve::joint_passes().rows;
}

}  // namespace

// Whether the joint is in a block. Joints of sleeping bodies are not, and keep their impulses.
bool JointSteps::is_active(const BodyJoint& joint) const {
  const auto moves = [&](std::uint32_t body) {
    return context_.bodies[body].motion == Motion::dynamic && !context_.bodies[body].asleep;
  };
  return joint.alive && !joint.in_rows && (moves(joint.a) || moves(joint.b));
}

JointSteps::JointSteps(const JointContext& context, JointScratch& scratch, double h)
    : context_(context), scratch_(scratch), h_(h) {
  const Bodies& bodies = context_.bodies;
  Joints& joints = context_.joints;
  if (joints.empty()) return;
  scratch_.runs.clear(context_.states.size(), context_.regions);
  for (std::uint32_t i = 0; i < joints.size(); ++i) {
    BodyJoint& joint = joints[i];
    if (i + 2 * kAhead < joints.size()) prefetch(joints[i + 2 * kAhead], 2);
    if (i + kAhead < joints.size()) {
      const BodyJoint& next = joints[i + kAhead];
      prefetch_slot(bodies, next.a);
      prefetch_slot(bodies, next.b);
    }
    if (!is_active(joint)) continue;
    if (joint.rows_sub_step != h) build_rows(joint, h);
    joint.rows_sub_step = h;
    scratch_.runs.add(joint.block, joint.form, i, end_of(bodies, joint.a), end_of(bodies, joint.b));
    is_empty_ = false;
  }
  if (empty()) return;
  scratch_.runs.lay_out();
  scratch_.motions.resize(context_.states.size(),
                          solve::StepMotion{{0.0f, 0.0f, 0.0f, 1.0f}, {}, 0.0f});
  scratch_.some_far.assign(context_.regions, 1);
}

// Calls f(passes, at most kTile blocks as the passes take them, their first block, the run), one
// colour after the other. In kSharedRegion the blocks of a colour run in parallel, except those
// that share bodies.
template <class F>
void JointSteps::for_parts_of(std::size_t region, const F& f) {
  scratch_.runs.for_each(region, [&](const auto& run) {
    const auto& passes = passes_for(run.blocks);
    const auto part = [&](std::size_t begin, std::size_t end) {
      using Run = typename std::remove_cvref_t<decltype(passes)>::Run;
      for (std::size_t b = begin; b < end; b += kTile) {
        f(passes,
          Run{&run.blocks[b], std::min(kTile, end - b), &run.form, context_.states.data(),
              scratch_.motions.data(),
              static_cast<float>(kMaxJointCorrectionSpeed * context_.speed_unit),
              scratch_.some_far[region] != 0},
          b, run);
      }
    };
    if (run.alone || region != solve::kSharedRegion) {
      part(0, run.blocks.size());
    } else {
      context_.workers.in_parallel(run.blocks.size(), kBlockGrain, part);
    }
  });
}

template <class BLOCK>
void JointSteps::fill_lane(BLOCK& block, int lane, const JointLane& from) {
  BodyJoint& joint = context_.joints[from.joint];
  block.a.lane[lane] = from.state_a;
  block.b.lane[lane] = from.state_b;
  block.joint.lane[lane] = from.joint;
  if constexpr (!BLOCK::kAxes) {
    fill_rows(block, lane, joint, 0.0);
  } else {
    const BodyPose a = pose_of(context_.bodies[joint.a]), b = pose_of(context_.bodies[joint.b]);
    fill_point(block.point, lane, joint, a, b);
    if constexpr (BLOCK::kOtherRows > 0) {
      count_revolutions(joint, a, b);
      const double rotated = revolutions_of(joint.rotated[0]);
      fill_axes(block.axes, lane, joint, a, b, rotated);
      fill_rows(block, lane, joint, rotated);
    }
  }
}

// Before the lane i of a run is read.
void JointSteps::request(std::span<const JointLane> lanes, std::size_t i) const {
  if (i + 2 * kAhead < lanes.size())
    prefetch(context_.joints[lanes[i + 2 * kAhead].joint], kJointLines);
  if (i + kAhead >= lanes.size()) return;
  for (const std::uint32_t state : {lanes[i + kAhead].state_a, lanes[i + kAhead].state_b}) {
    if (state != solve::kWorldState) prefetch_slot(context_.bodies, state - 1);
  }
}

template <class BLOCK>
void JointSteps::fill(BLOCK& block, const JointRun<BLOCK>& run, std::size_t index) {
  const JointRange range = run.lanes_of(index);
  if (range.count < kLanes) {
    block = {};  // empty lanes refer to kWorldState
  } else {
    block.force = {};
    if constexpr (BLOCK::kOtherRows > 0) block.torque = {};
  }
  for (std::size_t i = 0; i < range.count; ++i) {
    request(run.lanes, range.first + i);
    fill_lane(block, static_cast<int>(i), run.lanes[range.first + i]);
  }
}

void JointSteps::begin(std::size_t region) {
  if (empty()) return;
  prepare(region, [&](const auto& passes, const auto& part, std::size_t first, const auto& run) {
    for (std::size_t i = 0; i < part.count; ++i) fill(part.blocks[i], run, first + i);
    passes.load_masses(part);
    evaluate_rows(part);
    return passes.prepare(part);
  });
}

BodyPose pose_within_step(const Body& body, const solve::BodyState& state,
                          const solve::StartDisplacement& start_displacement) {
  if (body.motion == Motion::fixed) return pose_of(body);
  const float *displacement = state.displacement, *start = start_displacement.displacement;
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

// Residuals and Jacobians that the SIMD passes do not evaluate.
template <class Part>
void JointSteps::evaluate_rows(const Part& part) {
  if constexpr (std::is_same_v<Part, solve::JointPasses<solve::RowsBlock>::Run>) {
    for (std::size_t i = 0; i < part.count; ++i) evaluate_block(part.blocks[i]);
  }
}
void JointSteps::evaluate_block(solve::RowsBlock& block) {
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

// Calls f(passes, part, its first block, run), which prepares a part and returns whether some of
// its joints are far.
template <class F>
void JointSteps::prepare(std::size_t region, const F& f) {
  const std::span<const std::uint32_t> bodies = scratch_.runs.bodies_of(region);
  const auto find_motions = [&](std::size_t begin, std::size_t end) {
    solve::joint_passes().find_step_motions(
        context_.states.data(), context_.start_displacements.data(), bodies.data() + begin,
        end - begin, scratch_.motions.data());
  };
  if (region != solve::kSharedRegion) {
    find_motions(0, bodies.size());
  } else {
    context_.workers.in_parallel(bodies.size(), kBodyGrain, find_motions);
  }
  std::atomic<bool> far = false;
  for_parts_of(region, [&](const auto&... of) {
    if (f(of...)) far.store(true, std::memory_order_relaxed);
  });
  scratch_.some_far[region] = far ? 1 : 0;
}
void JointSteps::warm_start(std::size_t region) {
  if (empty()) return;
  for_parts_of(region, [](const auto& passes, const auto& part, std::size_t, const auto&) {
    passes.warm_start(part);
  });
}
void JointSteps::solve(std::size_t region, int iteration) {
  if (empty()) return;
  for_parts_of(region, [&](const auto& passes, const auto& part, std::size_t, const auto&) {
    (iteration == 0 ? passes.solve_first : passes.solve_again)(part, static_cast<float>(h_));
  });
}
void JointSteps::prepare_and_relax(std::size_t region) {
  if (empty()) return;
  const bool precess = context_.precession.concerns(region);
  prepare(region, [&](const auto& passes, const auto& part, std::size_t, const auto&) {
    if (precess) passes.load_inertias(part);
    evaluate_rows(part);
    const bool some_far = passes.prepare(part);
    passes.relax(part, static_cast<float>(h_));
    return some_far;
  });
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
  if constexpr (BLOCK::kOtherRows == 0) return false;
  for (int i = kPoint; i < joint.locked; ++i) {
    const BodyJointRow& row = joint.rows[i];
    const bool linear = joint.spec.form == JointSpec::Form::distance || row.slot < solve::kSwingX;
    if (!row.relaxes || !exceeds(i, linear ? fastest : double{solve::kMaxAngularBias})) continue;
    const double error = std::fabs(get(block.rows[i - kPoint].residual, lane));
    if (linear ? is_open(error) : error > kRotationError) return true;
  }
  return false;
}

template <class BLOCK>
void JointSteps::take(const BLOCK& block, int lane, double dt, bool some_far) {
  BodyJoint& joint = context_.joints[block.joint.lane[lane]];
  take_rows(block, lane, joint);
  if (some_far && !some_are_far_open_ && is_far_open(joint, block, lane)) some_are_far_open_ = true;
  joint.force *= 1.0 / dt;
  joint.torque *= 1.0 / dt;
  if (!in_range(joint.force) || !in_range(joint.torque)) joint.force = joint.torque = {};
  if constexpr (std::is_same_v<decltype(block.axes), solve::AxesPart>) {
    const double rotated = revolutions_of(joint.rotated[0]) + get(block.axes.twist, lane);
    if (in_range(rotated)) joint.rotated[0] = rotated;  // else the bodies are restored
  }
}

void JointSteps::end(std::size_t region, double dt) {
  if (empty()) return;
  const bool some_far = scratch_.some_far[region] != 0;
  for_parts_of(region, [&](const auto&, const auto& part, std::size_t first, const auto& run) {
    for (std::size_t block = 0; block < part.count; ++block) {
      const JointRange range = run.lanes_of(first + block);
      for (std::size_t i = 0; i < range.count; ++i) {
        if (range.first + i + kAhead < run.lanes.size())
          prefetch(context_.joints[run.lanes[range.first + i + kAhead].joint], kImpulseLines);
        take(part.blocks[block], static_cast<int>(i), dt, some_far);
      }
    }
  });
}

}  // namespace vp
