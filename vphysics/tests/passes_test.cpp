// The solver's passes give the same bits with every SIMD width.
#include "solve/passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "random.h"
#include "solve/contact_graph.h"
#include "solve/contact_slot.h"

namespace vp::solve {
namespace {

constexpr std::uint32_t kBodies = 160;
constexpr float kH = 1.0f / 540;

struct Instructions {
  const char* name;
  const Passes* passes;
};
std::vector<Instructions> of_this_machine() {
  std::vector<Instructions> all = {{"baseline", &kBaseline}};
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) all.push_back({"AVX2", &kAvx2});
  if (&passes() == &kAvx512) all.push_back({"AVX-512", &kAvx512});
#endif
  return all;
}

template <int P>
const ContactPasses<P>& passes_of(const Passes& passes) {
  if constexpr (P == 1)
    return passes.one;
  else
    return passes.four;
}

template <int P>
void write_contact(const Passes& passes, ContactBlock<P>& block, int lane, const NewContact& c,
                   const BodyState& a, const BodyState& b) {
  NewContacts contacts{};
  put(contacts, lane, c, a, b);
  passes_of<P>(passes).renew(block, contacts);
}

// A graph of bodies with contacts: some at rest, some separated, some that bounce, some that are
// hit.
struct Net {
  std::vector<BodyState> states{kBodies + 1};
  std::vector<BounceShift> shifts{kBodies + 1};
  ContactGraph graph;
  std::vector<std::uint32_t> bodies;
  std::vector<VelocityChange> velocity_changes{kBodies};

  double gaping;             // fraction of the contacts that are separated
  std::vector<float> acted;  // which slots later iterations found not converged

  explicit Net(std::uint64_t seed) : gaping(seed % 2 == 0 ? 0.3 : 0.8) {
    vp::test::Random random(seed);
    const auto number = [&](double low, double high) {
      return static_cast<float>(random.uniform(low, high));
    };
    graph.resize(states.size());
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      BodyState& state = states[i + 1];
      bodies.push_back(i);
      // Some move fast, most are slow.
      const double speed = random.word() % 8 == 0 ? 3.0 : 0.01;
      for (int k = 0; k < 6; ++k) state.velocity[k] = number(-speed, speed);
      state.velocity[kInverseMass] = number(0.5, 2.0);
      state.velocity[kFalls] = 1.0f;
      for (int k = 0; k < 3; ++k) state.inertia[k] = number(4.0, 8.0);
      for (int k = 3; k < 6; ++k) state.inertia[k] = number(-1.0, 1.0);
      state.inertia[kKeepLinear] = state.inertia[kKeepAngular] = 1.0f;
      state.rate[2] = -9.81f;
    }
    std::uint32_t contact = 0;
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      for (const std::uint32_t step : {0u, 1u, 7u}) {  // 0: with a fixed body
        if (random.word() % 4 == 0) continue;
        const std::uint32_t j = (i + step) % kBodies;
        const ContactGraph::End a{step == 0 ? kWorldState : i + 1, step != 0, kSharedRegion};
        const ContactGraph::End b{j + 1, true, kSharedRegion};
        const bool ball = random.word() % 5 == 0;
        const ContactSlot slot = graph.add(contact++, a, b, ball ? 1 : 4);
        if (ball) {
          write(graph.block<1>(slot), slot, a, b, random);
        } else {
          write(graph.block<4>(slot), slot, a, b, random);
        }
      }
    }
  }

  template <int P>
  void write(ContactBlock<P>& block, const ContactSlot& slot, const ContactGraph::End& a,
             const ContactGraph::End& b, vp::test::Random& random) {
    NewContact c{};
    c.normal = random.rotation() * Vec3{0, 0, 1};
    c.x_b = random.in_cube(0.5);
    c.count = P == 1 ? 1 : 1 + static_cast<int>(random.word() % 4);
    const bool gapes = random.uniform(0.0, 1.0) < gaping;
    const double gap = gapes ? random.uniform(0.0, 6e-3) : -1e-4;
    for (int i = 0; i < c.count; ++i) {
      c.points[i] = {random.in_cube(0.5), gap + random.uniform(0.0, 1e-4), 0.0f};
      if (!gapes) c.points[i].impulse = static_cast<float>(random.uniform(0.0, 0.02));
    }
    c.friction = random.uniform(0.0, 1.0);
    c.restitution = random.word() % 6 == 0 ? 0.5 : 0.0;
    c.rolling = P == 1 ? 0.01 : 0.0;
    c.slid_limit = 0.01;
    write_contact(passes(), block, ContactGraph::lane(slot), c, states[a.state], states[b.state]);
  }

  // f(passes of the kind, run).
  template <class F>
  void for_runs(const Passes& passes, const F& f) {
    for (int c = 0; c < kLastColour; ++c) {
      const auto one = [&](const auto& of_kind, auto& colour) {
        using Run = typename std::remove_cvref_t<decltype(of_kind)>::Run;
        if (colour.slots > 0) {
          f(of_kind, Run{colour.blocks.data(), colour.slots, kLanes, states.data()});
        }
      };
      one(passes.one, graph.of<1>(kSharedRegion, c));
      one(passes.four, graph.of<4>(kSharedRegion, c));
    }
  }

  int sub_step(const Passes& passes, const Soft& soft, bool first) {
    int bounces = 0;
    const std::size_t n = bodies.size();
    if (first) for_runs(passes, [&](const auto& p, const auto& run) { p.load_inertias(run); });
    if (!first)
      passes.find_velocity_changes(states.data(), velocity_changes.data(), bodies.data(), n);
    passes.accelerate(states.data(), bodies.data(), n, kH);
    for (int round = 0; round < 4; ++round) {
      for_runs(passes, [&](const auto& p, const auto& run) {
        bounces += p.apply_restitution(run, kH, 0.05f, shifts.data());
      });
    }
    (first ? passes.keep : passes.repeat)(states.data(), velocity_changes.data(), bodies.data(), n);
    if (first) for_runs(passes, [&](const auto& p, const auto& run) { p.warm_start(run); });
    for_runs(passes, [&](const auto& p, const auto& run) { p.solve_first(run, soft); });
    acted.clear();
    for (int round = 0; round < 2; ++round) {
      for_runs(passes, [&](const auto& p, const auto& run) {
        p.solve_again(run, soft);
        for (std::uint32_t l = 0; l < run.slots; ++l)
          acted.push_back(run.blocks[l / kLanes].active.lane[l % kLanes]);
      });
    }
    passes.move(states.data(), bodies.data(), n, kH);
    for_runs(passes, [&](const auto& p, const auto& run) { p.relax(run, soft); });
    return bounces;
  }

  // Everything that the passes read and write, except unused lanes.
  std::vector<float> state() {
    std::vector<float> all = acted;
    const auto add = [&all](const float(&state)[8]) { all.insert(all.end(), state, state + 8); };
    for (const BodyState& state : states) {
      add(state.velocity);
      add(state.displacement);
    }
    for (const BounceShift& shift : shifts) add(shift.displacement);
    for_runs(passes(), [&](const auto&, const auto& run) {
      for (std::uint32_t l = 0; l < run.slots; ++l) {
        auto& block = run.blocks[l / kLanes];
        for (const Field* f : {&block.active, &block.given, &block.bias[0]})
          all.push_back(f->lane[l % kLanes]);
        for (const Field& f : fields_of(block)) all.push_back(f.lane[l % kLanes]);
      }
    });
    return all;
  }
};

