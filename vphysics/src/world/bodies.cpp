// Between bodies and the rows of the sub-stepped solver.
//
// A body that no lane holds falls freely: it is moved here, in double. So that it falls as it would
// in n sub-steps h = dt / n of semi-implicit Euler, it goes by  dt v + a dt^2 (n + 1) / (2 n).
#include <algorithm>
#include <cmath>

#include "solve/row_vector.h"
#include "world/free_turn.h"
#include "world/impl.h"
#include "world/validate.h"

namespace vp {
namespace {

// An enlarged bound's margin, in sizes of the collider; larger ones are left less often and
// overlap more neighbours.
constexpr double kMargin = 0.1;
// A row's way begins again at zero beyond this [length units], and so many more steps of it, so
// that single precision tells small steps; and beyond this turn [rad], since turns are added up as
// vectors.
constexpr float kFarWay = 0.0625f, kFarSteps = 8.0f, kFarTurn = 0.25f;

// Half a margin of the least collider is within all enlarged bounds (update_bounds). Sums of
// components, no less than the lengths, will do.
bool stays_within_bounds(const Body& body, const solve::BodyRow& row, float dt) {
  const float *at = body.bounded_at, *way = row.way, *velocity = row.velocity;
  const auto gone = [&](int i) { return std::fabs(way[i] - at[i]) + dt * std::fabs(velocity[i]); };
  const float linear = gone(0) + gone(1) + gone(2), turned = gone(3) + gone(4) + gone(5);
  return static_cast<double>(linear) + body.reach * static_cast<double>(turned) <
         0.5 * kMargin * body.least_size;
}
// Of all that a collider passes in a step.
collide::Bounds bounds_along(const collide::Bounds& b, const Vec3& way, double more) {
  const collide::Bounds end{b.lower + way, b.upper + way};
  return grown(merged(b, end), more);
}

// The rotation nearest to one that rounding has worn: a step of Newton's method, M (3 - M^T M) / 2,
// which unlike Gram and Schmidt's way turns nothing.
Mat3 straightened(const Mat3& M) {
  const Vec3 &x = M.cx, &y = M.cy, &z = M.cz;
  const double xy = 0.5 * dot(x, y), yz = 0.5 * dot(y, z), zx = 0.5 * dot(z, x);
  return {(1.5 - 0.5 * dot(x, x)) * x - xy * y - zx * z,
          (1.5 - 0.5 * dot(y, y)) * y - xy * x - yz * z,
          (1.5 - 0.5 * dot(z, z)) * z - zx * x - yz * y};
}

Mat3 turned_nearly(const Mat3& R, const Vec3& t) {
  const double tt = dot(t, t);
  if (tt > 1e-3) return orthonormalized(Exp(t).matrix() * R);
  const double s = 1.0 - tt * (1.0 / 6.0 - tt * (1.0 / 120.0 - tt * (1.0 / 5040.0)));
  const double c = 0.5 - tt * (1.0 / 24.0 - tt * (1.0 / 720.0));
  const Vec3 st = s * t, ct = c * t;
  const double xy = ct.x * t.y, yz = ct.y * t.z, zx = ct.z * t.x, rest = 1.0 - c * tt;
  return Mat3{{rest + ct.x * t.x, xy + st.z, zx - st.y},
              {xy - st.z, rest + ct.y * t.y, yz + st.x},
              {zx + st.y, yz - st.x, rest + ct.z * t.z}} *
         R;
}

// Rounding adds up over thousands of steps; two of its six errors tell when it is enough.
bool is_worn(const Mat3& R) {
  constexpr double kWorn = 1e-13;
  return std::fabs(dot(R.cx, R.cx) - 1.0) + std::fabs(dot(R.cy, R.cz)) > kWorn;
}

}  // namespace

Turned turned_freely(const Body& body, double h, const Vec3& more_w) {
  const Mat3& R = body.T.rotation();
  const Vec3 w = transposed_times(R, body.w), L = R * (body.central * w);
  const Vec3 mean = more_w == Vec3{} ? w : transposed_times(R, body.w + more_w);
  const FreeTurn turn = free_turn(body.central, body.inverse_central, mean, h);
  Mat3 next = R * from_quaternion(turn.q);
  next = straightened(next);
  // What stays to rounding is the angular momentum of the world's frame.
  return {next, next * (body.inverse_central * transposed_times(next, L))};
}

Vec3 rate_at(const Body& body, const Mat3& R) {
  const Mat3& before = body.T.rotation();
  const Vec3 was = transposed_times(before, body.w), is = transposed_times(R, body.w);
  const bool more = dot(is, body.central * is) > dot(was, body.central * was);
  return more ? R * was : body.w;
}

// R after a small turn by the vector t: Rodrigues' formula with its coefficients to sixth order,
// exact to rounding for turns of a step; larger ones take the long way.
Mat3 turned(const Mat3& R, const Vec3& t) {
  return straightened(turned_nearly(R, t));
}

void place(Body& body, const Vec3& reference, const Mat3& R) {
  const bool at_centre = body.motion == Motion::dynamic && !body.is_link;
  body.T = SE3(R, at_centre ? reference - R * body.centre : reference);
  body.moved();
}

bool may_meet(const Body& a, const Body& b) {
  if (!(a.categories & b.masks) || !(b.categories & a.masks)) return false;
  if (a.is_link && a.articulation == b.articulation) return false;
  const bool pushable = a.motion == Motion::dynamic || b.motion == Motion::dynamic;
  return pushable || a.has_sensor || b.has_sensor;
}

solve::ContactGraph::End end_of(const Bodies& bodies, std::uint32_t body) {
  const Body& b = bodies[body];
  if (b.motion == Motion::fixed) return {solve::kWorldRow, false, solve::kBetween};
  return {body + 1, b.motion == Motion::dynamic, b.region};
}

bool BodyLists::refresh(const Bodies& bodies) {
  if (!stale_) return false;
  stale_ = false;
  movers.clear();
  links.clear();
  some_continuous = some_sub_stepped = some_sleep = false;
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (!body.alive) continue;
    if (body.is_link) {
      if (body.first_collider != kNone) links.push_back(i);
    } else if (body.asleep) {
      some_sleep = true;
    } else if (body.motion != Motion::fixed) {
      movers.push_back(i);
      (body.continuous ? some_continuous : some_sub_stepped) = true;
    }
  }
  return true;
}

