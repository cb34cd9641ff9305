#include "app/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/catalogue.h"

namespace sandbox {
namespace {

tl::expected<Options, draw::Leave> parse(std::vector<const char*> words) {
  words.insert(words.begin(), "vphysics-sandbox");
  return parse_options(static_cast<int>(words.size()), words.data());
}

TEST(SandboxOptions, AreTakenAsGiven) {
  const auto o = parse({"pile1120", "--rate", "240", "--speed", "0.25", "--paused", "--skip-to",
                        "1.5", "--seconds", "2", "--screenshot", "a.png", "--look=-60,25,0.5",
                        "--contacts", "--joints", "--size", "640x480", "--quality", "low"});
  ASSERT_TRUE(o) << o.error().text;
  EXPECT_EQ(o->scene, "pile1120");
  EXPECT_EQ(o->rate, 240);
  EXPECT_EQ(o->speed, 0.25);
  EXPECT_TRUE(o->paused);
  EXPECT_EQ(o->skip_to, 1.5);
  EXPECT_EQ(o->seconds, 2.0);
  EXPECT_EQ(o->screenshot, "a.png");
  ASSERT_TRUE(o->look);
  EXPECT_NEAR(o->look->x, -M_PI / 3, 1e-12);
  EXPECT_NEAR(o->look->y, 25.0 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(o->look->z, 0.5);
  EXPECT_TRUE(o->view.marks.contacts && o->view.marks.normals && o->view.marks.joints);
  EXPECT_FALSE(o->view.marks.shapes || o->view.marks.frames || o->view.marks.impulses);
  EXPECT_EQ(o->size, glm::ivec2(640, 480));
  EXPECT_EQ(o->quality, draw::Quality::low);
}

TEST(SandboxOptions, BadOnesAreOneSentenceThatNamesThemAndExitCodeTwo) {
  const std::vector<std::vector<const char*>> bad{{"--rate", "0"},
                                                  {"--rate", "9"},
                                                  {"--rate", "10001"},
                                                  {"--rate", "fast"},
                                                  {"--rate", "nan"},
                                                  {"--speed", "0"},
                                                  {"--speed", "-1"},
                                                  {"--speed", "inf"},
                                                  {"--seconds", "0"},
                                                  {"--seconds", "nan"},
                                                  {"--seconds", "1e9"},
                                                  {"--skip-to", "-1"},
                                                  {"--skip-to", "3", "--seconds", "2"},
                                                  {"--skip-to", "3", "--no-window"},
                                                  {"--screenshot-at", "1"},
                                                  {"--screenshot", "/no such folder/a.png"},
                                                  {"--screenshot", "a.png", "--no-window"},
                                                  {"--paused", "--no-window"},
                                                  {"--stats-file", "/no such folder/a.json"},
                                                  {"--look", "12"},
                                                  {"--look", "12,90"},
                                                  {"--look", "nan,0"},
                                                  {"--look", "0,0,0"},
                                                  {"--look", "1,2,3,4"},
                                                  {"--look", "1;2"},
                                                  {"--size", "0x0"},
                                                  {"--size", "1280"},
                                                  {"--quality", "best"},
                                                  {"--font-dir", "/no such folder"},
                                                  {"--nonsense"}};
  for (const auto& words : bad) {
    const auto o = parse(words);
    ASSERT_FALSE(o) << words[0] << " " << (words.size() > 1 ? words[1] : "");
    EXPECT_EQ(o.error().exit_code, 2);
    EXPECT_EQ(std::count(o.error().text.begin(), o.error().text.end(), '\n'), 0);
    EXPECT_NE(o.error().text.find(words[0]), std::string::npos) << o.error().text;
  }
}

TEST(SandboxOptions, HelpNamesEveryOptionAndTheListEveryScene) {
  const auto help = parse({"--help"});
  ASSERT_FALSE(help);
  EXPECT_EQ(help.error().exit_code, 0);
  for (const char* option : {"--screenshot", "--skip-to", "--rate", "--contacts", "--wires"})
    EXPECT_NE(help.error().text.find(option), std::string::npos) << option;
  const auto list = parse({"--list"});
  ASSERT_FALSE(list);
  EXPECT_EQ(list.error().exit_code, 0);
  for (const scenes::Entry& entry : scenes::catalogue())
    EXPECT_NE(list.error().text.find(entry.name), std::string::npos) << entry.name;
}

}  // namespace
}  // namespace sandbox