// Each point's impulse p follows a spring and a damper, and is never negative:
//   share m (u + bias) + (1 - share) p = 0,  or p = 0 and u + bias >= 0
// with u from the bodies' velocities and the points' arms, and m the effective mass of the point.
TEST(Passes, PushEveryPointAsItsEquationSays) {
  constexpr int kRounds = 200;
  const Soft soft{0.1f / kH, 0.93f, 3.0f, 1.0f / kH, 0.0f};
  for (const Instructions& of : of_this_machine()) {
    int pushing = 0, free = 0, open = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      vp::test::Random random(seed);
      std::vector<BodyState> states(2 * kLanes + 1);
      std::vector<NewContact> contacts(kLanes);
      std::vector<ContactBlock<4>> blocks(1);
      for (int lane = 0; lane < kLanes; ++lane) {
        NewContact& c = contacts[lane];
        for (int side = 0; side < 2; ++side) {
          BodyState& state = states[1 + 2 * lane + side];
          for (int k = 0; k < 6; ++k) state.velocity[k] = static_cast<float>(random.uniform(-1, 1));
          state.velocity[kInverseMass] = static_cast<float>(random.uniform(0.5, 2.0));
          for (int k = 0; k < 3; ++k) state.inertia[k] = static_cast<float>(random.uniform(4, 8));
          for (int k = 3; k < 6; ++k) state.inertia[k] = static_cast<float>(random.uniform(-1, 1));
          (side == 0 ? blocks[0].a : blocks[0].b).lane[lane] =
              static_cast<unsigned>(1 + 2 * lane + side);
        }
        c.normal = random.rotation() * Vec3{0, 0, 1};
        c.x_b = random.in_cube(0.5);
        c.count = 4;
        const Vec3 first = random.in_cube(0.4);
        for (auto& point : c.points)
          point = {first + random.in_cube(0.1), random.uniform(-2e-3, 1e-3), 0.0f};
        write_contact(*of.passes, blocks[0], lane, c, states[1 + 2 * lane], states[2 + 2 * lane]);
      }
      const ContactPasses<4>::Run run{blocks.data(), kLanes, kLanes, states.data()};
      of.passes->four.load_inertias(run);
      for (int k = 0; k < kRounds; ++k) {
        if (k % 4 == 0) {
          of.passes->four.solve_first(run, soft);
        } else {
          std::fill_n(blocks[0].active.lane, kLanes, 1.0f);
          of.passes->four.solve_again(run, soft);
        }
      }

      for (int lane = 0; lane < kLanes; ++lane) {
        const NewContact& c = contacts[lane];
        const auto velocity_at = [&](const BodyState& state, const Vec3& arm) {
          const float* v = state.velocity;
          return Vec3{v[0], v[1], v[2]} + cross(Vec3{v[3], v[4], v[5]}, arm);
        };
        const BodyState &a = states[1 + 2 * lane], &b = states[2 + 2 * lane];
        const auto answer = [&](const BodyState& state, const Vec3& arm) {
          const Vec3 j = cross(arm, c.normal);
          const float* i = state.inertia;
          const Vec3 w{i[0] * j.x + i[3] * j.y + i[5] * j.z, i[3] * j.x + i[1] * j.y + i[4] * j.z,
                       i[5] * j.x + i[4] * j.y + i[2] * j.z};
          return state.velocity[kInverseMass] + dot(j, w);
        };
        double load = 0.0;
        for (const Field& p : blocks[0].impulse) load += p.lane[lane];
        for (int i = 0; i < 4; ++i) {
          const Vec3 r_a = c.points[i].position - c.x_a, r_b = c.points[i].position - c.x_b;
          const double s = c.points[i].separation, p = blocks[0].impulse[i].lane[lane];
          const double bias = s > 0 ? s / kH : std::max(0.1 / kH * s, -3.0);
          const double u = dot(c.normal, velocity_at(b, r_b) - velocity_at(a, r_a)) + bias;
          const double m = 1.0 / (answer(a, r_a) + answer(b, r_b)), share = s > 0 ? 1.0 : 0.93;
          if (p > 0.0) {
            EXPECT_NEAR(share * m * u + (1.0 - share) * p, 0.0, 2e-3 * load) << of.name;
          } else {
            EXPECT_GE(m * u, -2e-3 * load - 1e-6) << of.name;
          }
          ++(p > 0.0 ? pushing : free);
          open += s > 0.0 && p > 0.0;
        }
      }
    }
    EXPECT_GT(pushing, 200);
    EXPECT_GT(free, 200);
    EXPECT_GT(open, 10);
  }
}

