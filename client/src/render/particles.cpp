#include "render/particles.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace client {
namespace {

constexpr std::size_t kMax = 900;  // more are indistinguishable; software drawing stays cheap

const glm::vec3 kHot{1.5f, 1.25f, 0.85f};
const glm::vec3 kWood{1.1f, 0.75f, 0.35f};
const glm::vec3 kTurf{0.10f, 0.55f, 0.45f};
// Confetti.
const glm::vec3 kPaper[] = {
    {0.9f, 0.9f, 0.9f}, {0.95f, 0.75f, 0.10f}, {0.85f, 0.15f, 0.55f}, {0.15f, 0.75f, 0.35f}};

}  // namespace

float Particles::uniform() {
  random_ = random_ * 1664525u + 1013904223u;
  return static_cast<float>(random_ >> 8) / 8388608.0f - 1.0f;
}

void Particles::add(const Particle& particle) {
  if (alive_.size() < kMax) alive_.push_back(particle);
}

void Particles::spark(Material material, const glm::vec3& at, const glm::vec3& towards,
                      const glm::vec3& colour, float strength) {
  const float power = std::clamp(strength, 0.0f, 1.0f);
  const float share = (material == Material::man ? 1.0f : 0.6f) * (reduced_ ? 0.35f : 1.0f);
  const int count = static_cast<int>(share * (4.0f + 86.0f * power));
  const glm::vec3 own = material == Material::wall    ? kWood
                        : material == Material::field ? kTurf
                                                      : 1.6f * colour;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 scatter{uniform(), uniform(), 0.45f + 0.55f * uniform()};
    const float speed = (0.20f + 1.7f * power) * (0.55f + 0.45f * uniform());
    // The strongest hits have a hot core; the other sparks have the team's or the material's
    // colour.
    const bool hot = !reduced_ && power > 0.35f && i % 6 == 0;
    const float hue = 0.5f + 0.5f * uniform();
    const glm::vec3 light =
        hot ? 0.6f * power * kHot : own * (0.30f + 0.50f * hue) + 0.05f * power * hue * kHot;
    add({at, speed * (scatter + 0.9f * towards), light,
         (0.0026f + 0.0024f * power) * (1.0f + 0.4f * uniform()), 0.0f,
         (0.26f + 0.30f * power) * (1.0f + 0.35f * uniform()), -3.2f, 1.6f});
  }
}

void Particles::celebrate(const glm::vec3& at, const glm::vec3& colour, float strength) {
  const int count =
      static_cast<int>((reduced_ ? 60.0f : 260.0f) * std::clamp(strength, 0.3f, 1.0f));
  for (int i = 0; i < count; ++i) {
    const glm::vec3 scatter{0.55f * uniform(), 0.55f * uniform(), 0.75f + 0.45f * uniform()};
    const glm::vec3 paper = i % 2 == 0 ? colour : kPaper[static_cast<std::size_t>(i / 2) % 4];
    add({at + 0.03f * scatter, (0.8f + 0.6f * strength) * scatter, paper,
         0.0062f + 0.0026f * uniform(), 0.0f, 1.6f + 0.6f * uniform(), -1.1f, 0.5f});
  }
}

// Beads of light along the ball's path during the frame, in the colour of the team that shot;
// whiter with speed.
void Particles::streak(const glm::vec3& ball, const glm::vec3& velocity, float radius,
                       const glm::vec3& colour, float dt) {
  const float speed = glm::length(velocity);
  if (speed < 1.2f) return;
  const float fade = std::clamp((speed - 1.2f) / 6.0f, 0.0f, 1.0f);
  const glm::vec3 light = (reduced_ ? 0.15f : 0.50f) * fade *
                          glm::mix(0.9f * colour, 0.5f * (colour + kHot), fade * fade);
  // As many at 30 frames a second, so that the trail has no gaps.
  constexpr int kMaxBeads = 48;
  const int beads = std::clamp(static_cast<int>(speed * dt / (0.5f * radius)), 1, kMaxBeads);
  for (int i = 0; i < beads; ++i) {
    const float back = dt * static_cast<float>(i) / static_cast<float>(beads);
    add({ball - velocity * back, glm::vec3(0), light, 0.80f * radius, back, 0.16f + 0.14f * fade,
         0.0f});
  }
}

void Particles::dust(const glm::vec3& ball, const glm::vec3& velocity, float radius, float dt) {
  const float speed = glm::length(glm::vec2(velocity));
  if (ball.z > 1.6f * radius || speed < 0.8f) return;
  dust_due_ += dt * std::min(14.0f * speed, 70.0f) * (reduced_ ? 0.3f : 1.0f);
  for (; dust_due_ >= 1.0f; dust_due_ -= 1.0f) {
    const glm::vec3 ground{ball.x + 0.5f * radius * uniform(), ball.y + 0.5f * radius * uniform(),
                           0.003f};
    add({ground,
         {0.08f * uniform() + 0.10f * velocity.x, 0.08f * uniform() + 0.10f * velocity.y,
          0.10f + 0.06f * uniform()},
         glm::vec3(0.050f, 0.085f, 0.080f),
         0.0075f + 0.0030f * uniform(),
         0.0f,
         0.45f,
         -0.15f,
         3.0f});
  }
}

void Particles::step(float dt) {
  for (Particle& p : alive_) {
    p.age += dt;
    p.velocity.z += p.gravity * dt;
    p.velocity *= std::max(1.0f - p.drag * dt, 0.0f);
    p.position += p.velocity * dt;
  }
  std::erase_if(alive_, [](const Particle& p) { return p.age >= p.life; });
}

const std::vector<ParticleVertex>& Particles::vertices() {
  vertices_.clear();
  for (const Particle& p : alive_) {
    const float left = 1.0f - p.age / p.life;
    vertices_.push_back(
        {glm::vec4(p.position, p.radius * (0.5f + 0.5f * left)), glm::vec4(p.colour, left)});
  }
  return vertices_;
}

}  // namespace client
