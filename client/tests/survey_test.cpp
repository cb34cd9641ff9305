// The questionnaire, operated by input events.
#include "client/survey.h"

#include <gtest/gtest.h>

#include "client/crew.h"
#include "scripted_scene.h"

namespace client {
namespace {

using Kind = SurveyPanel::Kind;
constexpr std::int64_t kFrameUs = 16'000;

const SurveyPerson kAlone{.team = 0, .rods = 0x2B, .devices = kAllDevices, .name = "", .number = 0};

// One or several people; the test sets their devices' events for one frame.
class SurveyTest : public testing::Test {
 protected:
  void ask(std::vector<SurveyPerson> people) {
    survey_.ask(3, std::move(people), now_);
    wait(Survey::kDeafUs);
  }
  Survey::Outcome frame(const InputEvents& events = {}, DeviceSet of = kAllDevices) {
    now_ += kFrameUs;
    const auto take = [&](DeviceSet devices) {
      return (devices & of) != 0 ? events : InputEvents{};
    };
    auto outcome = survey_.update(take, &scene_, now_);
    for (const wire::Answers& answers : outcome.answers) answers_.push_back(answers);
    return outcome;
  }
  void wait(std::int64_t us) {
    for (const std::int64_t until = now_ + us; now_ < until;) frame();
  }
  static InputEvents right(int steps) {
    InputEvents events;
    events.presses[index_of(steps > 0 ? Action::spin_right : Action::spin_left)] = std::abs(steps);
    return events;
  }
  static InputEvents push() {
    InputEvents events;
    events.push = true;
    return events;
  }
  void agree() {
    frame(right(1));
    frame(push());
  }
  SurveyPanel panel() const { return survey_.panels(now_).at(0); }