// Later iterations skip a contact without an impulse if an impact of 1 m/s would not close it
// within the sub-step.
TEST(Passes, LeaveAloneWhatNoBlowReaches) {
  const Soft soft{0.1f / kH, 0.93f, 3.0f, 1.0f / kH, 0.0f};
  for (const Instructions& of : of_this_machine()) {
    for (const double speed : {0.0, -0.5, 2.0}) {  // separation velocity
      std::vector<BodyState> states(2 * kLanes + 1);
      std::vector<ContactBlock<4>> blocks(1);
      for (int lane = 0; lane < kLanes; ++lane) {
        const auto a = static_cast<std::uint32_t>(1 + 2 * lane), b = a + 1;
        for (const std::uint32_t state : {a, b}) states[state].velocity[kInverseMass] = 1.0f;
        states[b].velocity[2] = static_cast<float>(speed);
        blocks[0].a.lane[lane] = a;
        blocks[0].b.lane[lane] = b;
        NewContact c{};
        c.normal = {0, 0, 1};
        c.count = 2;
        // Both separations grow at the same rate; the smaller one decides.
        const double blow = 0.05 + 0.1 * lane;
        c.points[0] = {{0.1, 0, 0}, kH * (blow - speed), 0.0f};
        c.points[1] = {{-0.1, 0, 0}, kH * (5.0 - speed), 0.0f};
        write_contact(*of.passes, blocks[0], lane, c, states[a], states[b]);
      }
      const ContactPasses<4>::Run run{blocks.data(), kLanes, kLanes, states.data()};
      of.passes->four.load_inertias(run);
      of.passes->four.solve_first(run, soft);
      for (int lane = 0; lane < kLanes; ++lane) {
        if (speed > 0.05 + 0.1 * lane) continue;  // the points are not separated
        ASSERT_EQ(blocks[0].impulse[0].lane[lane], 0.0f);
        EXPECT_EQ(blocks[0].active.lane[lane], lane < 10 ? 1.0f : 0.0f)
            << of.name << ", lane " << lane << " at " << speed;
      }
    }
  }
}

