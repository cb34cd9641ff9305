// The text over the picture, judged by its pixels: it is present, legible, and covers nothing.
// Needs a display.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "client/menu.h"
#include "render/hud.h"
#include "render/hud_replay.h"
#include "render/match_text.h"
#include "render/table_mesh.h"
#include "render/translate.h"
#include "render_rig.h"
#include "scripted_scene.h"
#include "wire/sentence.h"

namespace client {
namespace {

// The text is the same at every quality.
class RenderedText : public RenderTest {};

TEST_P(RenderedText, ScoreAndMessagesAreWritten) {
  wire::Snapshot state = scripted_play(0.35), next = state;
  next.score[0] = 8;
  const glm::ivec2 left_figure{kSize.x / 2 - 40, 34}, right_figure{kSize.x / 2 + 40, 34};
  const draw::Image before = written(state, {}), after = written(next, {});
  EXPECT_GT(changed(before, after, left_figure, 18), 40);
  EXPECT_EQ(changed(before, after, right_figure, 18), 0);
  const draw::Image scored = draw(state, HudState{});
  // Orange digits left of the centre, blue ones right of it.
  const glm::vec3 left = mean(scored, {kSize.x / 2 - 60, 18}, {kSize.x / 2 - 25, 52});
  const glm::vec3 right = mean(scored, {kSize.x / 2 + 25, 18}, {kSize.x / 2 + 60, 52});
  EXPECT_GT(left.r, left.b + 10);
  EXPECT_GT(right.b, right.r + 10);
  HudState lost_hud;
  lost_hud.connection_message = "Physics server lost: waiting at 127.0.0.1:7531";
  const draw::Image lost = draw(state, lost_hud);
  EXPECT_GT(changed(scored, lost, {kSize.x / 2, static_cast<int>(0.42f * kSize.y)}, 60), 2000);
}

TEST_P(RenderedText, OnlyWhoHasJoinedToWatchIsSaidToWatch) {
  const wire::Snapshot state = scripted_play(0.35);
  HudState refused;
  refused.connection_message = "The physics server at 127.0.0.1:7531 refuses";
  const glm::ivec2 corner{45, 22};
  const draw::Image plain = draw(state);
  EXPECT_GT(changed(plain, draw(state, HudState{}), corner, 20), 40);
  EXPECT_EQ(changed(plain, draw(state, refused), corner, 20), 0);
}

TEST_P(RenderedText, EveryScreenHasItsWords) {
  for (std::uint8_t screen = 0; screen < 5; ++screen) {
    wire::Snapshot state = scripted_play(0.35);
    state.screen = screen;
    state.ball_in_play = false;
    const draw::Image plain = draw(state), written = draw(state, HudState{});
    EXPECT_GT(changed(plain, written, kSize / 2, kSize.x), 1500) << int{screen};
  }
}

TEST_P(RenderedText, APlayerIsToldTheKeysWhereAChoiceIsToBeMadeAndWhenAskingForThem) {
  const auto words = [&](const wire::Snapshot& state, int viewer_team, bool asked) {
    HudState hud;
    hud.viewer_team = viewer_team;
    hud.show_help = asked;
    return written(state, hud);
  };
  const auto reported = [&](std::uint8_t screen, bool paused, bool asked) {
    wire::Snapshot state = scripted_play(0.35);
    state.screen = screen;
    state.paused = paused;
    const glm::ivec2 below{kSize.x / 2, kSize.y - 25};
    return changed(words(state, -1, false), words(state, 0, asked), below, 25) > 200;
  };
  EXPECT_TRUE(reported(0, false, false));
  EXPECT_TRUE(reported(1, false, false));
  EXPECT_TRUE(reported(2, true, false));
  EXPECT_FALSE(reported(2, false, false)) << "the view of the play is free";
  EXPECT_TRUE(reported(2, false, true));
}

// The page with its longest texts: of the row, the value and the error.
MenuPage menu_page(Menu::Page page) {
  static SeatsView seats;
  seats.scene = scripted_play(0.35);
  seats.roster.seats = {{1, "me", 0, 1, 2, false}, {2, std::string(64, 'W'), 1, 0x80, 1, true}};
  seats.notices = {{wire::Notice::Level::info, wire::vote_topic(wire::RequestKind::pause, 1),
                    "somebody with a long name asks for a pause: 1 of 3 votes. Ask for it too"}};
  static Crew crew(1, 0, foosball::Layout::tournament, 1);
  static Settings settings;
  Menu menu("/nowhere");
  menu.tuning().update(1, foosball::Tuning{}, true);
  wire::Game game;
  game.waits = true;
  menu.devices().follow(1, true);
  menu.devices().update(scripted_devices(1.0));
  menu.devices().update(scripted_devices(1.5));
  menu.game().update(1, game, true,
                     wire::make_sentence<wire::SentenceId::challenge_characters>().text());
  menu.toggle(page);
  const Menu::Context context{settings, seats, &crew};
  menu.step({.down = page == Menu::Page::tuning ? 28 : 1}, 0, context);
  MenuPage shown = menu.page(context);
  if (page == Menu::Page::tuning)
    shown.problem =
        "/home/somebody/.config/space-foosball/tuning/mine.toml:3: gravity must be a "
        "number from 5 to 30 m/s^2";
  return shown;
}

// The longest texts of the rules and the modes.
void tell_all_rules(wire::Snapshot& state, HudState& hud, int which) {
  state.ball_visible = which % 2 == 0;
  state.mode = number(which % 3 == 0 ? wire::Mode::challenge : wire::Mode::ladder);
  state.computer = {false, true};
  state.rung = which % 2 == 0 ? 4 : 2;
  state.sets = {3, 2};
  state.rule_set = number(wire::RuleSet::itsf);
  state.fouled = state.golden_goal = state.timed = true;
  state.last_foul = number(wire::Foul::time_out);
  hud.since_foul = hud.since_serve = 0.5f;
  hud.set_over = true;
  hud.sets = {{8, 7}, {2, 5}, {5, 1}, {3, 5}, {8, 7}};
}

// Every screen, in windows of every shape, in each language, at the largest text: nothing extends
// beyond an edge (except for the soft rim of a letter).
TEST_P(RenderedText, NothingWrittenIsCutInAnyWindow) {
  constexpr float kRim = 6.0f;  // [px]
  for (const char* language : {"en", "de", "ko"}) {
    use_language(language, CLIENT_CATALOGUES);
    UiBatch words = UiBatch::create(Font::load({}, catalogue_file()).value()).value();
    for (const glm::ivec2 size : {glm::ivec2(480, 640), glm::ivec2(640, 360), glm::ivec2(320, 240),
                                  glm::ivec2(3840, 600), glm::ivec2(1280, 720)}) {
      for (int shown = 0; shown < 5 * 2 * (3 + Menu::kPages); ++shown) {
        wire::Snapshot state = scripted_play(0.35);
        state.screen = static_cast<std::uint8_t>(shown % 5);
        HudState hud;
        hud.state = &state;
        hud.view = shown / 5 % 2 == 0 ? View::seat : View::above;
        hud.camera = player_camera({}, size);
        hud.viewer_team = 0;
        hud.text_scale = kTextScale[1];
        hud.goal = {.team = 1, .scorer_rod = 6, .scorer_man = 1, .own_goal = true, .speed = 12.3f};
        hud.replay = true;
        hud.mouse_free = true;
        hud.starving = true;
        const int more = shown / 10;
        hud.show_help = more == 1;
        tell_all_rules(state, hud, more);
        state.paused = more == 2;
        hud.notices = {
            "the cabinet at /dev/ttyACM0 was unplugged: its rods 4 and 6 hold where they are"};
        if (more == 2) {
          hud.connection_message = "Waiting for the physics server at table.example.org:7531";
          hud.connection_detail =
              "It answers nothing: start it with ./play --server, or name another.";
        }
        if (more >= 3) {
          hud.menu = menu_page(static_cast<Menu::Page>(more - 3));
          hud.rod_names.fill("Maximiliane von und zu");
        }
        draw_hud(words, hud, size);
        const UiBatch::Bounds& b = words.bounds();
        EXPECT_GT(b.low.x, -kRim) << language << " " << size.x << "x" << size.y << " " << shown;
        EXPECT_GT(b.low.y, -kRim) << language << " " << size.x << "x" << size.y << " " << shown;
        EXPECT_LT(b.high.x, static_cast<float>(size.x) + kRim)
            << language << " " << size.x << "x" << size.y << " " << shown;
        EXPECT_LT(b.high.y, static_cast<float>(size.y) + kRim)
            << language << " " << size.x << "x" << size.y << " " << shown;
      }
    }
  }
  use_language("en", CLIENT_CATALOGUES);
}

// The possession clock takes no more space than the board. In the view from the seat, neither they
// nor the lines that stay below them hide any possible position of the ball.
TEST_P(RenderedText, TheClockOfPossessionAndAGoldenGoalHideNoBall) {
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  UiBatch words = UiBatch::create(Font::load().value()).value();
  for (const glm::ivec2 size :
       {glm::ivec2(1280, 720), glm::ivec2(640, 360), glm::ivec2(480, 800)}) {
    for (const View view : {View::seat, View::above}) {
      wire::Snapshot state = scripted_play(0.35);
      HudState hud;
      hud.state = &state;
      hud.view = view;
      hud.viewer_team = 0;
      hud.camera = player_camera({}, size);
      draw_hud(words, hud, size);
      const UiBatch::Bounds before = words.bounds();
      state.rule_set = number(wire::RuleSet::itsf);
      state.possession_team = 1;
      state.ball.position[0] = static_cast<float>(table.rods[4].x);
      ASSERT_TRUE(possession_clock(state));
      draw_hud(words, hud, size);
      const UiBatch::Bounds after = words.bounds();
      EXPECT_EQ(before.low, after.low);
      EXPECT_EQ(before.high, after.high);
      if (view == View::above) continue;
      state.golden_goal = true;
      draw_hud(words, hud, size);
      const float low = words.bounds().high.y;
      ASSERT_GT(low, after.high.y);
      for (int i = 0; i <= 20; ++i) {
        const double x = (i / 20.0 - 0.5) * table.length;
        const float y = static_cast<float>(0.5 * table.width);  // the far wall
        const glm::vec3 ball = hud.camera.project({static_cast<float>(x), y, 0.12f}, size);
        EXPECT_GT(ball.y, low) << size.x << "x" << size.y << " x " << x;
      }
    }
  }
}

// Pixels at which two pictures differ: the additional text of the second.
std::vector<glm::ivec2> added(const draw::Image& before, const draw::Image& after,
                              const glm::ivec2& size) {
  std::vector<glm::ivec2> pixels;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::ivec3 d = glm::abs(before.at(x, y) - after.at(x, y));
      if (d.r + d.g + d.b > 12) pixels.emplace_back(x, y);
    }
  }
  return pixels;
}

