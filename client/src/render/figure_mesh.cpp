#include "render/figure_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/mesh_builder.h"

namespace client {
namespace {

using Part = foosball::ManBox::Part;

const Paint kSuit{glm::vec3(1.0f), 1.0f, 0.48f, 0.0f, 0.0f};
const Paint kSuitDark{glm::vec3(0.42f), 1.0f, 0.55f, 0.0f, 0.0f};
const Paint kShell{glm::vec3(0.80f, 0.82f, 0.85f), 0.0f, 0.30f, 0.0f, 0.0f};
// In the team's colour: from above, the helmet is most of what is visible of an upright man.
const Paint kHelmet{glm::vec3(1.0f), 0.92f, 0.36f, 0.0f, 0.0f};
const Paint kPack{glm::vec3(0.42f, 0.45f, 0.50f), 0.0f, 0.45f, 0.2f, 0.0f};
const Paint kVisor{glm::vec3(0.10f, 0.075f, 0.04f), 0.0f, 0.12f, 0.85f, 0.0f};
const Paint kSteel{glm::vec3(0.55f, 0.57f, 0.60f), 0.0f, 0.30f, 1.0f, 0.0f};
const Paint kSole{glm::vec3(0.05f, 0.055f, 0.065f), 0.0f, 0.7f, 0.0f, 0.0f};

struct PartExtent {
  glm::vec3 centre{0.0f}, half{0.0f};
  float bottom() const { return centre.z - half.z; }
  float top() const { return centre.z + half.z; }
};

PartExtent extent_of(std::span<const foosball::ManBox> boxes, Part part) {
  PartExtent e;
  for (const foosball::ManBox& box : boxes) {
    if (box.part != part) continue;
    for (int i = 0; i < 3; ++i) {
      e.centre[i] = static_cast<float>(box.centre[i]);
      e.half[i] = static_cast<float>(box.half_extents[i]);
    }
  }
  return e;
}

// Hips, waist, chest, shoulders. Narrower than its box by the arms' thickness.
void add_torso(MeshBuilder& b, const PartExtent& t) {
  const float w = t.half.y, d = t.half.x, h = 2.0f * t.half.z, z = t.bottom();
  const auto ring = [&](float share, float width, float depth, float shift) {
    return LoftRing{
        {t.centre.x + shift * d, t.centre.y, z + share * h}, {depth * d, width * w}, 2.8f};
  };
  b.paint(kSuit);
  b.loft(std::array{ring(0.00f, 0.60f, 0.60f, 0.0f), ring(0.06f, 0.72f, 0.76f, 0.0f),
                    ring(0.22f, 0.74f, 0.78f, 0.0f), ring(0.38f, 0.68f, 0.74f, 0.02f),
                    ring(0.60f, 0.78f, 0.86f, 0.06f), ring(0.80f, 0.86f, 0.86f, 0.04f),
                    ring(0.92f, 0.78f, 0.70f, 0.0f), ring(1.00f, 0.44f, 0.46f, 0.0f)},
         18);
  if (b.fine()) {
    b.paint(kSuitDark);  // belt
    b.loft(std::array{ring(0.19f, 0.77f, 0.82f, 0.0f), ring(0.27f, 0.75f, 0.82f, 0.0f)}, 18);
  }
  b.paint(kShell);  // chest unit
  b.rounded_box({t.centre.x + 0.86f * d, t.centre.y, z + 0.66f * h},
                {0.14f * d, 0.34f * w, 0.12f * h}, 0.0012f, 1);
  b.paint(kPack);  // life support on the back
  b.rounded_box({t.centre.x - 0.86f * d, t.centre.y, z + 0.66f * h},
                {0.32f * d, 0.58f * w, 0.27f * h}, 0.0030f);
}

void add_arms(MeshBuilder& b, const PartExtent& t) {
  const float d = t.half.x, h = 2.0f * t.half.z, z = t.bottom();
  const float arm = std::min(0.20f * t.half.y + 0.0016f, 0.0055f);
  for (const float side : {-1.0f, 1.0f}) {
    const float y = t.centre.y + side * (t.half.y - 0.9f * arm);
    b.paint(kSuit);
    if (b.fine())
      b.ellipsoid({t.centre.x, y - side * 0.10f * arm, z + 0.85f * h},
                  {0.50f * d, arm * 1.15f, 0.13f * h}, 10, 8);
    b.loft(
        std::array{
            LoftRing{{t.centre.x + 0.16f * d, y, z + 0.30f * h}, {0.26f * d, 0.72f * arm}, 2.2f},
            LoftRing{{t.centre.x + 0.02f * d, y, z + 0.52f * h}, {0.32f * d, 0.86f * arm}, 2.2f},
            LoftRing{{t.centre.x, y, z + 0.85f * h}, {0.36f * d, arm}, 2.2f}},
        10);
    b.paint(kShell);  // glove
    if (b.fine())
      b.ellipsoid({t.centre.x + 0.20f * d, y, z + 0.25f * h}, {0.32f * d, 0.9f * arm, 0.085f * h},
                  10, 8);
  }
}

glm::vec3 helmet_radii(const PartExtent& head) {
  return {head.half.x + 0.0042f, head.half.y + 0.0042f, head.half.z + 0.0010f};
}

// A light crest on the helmet, which has the team's colour.
void add_crest(MeshBuilder& b, const glm::vec3& at, const glm::vec3& r, int crest) {
  const glm::vec2 along =
      crest == 0 ? glm::vec2(0.72f * r.x, 0.22f * r.y) : glm::vec2(0.22f * r.x, 0.85f * r.y);
  const auto ring = [&](float z, float share) {
    return LoftRing{{at.x - 0.1f * r.x, at.y, at.z + z * r.z}, share * along, 2.5f};
  };
  b.paint(kShell);
  b.loft(std::array{ring(0.72f, 1.0f), ring(0.98f, 0.8f), ring(1.07f, 0.5f)}, 12);
}

void add_headgear(MeshBuilder& b, const glm::vec3& at, const glm::vec3& r, const FigureLook& look) {
  b.paint({look.accent, 0.15f, 0.35f, 0.1f, 0.0f});
  const float wide = r.y;
  switch (look.headgear) {
    case foosball::Headgear::helmet:
      break;
    case foosball::Headgear::antenna:  // two rods with a bulb
      for (const float side : {-1.0f, 1.0f}) {
        b.rounded_box({at.x - 0.3f * r.x, at.y + side * 0.75f * wide, at.z + 0.95f * r.z},
                      {0.0011f, 0.0011f, 0.0060f}, 0.0004f, 1);
        b.ellipsoid({at.x - 0.3f * r.x, at.y + side * 0.75f * wide, at.z + 0.95f * r.z + 0.0066f},
                    glm::vec3(0.0022f), 8, 6);
      }
      break;
    case foosball::Headgear::cap:  // a peak over the eyes
      b.rounded_box({at.x + 0.95f * r.x, at.y, at.z + 0.42f * r.z},
                    {0.50f * r.x, 0.78f * wide, 0.0014f}, 0.0006f, 1);
      break;
    case foosball::Headgear::horns:
      for (const float side : {-1.0f, 1.0f}) {
        const auto ring = [&](float up, float out, float half) {
          return LoftRing{{at.x, at.y + side * out * wide, at.z + up * r.z}, glm::vec2(half), 2.0f};
        };
        b.loft(std::array{ring(0.30f, 0.85f, 0.0028f), ring(0.75f, 1.15f, 0.0020f),
                          ring(1.30f, 1.05f, 0.0006f)},
               8);
      }
      break;
    case foosball::Headgear::hood:  // hangs down the back; the helmet's top stays visible
      b.ellipsoid({at.x - 0.35f * r.x, at.y, at.z - 0.20f * r.z},
                  {0.95f * r.x, 1.08f * wide, 0.86f * r.z}, 14, 10);
      break;
    case foosball::Headgear::bubble:  // a ring around the glass, and a pompon that is visible from
                                      // above
      b.torus({at.x, at.y, at.z - 0.55f * r.z}, 1.15f * r.x, 0.0020f, 14, 6);
      b.ellipsoid({at.x - 0.50f * r.x, at.y, at.z + 0.98f * r.z}, glm::vec3(0.0044f), 10, 8);
      break;
  }
}

void add_face(MeshBuilder& b, const glm::vec3& at, const glm::vec3& r, const FigureLook& look) {
  if (look.face == foosball::Face::visor) {
    b.paint(kVisor);
    b.ellipsoid({at.x + 0.42f * r.x, at.y, at.z + 0.02f * r.z},
                {0.70f * r.x, 0.80f * r.y, 0.60f * r.z}, 16, 10);
    return;
  }
  b.paint({look.skin, 0.0f, 0.55f, 0.0f, 0.0f});
  b.ellipsoid({at.x + 0.36f * r.x, at.y, at.z - 0.04f * r.z},
              {0.74f * r.x, 0.80f * r.y, 0.72f * r.z}, 14, 10);
  const float front = at.x + 1.02f * r.x;
  for (const float side : {-1.0f, 1.0f}) {
    const glm::vec3 eye{front, at.y + side * 0.32f * r.y, at.z + 0.10f * r.z};
    if (look.face == foosball::Face::goggles) {
      b.paint({{0.05f, 0.30f, 0.42f}, 0.0f, 0.12f, 0.6f, 0.0f});
      b.ellipsoid(eye, {0.22f * r.x, 0.30f * r.y, 0.26f * r.z}, 8, 6);
      continue;
    }
    b.paint({glm::vec3(0.92f), 0.0f, 0.4f, 0.0f, 0.0f});
    b.ellipsoid(eye, {0.16f * r.x, 0.23f * r.y, 0.22f * r.z}, 8, 6);
    b.paint({glm::vec3(0.015f), 0.0f, 0.3f, 0.0f, 0.0f});
    b.ellipsoid(eye + glm::vec3(0.12f * r.x, 0, 0), {0.10f * r.x, 0.11f * r.y, 0.12f * r.z}, 8, 6);
  }
  if (look.face == foosball::Face::beard) {
    b.paint({glm::vec3(0.16f, 0.07f, 0.025f), 0.0f, 0.8f, 0.0f, 0.0f});
    b.ellipsoid({at.x + 0.62f * r.x, at.y, at.z - 0.62f * r.z},
                {0.50f * r.x, 0.62f * r.y, 0.42f * r.z}, 10, 8);
  } else {
    b.paint({glm::vec3(0.25f, 0.05f, 0.04f), 0.0f, 0.5f, 0.0f, 0.0f});  // mouth
    b.ellipsoid({front - 0.02f * r.x, at.y, at.z - 0.38f * r.z},
                {0.10f * r.x, 0.28f * r.y, 0.08f * r.z}, 8, 6);
  }
}

void add_head(MeshBuilder& b, const PartExtent& head, const PartExtent& torso,
              const FigureLook& look) {
  const glm::vec3 r = helmet_radii(head);
  b.paint(kHelmet);
  b.ellipsoid(head.centre, r, 20, 14);
  add_headgear(b, head.centre, r, look);
  add_crest(b, head.centre, r, look.crest);
  add_face(b, head.centre, r, look);
  if (!b.fine()) return;
  b.paint(kSteel);
  b.torus({torso.centre.x, torso.centre.y, torso.top() + 0.0005f}, 0.0078f, 0.0017f, 16, 6);
}

// White hoops around head, chest and thighs, wide enough for a man of 50 px: a pattern that needs
// no colour.
void add_stripes(MeshBuilder& b, const PartExtent& head, const PartExtent& torso,
                 const PartExtent& leg) {
  b.paint({glm::vec3(0.92f), 0.0f, 0.5f, 0.0f, 0.0f});
  const auto hoop = [&](const glm::vec3& centre, const glm::vec2& half, float height) {
    b.loft(std::array{LoftRing{centre - glm::vec3(0, 0, 0.5f * height), half, 2.8f},
                      LoftRing{centre + glm::vec3(0, 0, 0.5f * height), half, 2.8f}},
           14);
  };
  const float h = 2.0f * torso.half.z;
  constexpr float kWide = 0.0095f;
  for (const float share : {0.24f, 0.72f}) {
    hoop({torso.centre.x, torso.centre.y, torso.bottom() + share * h},
         {0.95f * torso.half.x, 0.94f * torso.half.y}, kWide);
  }
  hoop({leg.centre.x, leg.centre.y, leg.centre.z + 0.1f * leg.half.z},
       {1.02f * leg.half.x, 1.02f * leg.half.y}, kWide);
  // Above the eyes; the helmet's top keeps the team's colour.
  const glm::vec3 r = helmet_radii(head);
  const auto ring = [&](float up, float out) {
    return LoftRing{
        {head.centre.x, head.centre.y, head.centre.z + up * r.z}, out * glm::vec2(r.x, r.y), 2.0f};
  };
  b.loft(std::array{ring(0.34f, 0.99f), ring(0.66f, 0.80f)}, 16);
}

void add_legs(MeshBuilder& b, const PartExtent& leg, const PartExtent& torso,
              const PartExtent& foot) {
  const float hip = torso.bottom() + 0.003f, ankle = foot.top() - 0.002f;
  const float half = 0.5f * leg.half.y, knee = ankle + 0.5f * (hip - ankle);
  b.paint(kSuit);
  for (const float side : {-1.0f, 1.0f}) {
    const float y = leg.centre.y + side * (half + 0.0001f);
    const auto ring = [&](float z, float width, float depth) {
      return LoftRing{{leg.centre.x, y, z}, {depth * leg.half.x, width * half}, 2.4f};
    };
    b.paint(kSuit);
    b.loft(std::array{ring(ankle, 0.82f, 0.86f), ring(knee - 0.002f, 0.88f, 0.92f),
                      ring(hip, 0.99f, 0.99f)},
           12);
    if (!b.fine()) continue;
    b.paint(kSuitDark);  // knee and ankle joints of the suit
    b.loft(std::array{ring(knee - 0.0028f, 0.90f, 0.93f), ring(knee - 0.0008f, 0.96f, 0.99f),
                      ring(knee + 0.0012f, 0.92f, 0.95f)},
           12);
  }
}

void add_foot(MeshBuilder& b, const PartExtent& foot) {
  const float sole = 0.0035f;
  b.paint(kShell);
  b.rounded_box({foot.centre.x, foot.centre.y, foot.centre.z + 0.5f * sole},
                {foot.half.x, foot.half.y, foot.half.z - 0.5f * sole}, 0.0032f);
  b.paint(kSuit);  // a band of the team's colour around the boot
  b.rounded_box({foot.centre.x, foot.centre.y, foot.top() - 0.0045f},
                {foot.half.x * 0.995f, foot.half.y * 0.995f, 0.0030f}, 0.0012f, 1);
  b.paint(kSole);
  b.rounded_box({foot.centre.x, foot.centre.y, foot.bottom() + 0.5f * sole + 0.0005f},
                {foot.half.x * 0.985f, foot.half.y * 0.985f, 0.5f * sole + 0.0005f}, 0.0010f, 1);
}

// From sRGB (IEC 61966-2-1).
glm::vec3 linear_of(const foosball::Colour& colour) {
  const auto part = [](std::uint8_t code) {
    const float s = static_cast<float>(code) / 255.0f;
    return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
  };
  return {part(colour[0]), part(colour[1]), part(colour[2])};
}

}  // namespace

FigureLook figure_look(const foosball::CharacterLook& look, int team, bool stripes) {
  return {look.headgear,          look.face, linear_of(look.skin),
          linear_of(look.accent), team,      stripes && team == 1};
}

MeshData figure_mesh(std::span<const foosball::ManBox> boxes, float rod_radius,
                     const FigureLook& look, float detail) {
  const PartExtent torso = extent_of(boxes, Part::torso), head = extent_of(boxes, Part::head);
  const PartExtent leg = extent_of(boxes, Part::leg), foot = extent_of(boxes, Part::foot);
  MeshBuilder b(detail);
  add_torso(b, torso);
  add_arms(b, torso);
  add_head(b, head, torso, look);
  if (look.stripes) add_stripes(b, head, torso, leg);
  add_legs(b, leg, torso, foot);
  add_foot(b, foot);
  // The clamp on the rod, as wide as the man, so that every collision box is visible.
  b.paint(kSteel);
  b.transform(axis_along_y());
  const float r = rod_radius + 0.0022f, w = torso.half.y;
  b.turned(
      std::array{ProfilePoint{0.0f, -w}, ProfilePoint{r - 0.001f, -w}, ProfilePoint{r, -w + 0.001f},
                 ProfilePoint{r, w - 0.001f}, ProfilePoint{r - 0.001f, w}, ProfilePoint{0.0f, w}},
      14, true);
  return b.take();
}

}  // namespace client