  Survey survey_;
  wire::Snapshot scene_ = scripted_play(0.0);
  std::int64_t now_ = 1'000'000;
  std::vector<wire::Answers> answers_;
};

TEST_F(SurveyTest, IsAnsweredByKeysOneStatementAfterAnother) {
  ask({kAlone});
  EXPECT_EQ(panel().kind, Kind::consent);
  agree();
  for (int question = 0; question < 6; ++question) {
    EXPECT_EQ(panel().question, question);
    EXPECT_EQ(panel().chosen, 0);
    frame(right(question));
    frame(push());
  }
  ASSERT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_[0].match, 3u);
  EXPECT_EQ(answers_[0].rods, 0x2B);
  EXPECT_EQ(answers_[0].scores, (std::array<std::uint8_t, 6>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(panel().kind, Kind::thanks);
  EXPECT_EQ(survey_.devices(now_), 0) << "the hands are free again";
  wait(Survey::kThanksUs + kFrameUs);
  EXPECT_FALSE(survey_.open());
  EXPECT_EQ(answers_.size(), 1u);
}

TEST_F(SurveyTest, NoConsentIsThePresetAndAsksNothing) {
  ask({kAlone});
  frame(push());
  EXPECT_FALSE(survey_.open());
  EXPECT_TRUE(answers_.empty());
}

TEST_F(SurveyTest, NeverIsSaidOnceAndEndsItForAll) {
  SurveyPerson second = kAlone;
  second.devices = bit_of(Device::pad_1);
  SurveyPerson first = kAlone;
  first.devices = bit_of(Device::keys_1);
  ask({first, second});
  frame(right(5), bit_of(Device::keys_1));
  EXPECT_TRUE(frame(push(), bit_of(Device::keys_1)).never);
  EXPECT_FALSE(survey_.open());
}

TEST_F(SurveyTest, WhatIsBrokenOffIsNotKept) {
  InputEvents escape;
  escape.back = true;
  for (int answered = 0; answered < 6; ++answered) {
    ask({kAlone});
    agree();
    for (int i = 0; i < answered; ++i) {
      frame(right(4));
      frame(push());
    }
    frame(escape);
    EXPECT_FALSE(survey_.open()) << answered;
  }
  EXPECT_TRUE(answers_.empty());
}

TEST_F(SurveyTest, WhoDoesNothingIsAskedNoMore) {
  ask({kAlone});
  agree();
  frame(right(3));
  wait(Survey::kIdleUs - 1'000'000);
  EXPECT_TRUE(survey_.open());
  wait(2'000'000);
  EXPECT_FALSE(survey_.open());
  EXPECT_TRUE(answers_.empty());
}

TEST_F(SurveyTest, AllUnansweredIsNoAnswer) {
  ask({kAlone});
  agree();
  for (int i = 0; i < 6; ++i) frame(push());
  EXPECT_TRUE(answers_.empty());
  EXPECT_FALSE(survey_.open());
}

TEST_F(SurveyTest, IsDeafWhileTheHandIsStillInTheMatch) {
  survey_.ask(3, {kAlone}, now_);
  EXPECT_EQ(survey_.devices(now_), 0) << "a push still skips the slow motion";
  frame(right(1));
  frame(push());
  EXPECT_EQ(panel().kind, Kind::consent);
  EXPECT_EQ(panel().chosen, 0);
  wait(Survey::kDeafUs);
  EXPECT_EQ(survey_.devices(now_), kAllDevices);
}

TEST_F(SurveyTest, GoesBackAndTakesNumberKeysWheelMouseAndGamepad) {
  ask({kAlone});
  InputEvents wheel, mouse, pad, number, up, flung;
  wheel.wheel = 1;
  mouse.mouse_right = 2.0 * MenuHand::kMouseStep;
  pad.pad_right = 3;
  number.any_key = '4';
  up.presses[index_of(Action::slide_away)] = 1;
  flung.mouse_forward = 1000.0;
  frame(wheel);
  EXPECT_EQ(panel().chosen, 1);
  frame(push());
  frame(mouse);
  EXPECT_EQ(panel().chosen, 2);
  frame(push());
  frame(pad);
  EXPECT_EQ(panel().chosen, 3);
  InputEvents button;
  button.pad_push = true;
  frame(button);
  frame(number);
  EXPECT_EQ(panel().chosen, 4);
  frame(flung);
  EXPECT_EQ(panel().question, 2) << "a mouse that is pushed away goes nowhere";
  frame(up);
  EXPECT_EQ(panel().question, 1);
  EXPECT_EQ(panel().chosen, 3) << "as it was answered";
  frame(right(-9));
  EXPECT_EQ(panel().chosen, 0);
  frame(right(9));
  EXPECT_EQ(panel().chosen, 5);
}

TEST_F(SurveyTest, PeopleAnswerEachWithTheirOwnDevice) {
  SurveyPerson keys = kAlone, pad = kAlone;
  keys.devices = bit_of(Device::keys_1);
  keys.rods = 0x03;
  pad.devices = bit_of(Device::pad_1);
  pad.rods = 0x28;
  ask({keys, pad});
  for (int i = 0; i < 7; ++i) {
    frame(right(1), keys.devices);
    frame(push(), keys.devices);
  }
  ASSERT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_[0].rods, 0x03);
  EXPECT_EQ(survey_.panels(now_)[1].kind, Kind::consent);
  EXPECT_EQ(survey_.devices(now_), pad.devices);
}

// A cabinet: spinning chooses, waiting confirms, a slide does nothing here.
TEST_F(SurveyTest, IsAnsweredBySpinningTheRodsOfACabinet) {
  ask({{.team = 0, .rods = 0x2B, .devices = 0, .name = "", .number = 0}});
  const auto& table = foosball::table_spec(foosball::Layout::tournament);
  const auto rod = static_cast<std::size_t>(foosball::rods_of_team(table, 0)[1]);
  const auto spin = [&](int steps) {
    scene_.rods[rod].angle -=
        static_cast<float>(foosball::attack_sign(0) * 1.02 * MenuHand::kSpinStep * steps);
    frame();
  };
  frame();
  wait(Survey::kStandUs + kFrameUs);
  EXPECT_EQ(panel().kind, Kind::consent) << "who has not touched a rod has said nothing";
  scene_.rods[rod].slide += 0.05f;
  frame();
  EXPECT_EQ(panel().chosen, 0);
  spin(1);
  EXPECT_EQ(panel().chosen, 1);
  wait(Survey::kStandUs + kFrameUs);
  for (int question = 0; question < 6; ++question) {
    ASSERT_EQ(panel().question, question);
    spin(2);
    wait(Survey::kStandUs / 2);
    spin(1);
    EXPECT_EQ(panel().chosen, 3);
    wait(Survey::kStandUs + kFrameUs);
  }
  ASSERT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_[0].scores, (std::array<std::uint8_t, 6>{3, 3, 3, 3, 3, 3}));
}

}  // namespace
}  // namespace client