// Hints, notices and keys are drawn beside the board, never over it, and in the view from above
// never over the centre of the table.
TEST_P(RenderedText, NothingIsWrittenThroughTheScoreNorFromAboveOverTheGoals) {
  for (const char* language : {"en", "de", "ko"}) {
    use_language(language, CLIENT_CATALOGUES);
    UiBatch words = UiBatch::create(Font::load({}, catalogue_file()).value()).value();
    for (const auto& [size, scale] :
         {std::pair(glm::ivec2(480, 540), 1.0f), std::pair(glm::ivec2(480, 540), 1.6f),
          std::pair(kSize, 1.6f), std::pair(kSize, 1.0f), std::pair(glm::ivec2(320, 240), 1.0f)}) {
      for (const View view : {View::seat, View::above}) {
        wire::Snapshot state = scripted_play(0.35);
        HudState plain;
        plain.viewer_team = 0;
        plain.text_scale = scale;
        plain.view = view;
        HudState hints = plain;
        hints.mouse_free = hints.starving = hints.automatic_rod = true;
        const draw::Image board = written(words, state, plain, size);
        const draw::Image all = written(words, state, hints, size);
        const auto hint = added(board, all, size);
        EXPECT_GT(hint.size(), 500u) << "the hints are written";
        // The board alone is on the grey, slightly darker than it.
        int through = 0, mid_table = 0;
        for (const glm::ivec2& p : hint) {
          through += board.at(p.x, p.y) != glm::ivec3(board.at(size.x / 2, size.y / 2));
          mid_table += std::abs(p.y - size.y / 2) < size.y / 8;
        }
        EXPECT_EQ(through, 0) << language << " " << size.x << "x" << size.y << " " << scale;
        if (view == View::above) {
          EXPECT_EQ(mid_table, 0) << language << " " << size.x << "x" << size.y << " " << scale;
          // The pause's keys are above the board too: its digits stay unchanged.
          wire::Snapshot paused = state;
          paused.paused = true;
          const draw::Image keys = written(words, paused, plain, size);
          int over = 0;
          for (const glm::ivec2& p : added(board, keys, size))
            over += board.at(p.x, p.y) != glm::ivec3(board.at(size.x / 2, size.y / 2));
          EXPECT_EQ(over, 0) << language << " " << size.x << "x" << size.y << " " << scale;
        }
      }
    }
  }
  use_language("en", CLIENT_CATALOGUES);
}

