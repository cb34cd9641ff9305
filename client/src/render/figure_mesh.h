// Meshes of the men: astronauts, lofted around the boxes of the collision model, so that the drawn
// shape matches what collides. In the man's frame: origin on the rod's axis, facing +x, feet down
// at angle 0.
#pragma once

#include <span>

#include "foosball/table.h"
#include "render/mesh_data.h"

namespace client {

// How far a helmet with its gear or a backpack may extend beyond its box [m]; legs and feet never
// do.
inline constexpr float kFigureOverhang = 0.011f;

// A character's look. The team sets the shape of the crest, so that teams differ in more than their
// colours.
struct FigureLook {
  foosball::Headgear headgear = foosball::Headgear::helmet;
  foosball::Face face = foosball::Face::visor;
  glm::vec3 skin{0.62f, 0.40f, 0.26f};    // linear rgb
  glm::vec3 accent{0.80f, 0.82f, 0.85f};  // of gloves, boots, headgear
  int crest = 0;                          // 0: a fin from front to back; 1: a bar from side to side
  bool stripes = false;                   // hoops around body and legs
};
FigureLook figure_look(const foosball::CharacterLook& look, int team, bool stripes);

MeshData figure_mesh(std::span<const foosball::ManBox> boxes, float rod_radius,
                     const FigureLook& look, float detail);

}  // namespace client
