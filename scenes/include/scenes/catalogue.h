// Scenes by name, and their builders with size parameters. Positions come from formulas and from a
// fixed-seed generator of the project: the same bits on every machine.
#pragma once

#include <span>
#include <string_view>

#include "scenes/scene.h"
#include "vphysics/error.h"

namespace scenes {

struct Entry {
  std::string_view name;
  std::string_view what;  // a description of one line
};
// In the order in which they are shown.
std::span<const Entry> catalogue();
// A scene of the catalogue, or "heapN": N boxes poured into a pit, 1 <= N <= 1,000,000.
vp::Expected<Scene> make_scene(std::string_view name);

// --- stacks of 1 m boxes of density 1000 on a floor
Scene towers(int along_x, int along_y, int height);
// A pyramid of boxes in the xz plane, one box thick.
Scene pyramid(int base);
// The pyramid. After a second, a 10 t sphere of radius 1 m hits it at 50 m/s along +y.
Scene wall(int base);

// --- poured into a pit with walls
enum class Pour : std::uint8_t {
  boxes,
  mixed,  // boxes, spheres and capsules in turn
};
// 17 or 18 layers fall into a pit whose square floor grows with the count.
Scene pile(int count, Pour what);
// The side of the pit's floor [m].
double pit_side(int count);
inline constexpr int kRagdollBodies = 12;
Scene ragdolls(int along_x, int along_y, int layers);

// --- with joints
// Capsules of 0.2 m hang by ball joints from a fixed block, tilted from the vertical by `tilt`
// [rad]. A sphere of about 1000 times a link's mass hangs at the end.
Scene chain(int links, double tilt);
// Balls in a square, hung from the fixed balls of the uppermost row and joined by ball joints half
// way to their neighbours: after Box3D's benchmark of joints. There the balls do not collide.
Scene joint_grid(int side);
// Planks joined by hinges between two fixed blocks, in their equilibrium shape. Crates fall on
// them.
Scene bridge(int planks, int crates);
Scene cradle(int balls);

// --- small scenes
Scene card_house(int storeys);
Scene dominoes(int count);
Scene heavy_on_light(double ratio);
Scene t_handle();
// Boxes with friction from 0.40 to 0.60, two of them 1% below and above 0.5, on slopes of the same
// friction whose tangent is 0.5.
Scene ramp();
// Spheres with restitution 0, 0.1 .. 1 fall by 1 m.
Scene bounce();
Scene conveyor();

// --- shapes of many parts
// Spheres, capsules and boxes are released on the slopes of a bowl with hills in it.
Scene hills(int count);
// Tables, jacks and dumbbells, each one compound, poured into a pit.
Scene furniture(int along, int layers);

// --- after Box3D's benchmark
// Groups of ragdolls fall on a square of along x along fields, each with a ring of triangles. A
// column of groups appears every 0.8 s. Once all columns exist, the oldest one is destroyed and
// created again.
Scene rain(int along, int group);
// Trees, each one compound of 22 prisms, fall to both sides on waves of triangles, 150 x 200 m.
Scene trees(int count, int cells_per_metre);
// along^3 cubes in a rotating drum of hulls.
Scene washer(int along);
// Stones of one shape, hulls of 32 points, stacked along x along in many layers, collapse.
Scene convex_pile(int along, int layers);
// Stones, hulls of 10 points, fall into a yard with walls, where a column that moves on a circle
// pushes them.
Scene junkyard(int along, int layers);
// As pyramid(), with boxes of density 100 that touch their neighbours.
Scene large_pyramid(int base);

// --- kinematic motion
// pyramid() on a table that oscillates along x, by 5 mm at 3 Hz.
Scene shaken_pyramid(int base);
// pile() with a paddle that rotates on the pit's floor.
Scene stirred_pile(int count);

}  // namespace scenes
