// Which contacts there are, and their geometry.
//
//   broad phase    new pairs become contacts; those whose enlarged bounds have parted are dropped
//   stale ones     those that may have moved by more than a little since they were looked at
//   narrow phase   for these alone; the rest keep their lanes, whose separations follow the bodies'
//                  ways (contact_block.h)
#include <algorithm>
#include <bit>
#include <cmath>

#include "world/impl.h"
#include "world/runs.h"

namespace vp {
namespace {

// How far two may slide on one another before their contact is computed again, in half extents of
// the smaller; and how far they may turn [rad]. The separation of a point at an arm r is then off
// by r turn^2 / 2: a thirtieth of a millimetre for a box of a metre.
constexpr double kSlide = 0.01;
constexpr double kTurn = 0.01;
constexpr double kNeverMeets = 1e30;  // a clearance [m]

Vec3 vector(const float* f) {
  return {static_cast<double>(f[0]), static_cast<double>(f[1]), static_cast<double>(f[2])};
}
Vec3 at(const solve::Field3& f, int lane) {
  return {static_cast<double>(f.x.lane[lane]), static_cast<double>(f.y.lane[lane]),
          static_cast<double>(f.z.lane[lane])};
}

// A ball touches anything convex at one point.
int points_of(const Collider& a, const Collider& b) {
  const bool ball =
      a.geometry.kind == collide::Kind::sphere || b.geometry.kind == collide::Kind::sphere;
  return ball ? 1 : collide::kMaxPoints;
}

// The least of the two; a half-space has no size.
double smaller_size(const Collider& a, const Collider& b) {
  if (a.size == 0.0) return b.size;
  return b.size == 0.0 ? a.size : std::min(a.size, b.size);
}

// The impulses that a contact's lane holds.
struct Held {
  std::array<float, collide::kMaxPoints> normal{};
  Vec3 friction, moment;
};

template <int P>
Held held_in(const solve::ContactBlock<P>& block, int lane) {
  Held impulses;
  for (int i = 0; i < P; ++i)
    impulses.normal[static_cast<std::size_t>(i)] = block.impulse[i].lane[lane];
  const Vec3 n = at(block.normal, lane), t = at(block.tangent, lane), b = cross(n, t);
  const auto number = [&](const solve::Field& f) { return static_cast<double>(f.lane[lane]); };
  impulses.friction = number(block.tangent_impulse[0]) * t + number(block.tangent_impulse[1]) * b;
  impulses.moment = number(block.twist_impulse) * n + number(block.roll_impulse[0]) * t +
                    number(block.roll_impulse[1]) * b;
  return impulses;
}

// The impulse of the old point of the same features; or, since features change names when edges
// pass over one another, of the nearest old one within reach.
float impulse_of(const Contact& contact, const Held& impulses, const collide::ManifoldPoint& p,
                 double reach) {
  float nearest = 0.0f;
  double least = reach * reach;
  for (std::size_t i = 0; i < contact.count; ++i) {
    if (contact.feature[i] == p.feature) return impulses.normal[i];
    const Vec3 d = contact.position[i] - p.position;
    if (dot(d, d) >= least) continue;
    least = dot(d, d);
    nearest = impulses.normal[i];
  }
  return nearest;
}

}  // namespace

solve::ContactGraph::End World::Impl::end_of(std::uint32_t body) const {
  const Body& b = bodies[body];
  if (b.motion == Motion::fixed) return {solve::kWorldRow, false};
  return {body + 1, b.motion == Motion::dynamic};
}

void World::Impl::find_contacts(double dt) {
  update_bounds(dt);
  find_new_contacts();
  drop_parted_contacts();
  find_link_islands();
  find_stale_contacts(dt);
  for (const std::uint32_t c : stale_contacts) look_at(c, dt);
}

void World::Impl::find_new_contacts() {
  new_pairs.clear();
  finder.update(new_pairs);
  for (const collide::ProxyPair& pair : new_pairs) {
    add_contact_pair(finder.user(pair.a), finder.user(pair.b));
  }
}

void World::Impl::drop_parted_contacts() {
  for (const std::uint32_t proxy : finder.moved()) {
    if (!finder.exists(proxy)) continue;
    const std::uint32_t collider = finder.user(proxy);
    std::uint32_t next = kNone;
    for (std::uint32_t e = bodies[colliders[collider].body].first_edge; e != kNone; e = next) {
      const Contact& c = contact_pool[e / 2];
      next = c.next[e % 2];
      if (c.a != collider && c.b != collider) continue;
      const std::uint32_t pa = colliders[c.a].proxy, pb = colliders[c.b].proxy;
      if (finder.should_pair(pa, pb)) continue;
      finder.remove_pair(pa, pb);
      remove_contact(e / 2);
    }
  }
}

void World::Impl::add_contact_pair(std::uint32_t i, std::uint32_t j) {
  const ColliderPair pair = make_pair(colliders, i, j);
  const Collider &a = colliders[pair.a], &b = colliders[pair.b];
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  const bool sensor = a.sensor || b.sensor;
  const bool pushes = body_a.motion == Motion::dynamic || body_b.motion == Motion::dynamic;
  if (!should_meet(a, b) || !(pushes || sensor)) return;
  std::uint32_t index = static_cast<std::uint32_t>(contact_pool.size());
  if (free_contacts.empty()) {
    contact_pool.emplace_back();
  } else {
    index = free_contacts.back();
    free_contacts.pop_back();
  }
  Contact& c = contact_pool[index];
  c = {};
  c.alive = true;
  c.key = pair.key;
  c.a = pair.a;
  c.b = pair.b;
  c.sensor = sensor;
  c.of_link = body_a.is_link || body_b.is_link;
  for (const int side : {0, 1}) {
    Body& body = bodies[side == 0 ? a.body : b.body];
    const std::uint32_t edge = 2 * index + static_cast<std::uint32_t>(side);
    c.next[side] = body.first_edge;
    c.previous[side] = kNone;
    if (body.first_edge != kNone)
      contact_pool[body.first_edge / 2].previous[body.first_edge % 2] = edge;
    body.first_edge = edge;
  }
  set_near(index, 0.0);
}

void World::Impl::remove_contact(std::uint32_t index) {
  Contact& c = contact_pool[index];
  if (c.touching) report_touch(index, false);
  if (c.place.points > 0) {
    take_out_of_lane(index);
  } else {
    unset_near(index);
  }
  for (const int side : {0, 1}) {
    Body& body = bodies[colliders[side == 0 ? c.a : c.b].body];
    const std::uint32_t next = c.next[side], previous = c.previous[side];
    if (next != kNone) contact_pool[next / 2].previous[next % 2] = previous;
    (previous != kNone ? contact_pool[previous / 2].next[previous % 2] : body.first_edge) = next;
  }
  c.alive = false;
  free_contacts.push_back(index);
}

void World::Impl::set_near(std::uint32_t index, double clearance) {
  Contact& c = contact_pool[index];
  c.near_index = static_cast<std::uint32_t>(near_contacts.size());
  near_contacts.push_back(index);
  c.clearance = static_cast<float>(clearance);
  std::fill_n(c.way_a, 6, 0.0f);
  std::fill_n(c.way_b, 6, 0.0f);
}

void World::Impl::unset_near(std::uint32_t index) {
  const std::uint32_t last = near_contacts.back();
  near_contacts[contact_pool[index].near_index] = last;
  contact_pool[last].near_index = contact_pool[index].near_index;
  near_contacts.pop_back();
}

void World::Impl::mark_contacts_stale(std::uint32_t body) {
  for (std::uint32_t e = bodies[body].first_edge; e != kNone; e = contact_pool[e / 2].next[e % 2]) {
    contact_pool[e / 2].stale = true;
  }
}

void World::Impl::find_stale_contacts(double dt) {
  stale_contacts.clear();
  for_runs([&](auto& pass, const auto& run, auto& blocks) {
    const std::size_t count = blocks.size();
    lane_bits.resize(std::max(lane_bits.size(), count));
    pass.find_moved(run, static_cast<float>(dt), static_cast<float>(kTurn), lane_bits.data());
    for (std::size_t b = 0; b < count; ++b) {
      for (std::uint32_t bits = lane_bits[b]; bits != 0; bits &= bits - 1) {
        contact_pool[blocks[b].contact.lane[std::countr_zero(bits)]].stale = true;
      }
    }
  });
  const auto vector_between = [](const float* from, const float* to) {
    return vector(to) - vector(from);
  };
  for (const std::uint32_t index : near_contacts) {
    Contact& c = contact_pool[index];
    if (c.stale) continue;
    const std::uint32_t a = colliders[c.a].body, b = colliders[c.b].body;
    const solve::BodyRow &row_a = body_rows[end_of(a).row], &row_b = body_rows[end_of(b).row];
    const Vec3 apart = vector_between(c.way_b, row_b.way) - vector_between(c.way_a, row_a.way) +
                       dt * (bodies[b].v - bodies[a].v);
    const auto turned = [&](const float* way, const solve::BodyRow& row, const Body& body) {
      return body.reach * norm(vector_between(way + 3, row.way + 3) + dt * body.w);
    };
    const double gone =
        norm(apart) + turned(c.way_a, row_a, bodies[a]) + turned(c.way_b, row_b, bodies[b]);
    c.stale = gone > static_cast<double>(c.clearance);
  }
  for (std::uint32_t i = 0; i < contact_pool.size(); ++i) {
    const Contact& c = contact_pool[i];
    if (!c.alive || !(c.stale || c.sensor) || is_by_impacts(c)) continue;
    stale_contacts.push_back(i);
  }
}

// The narrow phase, for one.
void World::Impl::look_at(std::uint32_t index, double dt) {
  Contact& c = contact_pool[index];
  const Collider &a = colliders[c.a], &b = colliders[c.b];
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  pose_colliders(a.body);
  pose_colliders(b.body);
  const double leeway = kSlide * smaller_size(a, b);
  const double speed =
      norm(body_b.v - body_a.v) + norm(body_a.w) * body_a.reach + norm(body_b.w) * body_b.reach;
  // The ball at the centre of its body feels no turning.
  const double margin = c.sensor ? 0.0 : desc.contact_slop + leeway + speed * dt;
  collide::Manifold m;
  c.stale = false;
  double clearance = margin - desc.contact_slop;
  if (keeps_apart(a.body, b.body)) {
    m.count = 0;
    clearance = kNeverMeets;
  } else {
    find_manifold(a.geometry, a.T, b.geometry, b.T, margin, c.cache, m);
    ++counters.looked_at;
  }
  if (c.sensor) {
    if ((m.count > 0) != c.touching) report_touch(index, m.count > 0);
    return;
  }
  if (m.count > 0) {
    put_in_lane(index, m);
    return;
  }
  if (c.touching) report_touch(index, false);
  if (c.place.points > 0) {
    take_out_of_lane(index);
    set_near(index, clearance);
  }
  c.clearance = static_cast<float>(clearance);
  std::copy_n(body_rows[end_of(a.body).row].way, 6, c.way_a);
  std::copy_n(body_rows[end_of(b.body).row].way, 6, c.way_b);
}

void World::Impl::take_out_of_lane(std::uint32_t index) {
  Contact& c = contact_pool[index];
  const std::uint32_t a = colliders[c.a].body, b = colliders[c.b].body;
  const std::uint32_t moved = graph.remove(c.place, end_of(a), end_of(b));
  if (moved != solve::kNoContact) contact_pool[moved].place = c.place;
  c.place = {};
  c.count = 0;
  --bodies[a].lanes;
  --bodies[b].lanes;
}

void World::Impl::put_in_lane(std::uint32_t index, const collide::Manifold& m) {
  Contact& c = contact_pool[index];
  const Collider &a = colliders[c.a], &b = colliders[c.b];
  const auto end_a = end_of(a.body), end_b = end_of(b.body);
  Held impulses;
  if (c.place.points == 0) {
    unset_near(index);
    c.place = graph.add(index, end_a, end_b, points_of(a, b));
    ++bodies[a.body].lanes;
    ++bodies[b.body].lanes;
  } else {
    impulses = c.place.points == 1 ? held_in(graph.block<1>(c.place), graph.lane(c.place))
                                   : held_in(graph.block<4>(c.place), graph.lane(c.place));
  }
  solve::NewContact n{};
  n.normal = m.normal;
  // What is fixed has its centre where it makes the arms short.
  n.x_a = reference_point(bodies[a.body]);
  n.x_b = reference_point(bodies[b.body]);
  if (end_a.row == solve::kWorldRow) n.x_a = n.x_b;
  if (end_b.row == solve::kWorldRow) n.x_b = n.x_a;
  n.count = std::min<int>(m.count, c.place.points);
  const double leeway = kSlide * smaller_size(a, b);
  for (int i = 0; i < n.count; ++i) {
    const collide::ManifoldPoint& p = m.points[i];
    n.points[i] = {p.position, p.separation, impulse_of(c, impulses, p, 4.0 * leeway)};
  }
  n.friction = std::sqrt(a.material.friction * b.material.friction);
  n.restitution = std::max(a.material.restitution, b.material.restitution);
  const bool ball = c.place.points == 1;
  n.rolling = ball ? std::max(a.material.rolling_friction, b.material.rolling_friction) : 0.0;
  n.spinning = std::max(a.material.spinning_friction, b.material.spinning_friction);
  n.surface_velocity = a.T.rotate(a.surface_velocity) - b.T.rotate(b.surface_velocity);
  n.old_friction = impulses.friction;
  n.old_moment = impulses.moment;
  n.slid_limit = leeway;
  c.count = static_cast<std::uint8_t>(n.count);
  for (int i = 0; i < n.count; ++i) {
    c.feature[i] = m.points[i].feature;
    c.position[i] = m.points[i].position;
  }
  const solve::BodyRow &row_a = body_rows[end_a.row], &row_b = body_rows[end_b.row];
  if (ball) {
    write_lane(graph.block<1>(c.place), graph.lane(c.place), n, row_a, row_b);
  } else {
    write_lane(graph.block<4>(c.place), graph.lane(c.place), n, row_a, row_b);
  }
}

}  // namespace vp
