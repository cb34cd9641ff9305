// Random creation and destruction of bodies, colliders and joints between steps. Numbers stay
// finite, a restored snapshot gives the same bits, and no freed object is read (run under
// sanitizers).
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <utility>

#include "random.h"
#include "rig.h"

namespace vp::test {
namespace {

// VP_CHURN_SEQUENCES=N sets the number of sequences. Ten thousand take minutes under the
// sanitizers.
int sequences() {
  const char* wanted = std::getenv("VP_CHURN_SEQUENCES");
  return wanted ? std::max(1, std::atoi(wanted)) : 500;
}
constexpr int kCalls = 40;

// What occurred in the steps of all sequences.
struct Seen {
  std::size_t contacts = 0, joints = 0, asleep = 0;
};

class Churn {
 public:
  inline static Seen seen;

  explicit Churn(std::uint64_t seed) : random_(seed), world_(desc(random_)) {
    if (pick(3) != 0) add_ground(world_, material());
  }

  void call() {
    switch (pick(22)) {
      case 0:
      case 1:
      case 2:
        return create();
      case 3:
        return destroy();
      case 4:
        if (const BodyId body = any(); world_.contains(body)) (void)add_collider(body);
        return;
      case 5:
        if (const BodyId body = any(); world_.contains(body))
          (void)world_.set_pose(body, SE3(random_.rotation(), place()));
        return;
      case 6:
        (void)world_.set_velocity(any(), {random_.in_cube(20.0), random_.in_cube(8.0)});
        return;
      case 7:
        (void)world_.apply_impulse(any(), random_.in_cube(2.0), random_.in_cube(0.5));
        return;
      case 8:
        return join();
      case 9:
        if (!joints_.empty()) (void)world_.destroy_joint(joints_[pick(joints_.size())]);
        return;
      case 10:
        return save_and_restore();
      case 11:
        (void)world_.wake(any());
        return;
      case 12:
        return push();
      case 13:
        return change_body();
      case 14:
        return change_collider();
      case 15:
        return make_tree();
      case 16:
        if (!trees_.empty()) (void)world_.destroy_articulation(trees_[pick(trees_.size())]);
        return;
      default:
        return step();
    }
  }

  void expect_sane() const {
    for (const BodyId body : bodies_) {
      if (!world_.contains(body)) continue;
      const Vec3 x = world_.pose(body).position(), v = world_.velocity(body).v;
      ASSERT_LT(norm(x) + norm(v), 1e6);
    }
  }

