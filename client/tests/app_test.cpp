#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/frame_meter.h"
#include "app/options.h"
#include "app/view_motion.h"
#include "core/match_story.h"
#include "render/particles.h"
#include "render/table_mesh.h"
#include "scripted_scene.h"
#include "sound/player.h"
#include "wire/enums.h"

namespace client {
namespace {

tl::expected<Options, draw::Leave> parse(std::vector<const char*> words) {
  words.insert(words.begin(), "space-foosball");
  return parse_options(static_cast<int>(words.size()), words.data());
}

TEST(Options, AreTakenAsGiven) {
  const auto o =
      parse({"--server", "table.local:9000", "--team", "watch", "--size", "800x600", "--quality",
             "low", "--seconds", "3.5", "--screenshot", "a.png", "--mute", "--cabinet-gamepads"});
  ASSERT_TRUE(o);
  EXPECT_EQ(o->connection.host, "table.local");
  EXPECT_EQ(o->connection.port, 9000);
  EXPECT_EQ(o->connection.team, wire::kWatchOnly);
  EXPECT_EQ(o->size, glm::ivec2(800, 600));
  EXPECT_EQ(o->quality, draw::Quality::low);
  EXPECT_EQ(o->seconds, 3.5);
  EXPECT_TRUE(o->cabinet_gamepads);
  EXPECT_TRUE(o->mute);
}

TEST(Options, NamesAreGivenOneByOneOrWithCommas) {
  using Names = std::vector<std::string>;
  for (const auto& words : {std::vector<const char*>{"--name", "Ann", "--name", "Ben B"},
                            std::vector<const char*>{"--name", "Ann, Ben  B"}}) {
    const auto o = parse(words);
    ASSERT_TRUE(o) << o.error().text;
    EXPECT_EQ(o->names, (Names{"Ann", "Ben B"}));
  }
  EXPECT_TRUE(parse({})->names.empty()) << "as the settings say";
}

TEST(Options, BadOnesAreOneSentenceAndExitCodeTwo) {
  const std::string too_long(65, 'a');

  const std::vector<std::vector<const char*>> bad{{"--server", "host:0"},
                                                  {"--server", "host:65536"},
                                                  {"--server", "a:b:1"},
                                                  {"--server", ""},
                                                  {"--rods", ""},
                                                  {"--rods", "0"},
                                                  {"--rods", "1.5"},
                                                  {"--rods", "1,,2"},
                                                  {"--name", " "},
                                                  {"--name", "Ann, ,Ben"},
                                                  {"--server", "h:12x"},
                                                  {"--team", "2"},
                                                  {"--size", "1280"},
                                                  {"--size", "0x0"},
                                                  {"--size", "99999x100"},
                                                  {"--quality", "best"},
                                                  {"--seconds", "-1"},
                                                  {"--nonsense"},
                                                  {"--name", ""},
                                                  {"--name", "a,b,c,d,e"},
                                                  {"--name", too_long.c_str()},
                                                  {"--screenshot-at", "1"},
                                                  {"--seconds", "nan"},
                                                  {"--seconds", "inf"},
                                                  {"--seconds", "3x"},
                                                  {"--stats-file", "/"},
                                                  {"--stats-file", "/no such folder/a.json"},
                                                  {"--stats-file", "/proc/a.json"},
                                                  {"--screenshot", "/no such folder/a.png"},
                                                  {"--font-dir", "/no such folder"}};
  for (const auto& words : bad) {
    const auto o = parse(words);
    ASSERT_FALSE(o) << words[0] << " " << (words.size() > 1 ? words[1] : "");
    EXPECT_EQ(o.error().exit_code, 2);
    EXPECT_EQ(std::count(o.error().text.begin(), o.error().text.end(), '\n'), 0);
    EXPECT_NE(o.error().text.find(words[0]), std::string::npos) << o.error().text;
  }
}

TEST(Options, HelpIsNoError) {
  const auto o = parse({"--help"});
  ASSERT_FALSE(o);
  EXPECT_EQ(o.error().exit_code, 0);
  EXPECT_NE(o.error().text.find("--screenshot"), std::string::npos);
}

TEST(FrameMeter, CallsSlowWhatIsSlowOnAverageAfterLoading) {
  FrameMeter meter;
  std::int64_t now = 1'000'000;
  const auto frame = [&](std::int64_t cost) {
    meter.begin(now);
    meter.end(now + cost);
    now += cost;
  };
  for (int i = 0; i < 5; ++i) frame(900'000);  // loading
  for (int i = 0; i < 20; ++i) frame(16'000);
  EXPECT_FALSE(meter.too_slow());
  for (int i = 0; i < 19; ++i) frame(60'000);
  EXPECT_FALSE(meter.too_slow());
  frame(60'000);
  EXPECT_TRUE(meter.too_slow());
  EXPECT_EQ(meter.frames(), 45u);
  EXPECT_NEAR(meter.rate(), 1.0 / 0.060, 1.0);
}

TEST(Sounds, AreHeardEndInSilenceAndNeverClip) {
  for (int i = 0; i < kSounds; ++i) {
    const auto samples = synthesise(static_cast<Sound>(i));
    ASSERT_GT(samples.size(), static_cast<std::size_t>(kSampleRate / 20)) << i;
    int peak = 0;
    for (const std::int16_t s : samples) peak = std::max(peak, std::abs(static_cast<int>(s)));
    EXPECT_GT(peak, 25'000) << i;
    EXPECT_LT(peak, 32'767) << i;
    if (is_loop(static_cast<Sound>(i))) continue;
    EXPECT_LT(std::abs(static_cast<int>(samples.back())), 200) << i;
    double early = 0, late = 0;
    const std::size_t tenth = samples.size() / 10;
    for (std::size_t k = 0; k < tenth; ++k) {
      early += std::abs(static_cast<double>(samples[k]));
      late += std::abs(static_cast<double>(samples[samples.size() - 1 - k]));
    }
    EXPECT_LT(late, 0.25 * early) << i;
  }
}

TEST(Sounds, ALoopGoesOverIntoItsBeginningAsEvenlyAsWithinItself) {
  for (int i = 0; i < kSounds; ++i) {
    if (!is_loop(static_cast<Sound>(i))) continue;
    const auto samples = synthesise(static_cast<Sound>(i));
    int roughest = 0;
    for (std::size_t k = 1; k < samples.size(); ++k)
      roughest = std::max(roughest, std::abs(samples[k] - samples[k - 1]));
    EXPECT_LE(std::abs(samples.front() - samples.back()), roughest) << i;
  }
}

// Loudness increases over the whole range, from the softest touch to the hardest shot: no plateau.
TEST(Sounds, VolumeFollowsImpulseOverTheWholeRangeOfPlay) {
  EXPECT_EQ(volume_of_impulse(0), 0.0f);
  EXPECT_EQ(volume_of_impulse(5), 1.0f);
  // A good shot leaves at 10 m/s. Half of it is 6 dB and more below it, not at full volume.
  const float shot = 0.026f * 10.0f;
  EXPECT_LT(volume_of_impulse(0.5f * shot), 0.80f * volume_of_impulse(shot));
  EXPECT_LT(volume_of_impulse(shot), 0.75f);
  for (float impulse = kSoftestImpulse; impulse < kHardestImpulse; impulse *= 1.5f) {
    const float rise = volume_of_impulse(1.5f * impulse) / volume_of_impulse(impulse);
    EXPECT_GT(rise, 1.05f) << impulse;
    EXPECT_LT(rise, 1.5f) << impulse;
  }
}

TEST(Sounds, TheRollingBallIsHeardByItsSpeed) {
  EXPECT_EQ(rolling_sound(0.0f).volume, 0.0f);
  float before = 0.0f;
  for (const float speed : {0.2f, 0.8f, 2.0f, 5.0f}) {
    EXPECT_GT(rolling_sound(speed).volume, before);
    before = rolling_sound(speed).volume;
  }
  EXPECT_LE(rolling_sound(30.0f).volume, 1.0f);
}

TEST(Particles, AreManyAndColouredByStrengthMaterialAndTeam) {
  const auto sparks = [](Material material, const glm::vec3& colour, float strength) {
    Particles particles;
    particles.spark(material, {0, 0, 0}, {0, 0, 0}, colour, strength);
    glm::vec3 light(0.0f);
    for (const ParticleVertex& v : particles.vertices()) light += glm::vec3(v.light_opacity);
    return std::pair(particles.count(), light);
  };
  const glm::vec3 orange{0.86f, 0.23f, 0.025f}, blue{0.07f, 0.42f, 0.95f};
  EXPECT_GT(sparks(Material::man, orange, 1.0f).first, 60u);
  EXPECT_LT(sparks(Material::man, orange, 0.1f).first, 20u);
  const glm::vec3 warm = sparks(Material::man, orange, 0.6f).second;
  const glm::vec3 cold = sparks(Material::man, blue, 0.6f).second;
  const glm::vec3 turf = sparks(Material::field, orange, 0.6f).second;
  EXPECT_GT(warm.r, 1.5f * warm.b);
  EXPECT_GT(cold.b, cold.r);
  EXPECT_GT(turf.g, turf.r);
  Particles reduced;
  reduced.set_reduced(true);
  reduced.spark(Material::man, {0, 0, 0}, {0, 0, 0}, orange, 1.0f);
  EXPECT_LT(reduced.count(), 40u);
}

TEST(Particles, AFastBallLeavesATrailWithoutGapsAtThirtyFramesASecond) {
  constexpr float kRadius = 0.0173f, kFrame = 1.0f / 30.0f;
  const glm::vec3 velocity{10.0f, 0.0f, 0.0f};
  Particles particles;
  for (int frame = 0; frame < 3; ++frame)
    particles.streak(velocity * (kFrame * static_cast<float>(frame)), velocity, kRadius,
                     {1, 0.5f, 0}, kFrame);
  std::vector<float> places;
  for (const ParticleVertex& v : particles.vertices()) places.push_back(v.position_radius.x);
  std::ranges::sort(places);
  ASSERT_GT(places.size(), 3u);
  for (std::size_t i = 1; i < places.size(); ++i)
    EXPECT_LT(places[i] - places[i - 1], 0.8f * kRadius);  // a bead's radius
}

TEST(Particles, DieAndNeverGrowBeyondTheirBound) {
  Particles particles;
  for (int i = 0; i < 100; ++i) particles.celebrate({0, 0, 0}, {1, 1, 1}, 1.0f);
  EXPECT_GT(particles.count(), 100u);
  EXPECT_LE(particles.count(), 900u);
  for (int i = 0; i < 300; ++i) particles.step(0.016f);
  EXPECT_EQ(particles.count(), 0u);
}

wire::EventSnapshot event_of(wire::EventKind kind, int team, int rod = 0, float value = 0.1f) {
  wire::EventSnapshot event;
  event.kind = number(kind);
  event.team = static_cast<std::uint8_t>(team);
  event.rod = static_cast<std::uint8_t>(rod);
  event.value = value;
  return event;
}

TEST(MatchStory, NamesScorerSaveAndOwnGoal) {
  MatchStory story;
  wire::Snapshot scene = scripted_play(0.0);
  const auto step = [&](std::vector<wire::EventSnapshot> events, float vx) {
    scene.ball.linear_velocity = {vx, 0, 0};
    story.update(events, scene, 0.03f);
  };
  using Kind = wire::EventKind;
  // Team 0 shoots, the goalie of team 1 saves.
  step({event_of(Kind::serve, 0)}, 0.0f);
  step({event_of(Kind::man_hit, 0, 5)}, 8.0f);
  EXPECT_EQ(story.statistics()[0].shots, 1);
  EXPECT_NEAR(story.statistics()[0].fastest_shot, 8.0f, 1e-5);
  step({event_of(Kind::man_hit, 1, 7)}, -1.0f);
  EXPECT_EQ(story.statistics()[1].saves, 1);
  EXPECT_EQ(story.statistics()[1].shots, 0) << "a clearance is no shot";
  // He then scores an own goal.
  wire::EventSnapshot own = event_of(Kind::goal, 0, 7, 1.0f);
  own.own = true;
  step({own}, 1.0f);
  EXPECT_TRUE(story.last_goal().own_goal);
  EXPECT_EQ(story.last_goal().team, 0);
  EXPECT_EQ(story.last_goal().scorer_rod, 7);
  EXPECT_EQ(story.statistics()[1].own_goals, 1);
  ASSERT_EQ(story.moments().size(), 1u);
  EXPECT_EQ(story.moments()[0].moment, Moment::own_goal);
  // Team 1's attack scores.
  step({event_of(Kind::man_hit, 1, 2)}, -9.0f);
  step({event_of(Kind::goal, 1, 2, 9.0f)}, -9.0f);
  EXPECT_FALSE(story.last_goal().own_goal);
  EXPECT_EQ(story.last_goal().scorer_rod, 2);
  // A goal without a touch.
  step({event_of(Kind::serve, 0)}, 0.0f);
  step({event_of(Kind::goal, 1)}, -1.0f);
  EXPECT_FALSE(story.last_goal().own_goal);
  EXPECT_EQ(story.last_goal().scorer_rod, -1);
  // The next match begins with empty statistics.
  scene.screen = number(wire::Screen::selection);
  step({}, 0.0f);
  EXPECT_EQ(story.statistics()[0].shots, 0);
}

TEST(ViewMotion, IsGentleAndComesToRest) {
  ViewMotion motion;
  wire::Snapshot scene = scripted_play(0);
  CameraView last = motion.step(&scene, 0, 0.016f);
  for (int i = 0; i < 600; ++i) {
    scene.ball.position[0] = i % 2 == 0 ? 0.6f : -0.6f;  // the fastest possible rally
    const CameraView view = motion.step(&scene, 0, 0.016f);
    EXPECT_LT(std::abs(view.lean.x - last.lean.x), 0.003f);
    last = view;
  }
  EXPECT_EQ(last.orbit, 0.0f);
}

TEST(Camera, PutsTheOwnGoalOnTheLeftForEitherTeam) {
  const glm::ivec2 screen{1280, 720};
  for (const int team : {0, 1}) {
    CameraView view;
    view.team = team;
    const Camera camera = player_camera(view, screen);
    const float own = team == 0 ? -0.6f : 0.6f;
    EXPECT_LT(camera.project({own, 0, 0}, screen).x, 400);
    EXPECT_GT(camera.project({-own, 0, 0}, screen).x, 880);
    // Away from the person is up in the picture.
    const float away = team == 0 ? 0.3f : -0.3f;
    EXPECT_LT(camera.project({0, away, 0}, screen).y, camera.project({0, -away, 0}, screen).y);
  }
}

// The drawn points of the table and of its handles at the centre of their travel.
std::vector<glm::vec3> all_that_must_be_seen(const foosball::TableSpec& table) {
  std::vector<glm::vec3> points;
  for (const MeshData& mesh : {body_mesh(table, 1.0f), rim_mesh(table, 1.0f)}) {
    for (const MeshVertex& v : mesh.vertices) points.push_back(v.position);
  }
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const foosball::RodSpec& spec = table.rods[static_cast<std::size_t>(rod)];
    const float handle = handle_offset(table, rod);
    for (const MeshVertex& v : rod_mesh(table, rod, 1.0f).vertices) {
      if (std::abs(v.position.y - handle) > 0.07f) continue;
      points.push_back(v.position + glm::vec3(spec.x, 0.0, table.rod_height));
    }
  }
  return points;
}

// The outermost point's distance from the centre, as a fraction of the picture's half: 1 at its
// edge.
float share_taken(const Camera& camera, const std::vector<glm::vec3>& points) {
  float max = 0.0f;
  for (const glm::vec3& point : points) {
    const glm::vec4 clip = camera.view_projection * glm::vec4(point, 1.0f);
    EXPECT_GT(clip.w, 0.0f);
    max = std::max({max, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
  }
  return max;
}

TEST(Camera, ShowsTheWholeTableWithAllHandlesAtMidSlideInEveryWindow) {
  for (const auto layout : {foosball::Layout::paper, foosball::Layout::tournament}) {
    const auto points = all_that_must_be_seen(foosball::table_spec(layout));
    for (const glm::ivec2 screen :
         {glm::ivec2(720, 720), glm::ivec2(1024, 768), glm::ivec2(1280, 800), glm::ivec2(1280, 720),
          glm::ivec2(2160, 1080), glm::ivec2(2520, 1080)}) {
      for (const int team : {0, 1}) {
        for (const float lean : {-kMaxLean, 0.0f, kMaxLean}) {
          const Camera camera =
              player_camera({.layout = layout, .team = team, .lean = {lean, 0.0f}}, screen);
          const float share = share_taken(camera, points);
          EXPECT_LT(share, 0.985f) << screen.x << "x" << screen.y << " team " << team;
          // ... and no farther away than that requires.
          if (lean == 0.0f) {
            EXPECT_GT(share, 0.90f) << screen.x << "x" << screen.y;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace client