void World::Impl::list_bodies() {
  if (!lists.refresh(bodies)) return;
  swept_body_pairs.forget();
  regions.sort(bodies, lists.movers);
  list_remote_articulations();
  discrete_body_pairs.list_filters(bodies);
  reserve_link_rows();
}

namespace {

// What makes of its rate in dt that of a free body, as seen from the body: where it is in the
// solver, at the start of the step, its energy stays.
Vec3 gyroscopic_acceleration(const Body& body, double dt) {
  if (body.isotropic || hardly_turns(body.w, dt)) return {};
  const Mat3& R = body.T.rotation();
  const Vec3 w = transposed_times(R, body.w);
  const FreeTurn turn = free_turn(body.central, body.inverse_central, w, dt);
  return R * ((1.0 / dt) * (turn.w - w));
}

}  // namespace

// True if its way has become so long that it must begin again.
bool World::Impl::load_row(std::uint32_t index, double dt) {
  Body& body = bodies[index];
  body.untouched = false;
  solve::BodyRow& row = body_rows[index + 1];
  const bool pushed = body.motion == Motion::dynamic;
  put(row.velocity, body.v);
  put(row.velocity + 3, body.w);
  row.velocity[solve::kInverseMass] = pushed ? static_cast<float>(body.inverse_mass) : 0.0f;
  row.velocity[solve::kFalls] = pushed && !body.rested && body.first_joint == kNone ? 1.0f : 0.0f;
  row.inertia[solve::kKeepLinear] = row.inertia[solve::kKeepAngular] = 1.0f;
  if (pushed && (body.linear_damping > 0.0 || body.angular_damping > 0.0)) {
    const double h = dt / sub_steps_in(desc, speed_unit, dt);
    row.inertia[solve::kKeepLinear] = static_cast<float>(1.0 / (1.0 + h * body.linear_damping));
    row.inertia[solve::kKeepAngular] = static_cast<float>(1.0 / (1.0 + h * body.angular_damping));
  }
  row.way[solve::kCarried] = 0.0f;
  row.way[solve::kShareLessOne] = 0.0f;
  if (pushed && body.lanes > kCrowd)
    row.way[solve::kShareLessOne] =
        static_cast<float>(kCrowd / static_cast<double>(body.lanes) - 1.0);
  const float* way = row.way;
  if (!pushed) {
    std::fill(std::begin(row.rate), std::end(row.rate), 0.0f);
    std::fill_n(row.inertia, 6, 0.0f);
  } else {
    const Sym3 I =
        body.isotropic ? body.inverse_central : rotated(body.T.rotation(), body.inverse_central);
    const double inertia[6] = {I.xx, I.yy, I.zz, I.xy, I.yz, I.zx};
    for (int i = 0; i < 6; ++i) row.inertia[i] = static_cast<float>(inertia[i]);
    const Velocity a = acceleration_of(body);
    put(row.rate, a.v);
    const Vec3 gyroscopic = gyroscopic_acceleration(body, dt);
    put(row.rate + 3, loads.is_torqued(body) ? gyroscopic + a.w : gyroscopic);
  }
  std::copy_n(way, 6, start_ways[index].begin());
  const float* v = row.velocity;
  const float speed = std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
  const float far =
      kFarWay * static_cast<float>(desc.length_unit) + kFarSteps * static_cast<float>(dt) * speed;
  const auto beyond = [way](int first, float limit) {
    return std::any_of(way + first, way + first + 3,
                       [limit](float x) { return !(std::fabs(x) <= limit); });  // NaN too
  };
  return beyond(0, far) || beyond(3, kFarTurn);
}