// At the largest text too; in tall windows the lists use the height.
TEST_P(RenderedText, TheKeysOfTheSelectionCoverNobodysChoice) {
  wire::Snapshot state = scripted_play(1.0), ready = state;
  state.screen = ready.screen = number(wire::Screen::selection);
  state.confirmed = {false, false};
  ready.confirmed = {true, true};
  for (const char* language : {"en", "de", "ko"}) {
    use_language(language, CLIENT_CATALOGUES);
    UiBatch words = UiBatch::create(Font::load({}, catalogue_file()).value()).value();
    for (const auto& [size, scale] :
         {std::pair(kSize, 1.0f), std::pair(kSize, 1.6f), std::pair(glm::ivec2(480, 540), 1.6f),
          std::pair(glm::ivec2(320, 540), 1.0f)}) {
      HudState watches, plays;
      watches.recorded = true;  // without keys
      watches.text_scale = plays.text_scale = scale;
      plays.viewer_team = 0;
      const draw::Image without = written(words, state, watches, size);
      int lowest = 0;
      for (const glm::ivec2& p : added(without, written(words, ready, watches, size), size))
        lowest = std::max(lowest, p.y);
      int covered = 0;
      const auto more = added(without, written(words, state, plays, size), size);
      for (const glm::ivec2& p : more) covered += p.y > size.y / 2 && p.y <= lowest;
      EXPECT_GT(more.size(), 500u);
      EXPECT_EQ(covered, 0) << language << " " << size.x << "x" << size.y << " " << scale;
      EXPECT_GT(lowest, 4 * size.y / 5) << language << " " << size.x << "x" << size.y;
    }
  }
  use_language("en", CLIENT_CATALOGUES);
}

