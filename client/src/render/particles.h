// Sparks of hits, confetti of goals, and the streak behind a fast ball. Only visual: nothing here
// affects play.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace client {

// As particle.vert reads it.
struct ParticleVertex {
  glm::vec4 position_radius;  // [m]
  glm::vec4 light_opacity;
};

// The material that was hit; it sets the look of the sparks.
enum class Material : std::uint8_t { man, wall, field, goal };

class Particles {
 public:
  // Fewer and dimmer particles, without white flashes.
  void set_reduced(bool reduced) { reduced_ = reduced; }
  // strength 0..1; towards: preferred direction of the sparks, or zero; colour: of the team that
  // hit the ball.
  void spark(Material material, const glm::vec3& at, const glm::vec3& towards,
             const glm::vec3& colour, float strength);
  void celebrate(const glm::vec3& at, const glm::vec3& colour, float strength);
  // Behind a fast ball; colour: of the team that touched it last.
  void streak(const glm::vec3& ball, const glm::vec3& velocity, float radius,
              const glm::vec3& colour, float dt);
  // Dust that the ball raises as it rolls on the field.
  void dust(const glm::vec3& ball, const glm::vec3& velocity, float radius, float dt);
  void step(float dt);  // [s]
  void clear() { alive_.clear(); }
  std::size_t count() const { return alive_.size(); }
  const std::vector<ParticleVertex>& vertices();  // of the live particles

 private:
  struct Particle {
    glm::vec3 position, velocity, colour;
    float radius, age, life, gravity;
    float drag = 0.0f;  // [1/s]
  };
  void add(const Particle& particle);
  float uniform();  // -1..1, from a private generator

  std::vector<Particle> alive_;
  std::vector<ParticleVertex> vertices_;
  std::uint32_t random_ = 0x9E3779B9u;
  bool reduced_ = false;
  float dust_due_ = 0.0f;
};

}  // namespace client
