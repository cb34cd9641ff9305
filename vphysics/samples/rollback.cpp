// Rollback for networked games: the simulation advances with a predicted input of the other player;
// when the actual input differs, it restores an earlier state and repeats the steps. Public headers
// only.
#include <array>
#include <cstddef>
#include <cstdio>
#include <deque>
#include <vector>

#include "vphysics/world.h"

namespace {

constexpr double kTick = 1.0 / 60.0;
constexpr int kTicks = 300, kLate = 8;  // delay of the other player's input, in ticks

struct Game {
  vp::World world;
  std::array<vp::BodyId, 2> pucks;  // one for each player
  bool ok = true;

  Game() {
    vp::BodyDesc table;
    table.motion = vp::Motion::fixed;
    add(table, vp::HalfSpace{});
    for (const double side : {-1.0, 1.0}) {
      vp::BodyDesc puck;
      puck.T_world_body = vp::SE3(vp::Vec3{1.2 * side, 0.0, 0.1});
      pucks[side < 0.0 ? 0 : 1] = add(puck, vp::Cylinder{0.2, 0.1});
    }
    for (int layer = 0; layer < 5; ++layer) {  // a tower between them
      vp::BodyDesc crate;
      crate.T_world_body = vp::SE3(vp::Vec3{0.0, 0.0, 0.1 + 0.2 * layer});
      add(crate, vp::Box{{0.1, 0.1, 0.1}});
    }
  }
  vp::BodyId add(const vp::BodyDesc& desc, const vp::Shape& shape) {
    vp::ColliderDesc collider;
    collider.shape = shape;
    collider.density = 100.0;
    const auto body = world.create_body(desc);
    ok = ok && body && world.add_collider(*body, collider);
    return body ? *body : vp::BodyId{};
  }
  // A tick depends only on the state and on both inputs, forces [N].
  void tick(const std::array<double, 2>& inputs) {
    for (std::size_t k = 0; k < 2; ++k) {
      ok = ok && world.apply_force(pucks[k], {inputs[k], 0.2 * inputs[k], 0.0});
    }
    ok = ok && world.step(kTick);
  }
};

// The players' inputs, which change from time to time.
double input_of(int player, int tick) {
  const int phase = (tick + 37 * player) / 45 % 3;
  return (player == 0 ? 1.0 : -1.0) *
         std::array{30.0, 12.0, -20.0}[static_cast<std::size_t>(phase)];
}

}  // namespace

int main() {
  // begin: rollback
  Game game;
  std::deque<std::vector<std::byte>> saved;  // of the last kLate ticks, oldest first
  std::deque<double> guessed;                // predicted inputs of the other player in these ticks
  int taken_back = 0;
  for (int tick = 0; tick < kTicks + kLate; ++tick) {
    if (tick >= kLate) {  // the other player's input of kLate ticks ago arrives
      const int then = tick - kLate;
      const double truth = input_of(1, then);
      if (guessed.front() != truth) {
        ++taken_back;
        if (!game.world.restore(saved.front())) return 1;
        for (auto& guess : guessed) guess = truth;  // prediction until the next input
        for (int again = then; again < tick && again < kTicks; ++again) {
          const auto slot = static_cast<std::size_t>(again - then);
          saved[slot].clear();
          game.world.snapshot(saved[slot]);
          game.tick({input_of(0, again), guessed[slot]});
        }
      }
      saved.pop_front();
      guessed.pop_front();
    }
    if (tick >= kTicks) continue;  // the game is over; late inputs still arrive
    saved.emplace_back();
    game.world.snapshot(saved.back());
    guessed.push_back(guessed.empty() ? 0.0 : guessed.back());
    game.tick({input_of(0, tick), guessed.back()});
  }
  // end: rollback

  // A simulation with all inputs in time has the same bits.
  Game reference;
  for (int tick = 0; tick < kTicks; ++tick) reference.tick({input_of(0, tick), input_of(1, tick)});
  const bool same = game.world.state_hash() == reference.world.state_hash();
  std::printf(
      "%d times in %d ticks a guess was wrong, and steps were taken back; the states are %s\n",
      taken_back, kTicks, same ? "the same" : "different");
  return game.ok && reference.ok && same && taken_back > 3 ? 0 : 1;
}