// Contacts that have points are looked at again; of the others the clearance becomes less by what
// has been used of it.
void World::Impl::start_way_anew(std::uint32_t index) {
  const auto for_near = [&](const auto& f) {
    contact_store.for_each_of(bodies[index], [&](std::uint32_t contact, const Contact& c) {
      if (!c.stale && !c.parked && !c.of_link && c.place.points == 0) f(contact, c);
    });
  };
  for_near([&](std::uint32_t, const Contact& c) { contact_store.use_clearance(c, body_set); });
  std::fill_n(body_rows[index + 1].way, 6, 0.0f);
  std::fill_n(start_ways[index].begin(), 6, 0.0f);
  std::fill_n(bodies[index].bounded_at, 6, 1e9f);
  for_near([&](std::uint32_t contact, const Contact& c) {
    const double left = contact_store.clearance(c);
    if (left > 0.0) return contact_store.set_clearance(c, left, body_set);
    contact_store.reset_near(c, body_set);
    contact_store.mark_stale(contact);
  });
  contact_store.for_each_of(bodies[index], [&](std::uint32_t contact, const Contact& c) {
    if (c.place.points > 0 || c.sensor || c.of_link || c.parked) contact_store.mark_stale(contact);
  });
}

void World::Impl::load_rows(double dt) {
  constexpr std::uint8_t kFar = 1, kLeaves = 2, kPulled = 4;
  mover_news.resize(lists.movers.size());
  workers.in_parallel(lists.movers.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = lists.movers[k];
      Body& body = bodies[i];
      if (body.motion == Motion::kinematic) prescribe_velocity(body, dt);
      const bool far = load_row(i, dt);
      const bool stays = joins_sub_steps(body) &&
                         stays_within_bounds(body, body_rows[i + 1], static_cast<float>(dt));
      const bool pulled = !(approach_in(dt).pull_of(body) == Velocity{});
      mover_news[k] = static_cast<std::uint8_t>((far ? kFar : 0) | (pulled ? kPulled : 0) |
                                                (far || !stays ? kLeaves : 0));
    }
  });
  for (std::size_t k = 0; k < lists.movers.size(); ++k) {
    if (mover_news[k] == 0) continue;
    const std::uint32_t i = lists.movers[k];
    if ((mover_news[k] & kFar) != 0) start_way_anew(i);
    if ((mover_news[k] & kPulled) != 0) contact_store.mark_stale_of(bodies[i]);
    if (bodies[i].first_collider != kNone) update_bounds(i, dt, joins_sub_steps(bodies[i]));
  }
}