 private:
  static WorldDesc desc(Random& random) {
    WorldDesc d;
    d.sleep_after = random.word() % 2 == 0 ? 0.01 : 0.0;
    d.sleep_speed = 3.0;  // high, so that bodies fall asleep early
    if (random.word() % 2 == 0) d.region_bodies = 1 + static_cast<int>(random.word() % 4);
    return d;
  }
  std::size_t pick(std::size_t n) { return static_cast<std::size_t>(random_.word() % n); }
  Vec3 place() { return random_.in_cube(0.3) + Vec3{0, 0, 0.4}; }
  BodyId any() { return bodies_.empty() ? BodyId{} : bodies_[pick(bodies_.size())]; }
  Material material() {
    Material m;
    m.friction = random_.uniform(0.0, 1.0);
    m.restitution = pick(2) == 0 ? 0.0 : random_.uniform(0.0, 0.9);
    m.rolling_friction = pick(4) == 0 ? 0.01 : 0.0;
    return m;
  }
  Shape shape() {
    const double r = random_.uniform(0.05, 0.2);
    switch (pick(5)) {
      case 0:
        return Box{{r, random_.uniform(0.05, 0.2), random_.uniform(0.05, 0.2)}};
      case 1:
        return Capsule{r, random_.uniform(0.05, 0.2)};
      case 2:
        return Cylinder{r, random_.uniform(0.05, 0.2)};
      default:
        return Sphere{r};
    }
  }
  bool add_collider(BodyId body, bool sensor = false) {
    ColliderDesc c;
    c.shape = shape();
    c.material = material();
    c.sensor = pick(6) == 0 || sensor;
    c.T_body_shape = SE3(random_.rotation(), random_.in_cube(0.1));
    const auto collider = world_.add_collider(body, c);
    if (collider) colliders_.push_back(*collider);
    return collider.has_value();
  }
  void push() {
    const BodyId body = any();
    (void)world_.apply_force(body, random_.in_cube(100.0));
    (void)world_.apply_force(body, random_.in_cube(100.0), place());
    (void)world_.apply_torque(any(), random_.in_cube(5.0));
    if (!trees_.empty()) {
      const ArticulationId tree = trees_[pick(trees_.size())];
      (void)world_.apply_joint_force(tree, 0, static_cast<int>(pick(2)), random_.uniform(-1, 1));
      (void)world_.apply_force(world_.link_body(tree, 0), random_.in_cube(10.0));
    }
  }
  void change_body() {
    const BodyId body = any();
    switch (pick(6)) {
      case 0:
      case 1:
        (void)world_.set_motion(body, static_cast<Motion>(pick(3)));
        return;
      case 2:
        (void)world_.set_inertia(body, solid_inertia(Sphere{random_.uniform(0.05, 0.3)}, 1000.0));
        return;
      case 3:
        (void)world_.set_damping(body, random_.uniform(0, 5), random_.uniform(0, 5));
        return;
      case 4:
        (void)world_.set_gravity_scale(body, random_.uniform(-1, 2));
        return;
      default:
        (void)world_.set_allow_sleep(body, pick(2) == 0);
    }
  }
  void change_collider() {
    if (colliders_.empty()) return;
    const ColliderId collider = colliders_[pick(colliders_.size())];
    switch (pick(4)) {
      case 0:
        (void)world_.set_material(collider, material());
        return;
      case 1:
        (void)world_.set_filter(collider, {1u << pick(2), pick(3) == 0 ? 1u : ~0u});
        return;
      case 2:
        (void)world_.set_surface_velocity(collider, random_.in_cube(1.0));
        return;
      default:
        (void)world_.remove_collider(collider);
    }
  }
  void make_tree() {
    if (trees_.size() > 6) return;
    LinkSpec link;
    link.inertia = solid_inertia(Sphere{0.15}, 1000.0);
    link.T_parent_joint = SE3(random_.rotation(), place());
    link.joint = PrismaticJoint{{0, 0, 1}};
    if (pick(2) == 0) link.joint = FreeJoint{};
    if (pick(3) == 0) link.joint = CylindricalJoint{};
    const auto tree = world_.create_articulation({model_of({link})});
    ASSERT_TRUE(tree.has_value());
    trees_.push_back(*tree);
    // Sensors only. Other tests cover links that are created deep within bodies.
    for (std::size_t i = pick(3); i > 0; --i) (void)add_collider(world_.link_body(*tree, 0), true);
  }
  void create() {
    BodyDesc d;
    const std::size_t kind = pick(8);
    d.motion = kind == 0 ? Motion::fixed : kind == 1 ? Motion::kinematic : Motion::dynamic;
    d.T_world_body = SE3(random_.rotation(), place());
    if (pick(3) != 0) d.inertia = solid_inertia(Sphere{0.15}, 1000.0);
    if (pick(4) == 0) d.gravity_scale = 0.5;
    d.continuous = kind == 2;
    if (d.motion != Motion::fixed) d.velocity = {random_.in_cube(5.0), random_.in_cube(3.0)};
    const auto body = world_.create_body(d);
    ASSERT_TRUE(body.has_value());
    bodies_.push_back(*body);
    for (std::size_t i = pick(3); i > 0; --i) (void)add_collider(*body);
  }
  void destroy() {
    if (bodies_.empty()) return;
    const std::size_t i = pick(bodies_.size());
    (void)world_.destroy_body(bodies_[i]);
    if (pick(2) == 0) bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  void join() {
    JointDesc d;
    switch (pick(4)) {
      case 0:
        d.kind = BallSocket{};
        break;
      case 1:
        d.kind = Hinge{-0.5, 0.5, {.velocity = 1.0, .damping = 1.0, .max_force = 1.0}};
        break;
      case 2:
        d.kind = Distance{0.1, 0.4};
        break;
      default:
        d.kind = Weld{};
    }
    d.T_a_joint = SE3(random_.in_cube(0.2));
    d.T_b_joint = SE3(random_.in_cube(0.2));
    d.collide = pick(2) == 0;
    if (const auto joint = world_.create_joint(any(), any(), d)) joints_.push_back(*joint);
  }
  void step() {
    const double dt = pick(2) == 0 ? 0.001 : random_.uniform(1e-4, 0.02);
    for (std::size_t i = pick(8); i < 8; ++i) step(dt);
  }
  void step(double dt) {
    const auto status = world_.step(dt);
    ASSERT_TRUE(status.has_value());
    ASSERT_FALSE(status->non_finite);
    follow_events();
    seen.contacts += world_.counters().contacts;
    seen.joints += joints_.size();
    for (const BodyId body : bodies_)
      seen.asleep += world_.contains(body) && world_.is_asleep(body);
  }
  // Checks that each begin event is followed by one end event.
  void follow_events() {
    for (const ContactEvent& event : world_.contact_events()) {
      const std::pair pair{event.a, event.b};
      if (event.kind == ContactEvent::Kind::begin) {
        ASSERT_TRUE(touching_.insert(pair).second);
      } else {
        ASSERT_TRUE(touching_.contains(pair));
      }
      if (event.kind == ContactEvent::Kind::end) touching_.erase(pair);
    }
  }
  // Restores the snapshot after a step. The repeated step must give the same result.
  void save_and_restore() {
    bytes_.clear();
    const auto touching = touching_;
    world_.snapshot(bytes_);
    const std::uint64_t hash = world_.state_hash();
    step(0.002);
    const std::uint64_t after = world_.state_hash();
    ASSERT_TRUE(world_.restore(bytes_).has_value());
    ASSERT_EQ(world_.state_hash(), hash);
    touching_ = touching;
    step(0.002);
    ASSERT_EQ(world_.state_hash(), after);
  }

  Random random_;
  World world_;
  std::vector<BodyId> bodies_;
  std::vector<JointId> joints_;
  std::vector<ColliderId> colliders_;
  std::vector<ArticulationId> trees_;
  std::set<std::pair<ColliderId, ColliderId>> touching_;
  std::vector<std::byte> bytes_;
};

TEST(Churn, OfBodiesCollidersAndJointsLeavesTheWorldSane) {
  const int count = sequences();
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    Churn churn(static_cast<std::uint64_t>(i));
    for (int k = 0; k < kCalls; ++k) {
      churn.call();
      if (HasFatalFailure()) return;
    }
    churn.expect_sane();
    if (HasFatalFailure()) return;
  }
  const auto& [contacts, joints, asleep] = Churn::seen;
  std::printf("steps saw %zu contact points, %zu joints, %zu bodies asleep\n", contacts, joints,
              asleep);
  EXPECT_GT(contacts, static_cast<std::size_t>(10 * count));
  EXPECT_GT(joints, static_cast<std::size_t>(count));
  EXPECT_GT(asleep, static_cast<std::size_t>(count));
}

}  // namespace
}  // namespace vp::test
