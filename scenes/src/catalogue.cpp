#include "scenes/catalogue.h"

#include <charconv>

#include "scenes/touchstone.h"

namespace scenes {
namespace {

struct Builder {
  Entry entry;
  Scene (*build)();
};

constexpr double kTilted = 0.5;  // initial tilt of chain200 [rad]

// First the scenes of the comparison with other engines, in the order of its report.
constexpr Builder kBuilders[] = {
    {{"towers1120", "8 x 14 towers of 10 boxes"}, [] { return towers(8, 14, 10); }},
    {{"pyramid1128", "a wall pyramid of 1128 boxes, base 47"}, [] { return pyramid(47); }},
    {{"pile1120", "boxes, spheres and capsules poured into a pit of 10 x 10 m"},
     [] { return pile(1120, Pour::mixed); }},
    {{"wall1128", "the pyramid, hit by a 10 t sphere at 50 m/s"}, [] { return wall(47); }},
    {{"pile10k", "10,000 boxes poured into a pit of 30 x 30 m"},
     [] { return pile(10000, Pour::boxes); }},
    {{"ragdolls", "100 figures of 12 bodies let fall into a pit"},
     [] { return ragdolls(5, 5, 4); }},
    {{"chain200", "200 links swing a weight of 1000 links' mass"},
     [] { return chain(200, kTilted); }},
    {{"bridge", "100 hinged planks, crates falling on them"}, [] { return bridge(100, 20); }},
    {{"tower10", "one tower of 10 boxes"}, [] { return towers(1, 1, 10); }},
    {{"pyramid10", "a wall pyramid of 55 boxes"}, [] { return pyramid(10); }},
    {{"cards", "a house of cards of three storeys"}, [] { return card_house(3); }},
    {{"dominoes", "60 dominoes in a bow, the first one tipping"}, [] { return dominoes(60); }},
    {{"cradle", "Newton's cradle of 5 balls"}, [] { return cradle(5); }},
    {{"heavy", "a box on one of a thousandth of its mass"}, [] { return heavy_on_light(1000.0); }},
    {{"handle", "a T-handle turning about its middle axis, which flips"},
     [] { return t_handle(); }},
    {{"ramp", "boxes on slopes on both sides of their angle of friction"}, [] { return ramp(); }},
    {{"bounce", "balls of restitution 0 to 1 let fall by 1 m"}, [] { return bounce(); }},
    {{"conveyor", "crates on turning rollers, and balls that roll down a board"},
     [] { return conveyor(); }},
    {{"hills", "60 bodies let loose on the slopes of a bowl with hills in it"},
     [] { return hills(60); }},
    {{"furniture", "75 tables, jacks and dumbbells poured into a pit"},
     [] { return furniture(5, 3); }},
    {{"plumb", "20 links hanging straight under 1000 links' mass"}, [] { return chain(20, 0.0); }},
    {{"catenary", "20 hinged planks hanging in equilibrium"}, [] { return bridge(20, 0); }},
    {{"joint_grid", "a curtain of 100 x 100 balls on 19,701 ball joints"},
     [] { return joint_grid(100); }},
    {{"rain", "ragdolls rain on fields and rings of triangles, come and go"},
     [] { return rain(10, 3); }},
    {{"trees100", "50 trees of 22 hulls fall on waves of triangles of 1 m"},
     [] { return trees(50, 1); }},
    {{"trees25", "the same on triangles of 0.25 m"}, [] { return trees(50, 4); }},
    {{"washer", "8000 cubes in a drum that turns"}, [] { return washer(20); }},
    {{"convex_pile", "5120 hulls of 32 points collapse into a pile"},
     [] { return convex_pile(8, 80); }},
    {{"junkyard", "10,584 stones in a yard, pushed by a column on a circle"},
     [] { return junkyard(21, 24); }},
    {{"large_pyramid", "a wall pyramid of 5050 light boxes, base 100"},
     [] { return large_pyramid(100); }},
    {{"shaken_pyramid", "the pyramid of 1128 boxes on a table that shakes"},
     [] { return shaken_pyramid(47); }},
    {{"stirred_pile", "boxes, spheres and capsules in a pit, stirred by a paddle"},
     [] { return stirred_pile(1120); }},
    {{"touchstone", "bodies whose motion is known in closed form"},
     [] { return touchstone().scene; }},
    {{"touchstone-joined", "pendulums and limits known in closed form"},
     [] { return joined_touchstone().scene; }},
};
constexpr std::size_t kCount = std::size(kBuilders);

constexpr std::string_view kHeap = "heap";
constexpr int kLargestHeap = 1'000'000;

vp::Expected<Scene> make_heap(std::string_view digits) {
  int count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  if (error != std::errc() || end != digits.data() + digits.size() || count < 1 ||
      count > kLargestHeap) {
    return tl::make_unexpected(vp::Error{vp::Errc::invalid_argument,
                                         "a heap is asked for as heapN, with N from 1 to 1000000"});
  }
  return pile(count, Pour::boxes);
}

}  // namespace

std::span<const Entry> catalogue() {
  static const std::vector<Entry> kEntries = [] {
    std::vector<Entry> entries;
    for (const Builder& b : kBuilders) entries.push_back(b.entry);
    return entries;
  }();
  return kEntries;
}

vp::Expected<Scene> make_scene(std::string_view name) {
  const auto named = [&](Scene scene) {
    scene.name = name;
    return scene;
  };
  for (std::size_t i = 0; i < kCount; ++i) {
    if (kBuilders[i].entry.name == name) return named(kBuilders[i].build());
  }
  if (name.starts_with(kHeap)) return make_heap(name.substr(kHeap.size())).map(named);
  std::string sentence = "there is no scene \"";
  sentence.append(name).append("\"; there are:");
  for (const Builder& b : kBuilders) sentence.append(" ").append(b.entry.name);
  sentence.append(", and heapN for N boxes in a pit");
  return tl::make_unexpected(vp::Error{vp::Errc::invalid_argument, sentence});
}

}  // namespace scenes