// A slot without a new contact keeps every bit; one with a new contact gets the same in every
// width.
template <int P>
void expect_that_new_contacts_alone_are_written(std::uint64_t seed) {
  vp::test::Random random(seed);
  std::vector<ContactBlock<P>> before(1);
  for (Field& f : fields_of(before[0])) {
    for (float& x : f.lane) x = static_cast<float>(random.uniform(-1.0, 1.0));
  }
  NewContacts contacts{};
  for (int lane = 0; lane < kLanes; ++lane) {
    if (random.word() % 3 == 0) continue;
    BodyState states[2]{};
    for (BodyState& state : states) {
      state.velocity[kInverseMass] = static_cast<float>(random.uniform(0.5, 2.0));
      for (int k = 0; k < 3; ++k) state.inertia[k] = static_cast<float>(random.uniform(4, 8));
      for (float& x : state.displacement) x = static_cast<float>(random.uniform(-0.1, 0.1));
    }
    NewContact c{};
    c.normal = random.rotation() * Vec3{0, 0, 1};
    c.x_b = random.in_cube(0.5);
    c.count = P == 1 ? 1 : 1 + static_cast<int>(random.word() % 4);
    for (int i = 0; i < c.count; ++i) c.points[i] = {random.in_cube(0.5), -1e-3, 0.01f};
    c.friction = 0.5;
    c.rolling = random.word() % 2 == 0 ? 0.01 : 0.0;
    put(contacts, lane, c, states[0], states[1]);
  }
  std::vector<ContactBlock<P>> first;
  for (const Instructions& of : of_this_machine()) {
    std::vector<ContactBlock<P>> after = before;
    passes_of<P>(*of.passes).renew(after[0], contacts);
    if (first.empty()) first = after;
    const auto fields = fields_of(after[0]), old = fields_of(before[0]), same = fields_of(first[0]);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      for (int lane = 0; lane < kLanes; ++lane) {
        EXPECT_EQ(fields[f].lane[lane], same[f].lane[lane]) << of.name << ", field " << f;
        if ((contacts.lanes >> lane & 1u) != 0) continue;
        EXPECT_EQ(fields[f].lane[lane], old[f].lane[lane]) << of.name << ", field " << f;
      }
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((contacts.lanes >> lane & 1u) == 0) continue;
      EXPECT_GT(after[0].inverse[0].lane[lane], 0.0f);
      EXPECT_GT(std::hypot(after[0].tangent_impulse[0].lane[lane],
                           after[0].tangent_impulse[1].lane[lane]),
                0.0f);
    }
  }
}
TEST(Passes, WriteNewContactsAlone) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_that_new_contacts_alone_are_written<1>(seed);
    expect_that_new_contacts_alone_are_written<4>(seed);
  }
}

// An early end of the work in one lane must not depend on the other lanes.
TEST(Passes, GiveTheSameBitsInEveryWidth) {
  const std::vector<Instructions> all = of_this_machine();
  int bounces = 0;
  std::size_t loaded = 0, idle = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<Net> nets(all.size(), Net(seed));
    Soft soft{0.1f / kH, 0.93f, 3.0f, 1.0f / kH, 0.0f};
    for (int k = 0; k < 9; ++k) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        const int found = nets[i].sub_step(*all[i].passes, soft, k == 0);
        if (i == 0) bounces += found;
      }
      soft.keeps_load = 1.0f;
      const std::vector<float> first = nets[0].state();
      for (std::size_t i = 1; i < all.size(); ++i) {
        const std::vector<float> other = nets[i].state();
        ASSERT_EQ(first.size(), other.size());
        ASSERT_EQ(std::memcmp(first.data(), other.data(), first.size() * sizeof(float)), 0)
            << all[i].name << ", seed " << seed << ", sub-step " << k;
      }
    }
    nets[0].for_runs(passes(), [&](const auto&, const auto& run) {
      for (std::uint32_t l = 0; l < run.slots; ++l) {
        const auto& block = run.blocks[l / kLanes];
        loaded += block.impulse[0].lane[l % kLanes] > 0.0f;
        idle += block.active.lane[l % kLanes] == 0.0f;
      }
    });
  }
  std::printf("%zu widths; of the contacts %zu loaded, %zu idle; %d bounces\n", all.size(), loaded,
              idle, bounces);
  EXPECT_GT(loaded, 1000u);
  EXPECT_GT(idle, 500u);
  EXPECT_GT(bounces, 100);
}

}  // namespace
}  // namespace vp::solve
