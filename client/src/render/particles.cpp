#include "render/particles.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace client {
namespace {

constexpr std::size_t kMost = 600;  // more are not seen apart; drawing stays cheap in software

}  // namespace

float Particles::uniform() {
  random_ = random_ * 1664525u + 1013904223u;
  return static_cast<float>(random_ >> 8) / 8388608.0f - 1.0f;
}

void Particles::add(const Particle& particle) {
  if (alive_.size() < kMost) alive_.push_back(particle);
}

void Particles::spark(const glm::vec3& at, const glm::vec3& towards, const glm::vec3& colour,
                      float strength) {
  const int count = 6 + static_cast<int>(26.0f * std::clamp(strength, 0.0f, 1.0f));
  for (int i = 0; i < count; ++i) {
    const glm::vec3 scatter{uniform(), uniform(), 0.5f + 0.5f * uniform()};
    const float speed = (0.25f + 0.9f * strength) * (0.6f + 0.4f * uniform());
    add({at, speed * (scatter + 0.9f * towards), colour, 0.0036f + 0.0014f * uniform(), 0.0f,
         0.38f + 0.12f * uniform(), -2.5f});
  }
}

void Particles::celebrate(const glm::vec3& at, const glm::vec3& colour) {
  for (int i = 0; i < 220; ++i) {
    const glm::vec3 scatter{0.55f * uniform(), 0.55f * uniform(), 0.75f + 0.45f * uniform()};
    const glm::vec3 paper = i % 3 == 0 ? glm::vec3(0.9f) : colour;
    add({at + 0.03f * scatter, 1.15f * scatter, paper, 0.0065f + 0.0025f * uniform(), 0.0f,
         1.5f + 0.6f * uniform(), -1.1f});
  }
}

// Beads of light left where the ball was during the frame: cool when it runs, white-hot when shot.
void Particles::streak(const glm::vec3& ball, const glm::vec3& velocity, float radius, float dt) {
  const float speed = glm::length(velocity);
  if (speed < 1.2f) return;
  const float fade = std::clamp((speed - 1.2f) / 5.0f, 0.0f, 1.0f);
  const glm::vec3 light =
      fade * glm::mix(glm::vec3(0.10f, 0.28f, 0.45f), glm::vec3(0.60f, 0.54f, 0.42f), fade);
  const int beads = std::clamp(static_cast<int>(speed * dt / (0.5f * radius)), 1, 12);
  for (int i = 0; i < beads; ++i) {
    const float back = dt * static_cast<float>(i) / static_cast<float>(beads);
    add({ball - velocity * back, glm::vec3(0), light, 0.80f * radius, back, 0.20f, 0.0f});
  }
}

void Particles::step(float dt) {
  for (Particle& p : alive_) {
    p.age += dt;
    p.velocity.z += p.gravity * dt;
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