void World::Impl::update_bounds_of_links(double dt) {
  for (const std::uint32_t i : lists.links) update_bounds(i, dt, false);
}

// Gives the broad phase the bounds of what may have left its enlarged ones.
void World::Impl::update_bounds(std::uint32_t index, double dt, bool by_rows) {
  Body& body = bodies[index];
  pose_colliders(bodies[index], colliders);
  const Velocity pull = approach_in(dt).pull_of(body);
  const double turn = dt * (norm(body.w) + norm(pull.w));
  const Vec3 reference = reference_point(body);
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    const Collider& collider = colliders[c];
    // Its centre goes along an arc, which leaves its tangent by half of the square of the turn.
    const Vec3 arm = body.T * collider.centre - reference;
    const Vec3 way = dt * (body.v + cross(body.w, arm));
    const double own = collider.geometry.kind == collide::Kind::sphere ? 0.0 : collider.radius;
    const double more = turn * own + 0.5 * turn * turn * norm(arm) + desc.contact_slop;
    // Half of the margin is left now, whether the enlarged bounds are new or those of before.
    const double half = 0.5 * kMargin * collider.size;
    const Vec3 pulled = dt * (pull.v + cross(pull.w, arm));
    const collide::Bounds start = bounds_along(collider.bounds, pulled, 0.0);
    finder.set_bounds(collider.proxy, bounds_along(start, way, more + half), half,
                      2.0 * (way + pulled));
  }
  if (by_rows) std::copy_n(body_rows[index + 1].way, 6, body.bounded_at);
}

// Whether nothing has changed how it turns, though lanes hold it. Then it turns freely, in double,
// and its way becomes that.
bool World::Impl::leave_untouched(std::uint32_t index, double dt) {
  Body& body = bodies[index];
  solve::BodyRow& row = body_rows[index + 1];
  if (!body.tumbles() || body.first_joint != kNone || body.on_link) return false;
  if (loads.is_torqued(body)) return false;
  if (hardly_turns(body.w, dt)) return false;
  const float h = static_cast<float>(dt / sub_steps_taken);
  float w[3];
  put(w, body.w);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < sub_steps_taken; ++k) w[i] += h * row.rate[3 + i];
    if (w[i] != row.velocity[3 + i]) return false;
  }
  const Mat3& R = body.T.rotation();
  const FreeTurn turn =
      free_turn(body.central, body.inverse_central, transposed_times(R, body.w), dt);
  put(row.way + 3, vector_of(start_ways[index].data() + 3) + R * constant_turn(turn));
  return body.untouched = true;
}

// After the sub-steps: the velocities of a dynamic body become those of the end of the step.
// Returns what its mean velocities over the step have more.
Velocity World::Impl::settle(std::uint32_t index, double dt) {
  Body& body = bodies[index];
  solve::BodyRow& row = body_rows[index + 1];
  body.rested = row.way[solve::kCarried] > 0.0f;
  Velocity more;
  if (!body.by_rows()) {
    const double half = 0.5 * dt * (1.0 + 1.0 / sub_steps_taken);
    const Vec3 v = body.v, w = body.w;
    const Velocity a = acceleration_of(body);
    const bool torqued = loads.is_torqued(body);
    body.v = (v + dt * a.v) * (1.0 / (1.0 + dt * body.linear_damping));
    if (torqued) body.w += dt * a.w;
    body.w *= 1.0 / (1.0 + dt * body.angular_damping);
    more.v = v + half * a.v - body.v;
    if (torqued) more.w = w + half * a.w - body.w;
    return more;
  }
  const float* start = start_ways[index].data();
  body.v = vector_of(row.velocity);
  const double per_step = 1.0 / dt;
  more.v = per_step * (vector_of(row.way) - vector_of(start)) - body.v;
  if (!leave_untouched(index, dt)) {
    body.w = vector_of(row.velocity + 3);
    more.w = per_step * (vector_of(row.way + 3) - vector_of(start + 3)) - body.w;
  }
  if (!in_range(body.v) || !in_range(body.w) || !in_range(more.v) || !in_range(more.w)) {
    status.non_finite = true;
    body.v = body.w = {};
    more = {};
    lost_bodies.push_back(index);
  }
  return more;
}