TEST_P(RenderedText, TheKeysCanBeReadInANarrowWindow) {
  constexpr glm::ivec2 kNarrow{480, 540};
  const wire::Snapshot state = scripted_play(0.35);
  for (const char* language : {"en", "ko"}) {
    use_language(language, CLIENT_CATALOGUES);
    UiBatch words = UiBatch::create(Font::load({}, catalogue_file()).value()).value();
    HudState asked;
    asked.viewer_team = 0;
    asked.show_help = true;
    const draw::Image image = written(words, state, asked, kNarrow);
    // From below, the first letters are those of "Esc".
    int high = 0;
    for (int y = kNarrow.y - 1; y > kNarrow.y / 2; --y) {
      bool letters = false;
      for (int x = 0; x < kNarrow.x / 2; ++x) letters = letters || image.at(x, y).r > 190;
      if (!letters && high > 0) break;
      high += letters;
    }
    EXPECT_GE(high, 7) << language;  // a capital of a line of 10 px
  }
  use_language("en", CLIENT_CATALOGUES);
}

TEST_P(RenderedText, NoBoardPeeksOutBehindAMenuAndOneNoticeAtMostLiesOverTheFieldFromAbove) {
  const wire::Snapshot state = scripted_play(0.35);
  wire::Snapshot scored = state;
  scored.score = {7, 8};
  HudState plain, menu;
  menu.menu.title = "Settings";
  menu.menu.rows.resize(3);
  EXPECT_FALSE(added(written(state, plain), written(scored, plain), kSize).empty());
  EXPECT_TRUE(added(written(state, menu), written(scored, menu), kSize).empty());
  HudState one, three;
  one.view = three.view = View::above;
  one.notices = {"the newest"};
  three.notices = {"a first sentence", "a second one", "the newest"};
  EXPECT_TRUE(added(written(state, one), written(state, three), kSize).empty());
  one.view = three.view = View::seat;
  EXPECT_FALSE(added(written(state, one), written(state, three), kSize).empty());
}

// Along the vertical centre line of the picture, the result and the questions are separate.
TEST_P(RenderedText, TheQuestionnaireLeavesTheResultFree) {
  wire::Snapshot state = scripted_play(0.35);
  state.screen = number(wire::Screen::end);
  UiBatch words = UiBatch::create(Font::load().value()).value();
  for (const auto& [size, scale] :
       {std::pair(kSize, 1.0f), std::pair(kSize, 1.6f), std::pair(glm::ivec2(640, 360), 1.0f)}) {
    HudState hud;
    hud.viewer_team = 0;
    hud.text_scale = scale;
    hud.survey = {{.kind = SurveyPanel::Kind::consent, .team = 0, .text = "Six short questions?"}};
    const draw::Image image = written(words, state, hud, size);
    const glm::ivec3 grey = image.at(2, size.y / 2);
    std::vector<int> panels;  // height of each [px]
    bool inside = false;
    for (int y = 0; y < size.y; ++y) {
      const bool written_on = image.at(size.x / 2, y) != grey;
      if (written_on && !inside) panels.push_back(0);
      if (written_on) ++panels.back();
      inside = written_on;
    }
    ASSERT_EQ(panels.size(), 2u) << size.x << "x" << size.y << " " << scale;
    EXPECT_GT(panels[0], size.y / 4);
    EXPECT_GT(panels[1], size.y / 8);
  }
}

