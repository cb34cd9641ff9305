// The computer player of levels and styles: sight, screens and mind, put together.
#include <cmath>
#include <optional>

#include "computer_forecast.h"
#include "computer_impl.h"
#include "computer_mind.h"
#include "computer_screens.h"

namespace foosball {
namespace {

class LevelPlayer final : public ComputerPlayer::Impl {
 public:
  LevelPlayer(const ComputerPlayerDesc& d, const Temperament& t)
      : team_(d.team == 0 ? 0 : 1),
        random_(d.seed),
        screens_(team_, d.opens_match),
        sight_(team_, static_cast<int>(std::lround(t.delay / kTick))),
        mind_(team_, t, d.seed) {
    if (t.forecast_ticks > 0) {
      forecast_.emplace(team_, static_cast<int>(std::lround(t.delay / kTick)), t.forecast_ticks);
    }
  }

  void play(const MatchView& view, RodTargets& targets) override;
  PlayedPass passed() const override { return mind_.passed(); }

 private:
  void come_to(const MatchView& view);
  void hold_or_adopt(const MatchView& view);

  int team_;
  Random random_;
  ComputerScreens screens_;
  ComputerSight sight_;
  ComputerMind mind_;
  std::optional<BallForecast> forecast_;
  bool awake_ = false;
  Screen screen_ = Screen::logo;
};

void LevelPlayer::play(const MatchView& view, RodTargets& targets) {
  come_to(view);
  sight_.look(view);
  auto& rods = mind_.rods();
  bool at_screen = false;
  if (!view.paused) {
    ComputerRod& own = rods[ComputerScreens::kRod];
    at_screen = screens_.work(view, own.slide(), own.swing());
    if (at_screen) {
      mind_.rest();
    } else {
      std::optional<BallGuess> ball;
      if (forecast_) {
        forecast_->set_table(view.layout, view.bodies, view.tuning);
        forecast_->see(sight_.seen());
        ball = forecast_->ball();
      }
      mind_.play(sight_.seen(), view.tuning, view.next_server == team_, ball);
    }
  }
  for (int line = 0; line < 4; ++line) {
    ComputerRod& rod = rods[line];
    RodTarget& target = targets[rod.index()];
    target = {team_slide(team_, rod.slide().position()), team_swing(team_, rod.swing().position()),
              team_slide(team_, rod.slide().rate()), team_swing(team_, rod.swing().rate()),
              at_screen ? line == ComputerScreens::kRod : mind_.holds(line)};
    if (view.paused) target.slide_rate = target.angle_rate = 0.0;
  }
  if (!forecast_) return;
  if (view.paused || at_screen) forecast_->forget();
  forecast_->act(targets);
}

// A new screen; with play, new characters.
void LevelPlayer::come_to(const MatchView& view) {
  const bool play_begins = screen_ != view.screen && view.screen == Screen::play;
  if (!awake_ || play_begins) mind_.set_table(view.layout, view.bodies);
  screen_ = view.screen;
  screens_.see(view, mind_.rods()[ComputerScreens::kRod].swing().position(), random_);
  hold_or_adopt(view);
  awake_ = true;
}

// Takes each rod over where it is: at first, and when something else has moved it far off.
void LevelPlayer::hold_or_adopt(const MatchView& view) {
  for (ComputerRod& rod : mind_.rods()) {
    const RodState& state = view.rods[rod.index()];
    const double slide = team_slide(team_, state.slide);
    const double swing = team_swing(team_, state.angle);
    const bool far = std::fabs(slide - rod.slide().position()) > 0.15 ||
                     std::fabs(swing - rod.swing().position()) > vp::kPi;
    if (!awake_ || far) rod.adopt(slide, swing);
  }
}

}  // namespace

std::unique_ptr<ComputerPlayer::Impl> make_level_player(const ComputerPlayerDesc& desc) {
  Temperament t = temperament_of(desc.player.level, desc.player.style);
  if (desc.judgment) t.judgment = *desc.judgment;
  return std::make_unique<LevelPlayer>(desc, t);
}

}  // namespace foosball