// When all have been settled by what their rows and lanes held: then no order decides who is lost,
// and no way that is no number gets into a contact that is kept.
void World::Impl::forget_lost_bodies() {
  for (const std::uint32_t i : lost_bodies) {
    std::fill_n(body_rows[i + 1].way, 6, 0.0f);
    std::fill_n(bodies[i].bounded_at, 6, 1e9f);
  }
  for (const std::uint32_t i : lost_bodies) {
    forget_contacts(i);
    forget_joints(bodies[i], joints);
  }
  lost_bodies.clear();
}

// The same, and its pose, of a dynamic body that its row leads; false if it flies out of range.
bool World::Impl::advance_by_row(std::uint32_t index, double dt) {
  Body& body = bodies[index];
  const solve::BodyRow& row = body_rows[index + 1];
  const float* start = start_ways[index].data();
  const Vec3 v = vector_of(row.velocity), w = vector_of(row.velocity + 3);
  const Vec3 gone = vector_of(row.way) - vector_of(start),
             turn = vector_of(row.way + 3) - vector_of(start + 3);
  const Vec3 x = body.T * body.centre + gone;
  if (!in_range(v) || !in_range(w) || !in_range(x) || !in_range(turn)) return false;
  body.rested = row.way[solve::kCarried] > 0.0f;
  body.v = v;
  Mat3 R;
  if (leave_untouched(index, dt)) {
    const Turned free = turned_freely(body, dt);
    R = free.R;
    body.w = free.w;
  } else {
    R = turned_nearly(body.T.rotation(), turn);
    if (is_worn(R)) R = straightened(R);
    body.w = w;
    if (!body.isotropic && !hardly_turns(w, dt)) body.w = rate_at(body, R);
  }
  body.T = SE3(R, x - R * body.centre);
  body.moved();
  return true;
}

// What its lanes hold is no good to start from.
void World::Impl::forget_contacts(std::uint32_t body) {
  contact_store.for_each_of(bodies[body], [&](std::uint32_t index, const Contact& c) {
    contact_store.mark_stale(index);
    if (c.is_part()) {
      contact_store.forget_part(index, body_set);
    } else if (c.place.points > 0) {
      contact_store.take_out_of_lane(index, body_set);
      contact_store.set_near(index, 0.0, body_set);
    } else if (!c.parked) {
      contact_store.reset_near(c, body_set);
    }
  });
}

// Put elsewhere by the user.
void World::Impl::jumped(std::uint32_t index) {
  ready_for_queries = false;
  Body& body = bodies[index];
  wake(index);
  wake_neighbours(index);
  contact_store.mark_stale_of(bodies[index]);
  std::fill_n(body.bounded_at, 6, 1e9f);
  if (body.motion != Motion::fixed) return;
  swept_body_pairs.forget();
  pose_colliders(bodies[index], colliders);
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    finder.set_bounds(colliders[c].proxy, colliders[c].bounds, kMargin * colliders[c].size);
  }
}

void World::Impl::add_proxy(std::uint32_t index) {
  ready_for_queries = false;
  Collider& collider = colliders[index];
  Body& body = bodies[collider.body];
  pose_colliders(body, colliders);
  collide::ProxyDesc proxy;
  proxy.bounds = collider.bounds;
  proxy.mobility =
      body.motion == Motion::fixed ? collide::Mobility::fixed : collide::Mobility::moving;
  // Continuous bodies look for others themselves (pairs.cpp).
  proxy.category = body.continuous ? 0 : collider.filter.category;
  proxy.mask = body.continuous ? 0 : collider.filter.mask;
  proxy.owner = body.is_link ? 0x80000000u + body.articulation : collider.body;
  proxy.user = index;
  proxy.margin = kMargin * collider.size;
  collider.proxy = finder.add(proxy);
}

}  // namespace vp