// Names of any length, in a narrow window: letters as high as those of 11 pixels, and nothing over
// the date, the mark of a kept recording, or the window's edge.
TEST_P(RenderedText, NamesInTheListOfRecordingsAreReadableAndStayInTheirPlace) {
  UiBatch words = UiBatch::create(Font::load().value()).value();
  ReplayList list;
  list.rows.resize(1);
  list.show_keys = false;
  ReplayList::Row& row = list.rows[0];
  row.when = "2026-11-25  10:31";
  row.kept = true;
  row.seconds = 754.0;
  const auto drawn = [&](const char* name, const glm::ivec2& size) {
    row.players = {name, name};
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, size.x, size.y);
    glClear(GL_COLOR_BUFFER_BIT);
    draw_replay_list(words, list, size);
    return draw::read_pixels(size);
  };
  for (const glm::ivec2 size : {glm::ivec2(480, 540), glm::ivec2(640, 360), kSize}) {
    // A date is drawn to its last digit.
    const draw::Image minute = drawn(" ", size);
    row.when.back() = '7';
    EXPECT_FALSE(added(minute, drawn(" ", size), size).empty()) << size.x << "x" << size.y;
    row.when.back() = '1';
    const draw::Image blank = drawn(" ", size);
    const auto name =
        added(blank, drawn("H H H H H H H H H H H H H H H H H H H H H H H H H", size), size);
    ASSERT_FALSE(name.empty());
    const auto place = replay_list_layout(size).rows;
    int low = size.y, high = 0, over = 0;
    for (const glm::ivec2& p : name) {
      low = std::min(low, p.y);
      high = std::max(high, p.y);
      const glm::ivec3 before = blank.at(p.x, p.y);
      over += before.r + before.g + before.b > 240;
      EXPECT_TRUE(place.holds(p)) << p.x << " " << p.y;
    }
    EXPECT_GE(high - low + 1, 8) << size.x << "x" << size.y;  // a capital of 11 px is 8 px high
    EXPECT_EQ(over, 0) << size.x << "x" << size.y;
  }
}

TEST_P(RenderedText, ARodIsSaidToBeHeldLegiblyAndNeverInARecording) {
  wire::Snapshot state = scripted_play(0.35), held = state, recorded = state;
  held.rods[3].status = recorded.rods[3].status = number(wire::RodStatus::held);
  recorded.rods[3].source = number(wire::RodSource::replay);
  const glm::ivec2 small{640, 360};
  camera = player_camera({}, small);
  const draw::Image plain = written(*ui, state, {}, small);
  EXPECT_TRUE(added(plain, written(*ui, recorded, {}, small), small).empty());
  int low = small.y, high = 0;
  const draw::Image said = written(*ui, held, {}, small);
  for (const glm::ivec2& p : added(plain, said, small)) {
    const glm::ivec3 c = said.at(p.x, p.y);
    if (c.r < 200) continue;  // the letters, not their panel
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  EXPECT_GE(high - low + 1, 7);  // capitals of a line of 10 px
}

// The default for the paper's layout: there is no handle to mark.
TEST_P(RenderedText, WhereNoRodsAreDrawnNoHandleIsMarked) {
  const wire::Snapshot state = scripted_play(0.35, foosball::Layout::paper);
  const auto& table = foosball::table_spec(foosball::Layout::paper);
  const glm::ivec2 handle =
      pixel_of({static_cast<float>(table.rods[3].x), handle_offset(table, 3) + state.rods[3].slide,
                static_cast<float>(table.rod_height)});
  HudState plain, marked;
  marked.active_rods = 1u << 3;
  EXPECT_EQ(changed(written(state, plain), written(state, marked), handle, 12), 0);
  marked.rods = RodsShown::on;
  EXPECT_GT(changed(written(state, plain), written(state, marked), handle, 12), 40);
}

INSTANTIATE_TEST_SUITE_P(LowQuality, RenderedText, ::testing::Values(draw::Quality::low));

}  // namespace
}  // namespace client
