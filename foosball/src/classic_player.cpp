// The first computer player, kept as it was: a fixed opponent to measure others by. Moves all four
// rods at once, which no person can.
#include <cmath>

#include "classic_tactics.h"
#include "computer_impl.h"
#include "computer_screens.h"
#include "computer_sight.h"

namespace foosball {
namespace {

class ClassicPlayer final : public ComputerPlayer::Impl {
 public:
  explicit ClassicPlayer(const ComputerPlayerDesc& d)
      : team_(d.team == 0 ? 0 : 1),
        temper_(temper_of(std::isfinite(d.player.skill) ? d.player.skill : 0.0)),
        random_(d.seed),
        screens_(team_, d.opens_match),
        sight_(team_, static_cast<int>(temper_.delay / kTick)) {}

  void play(const MatchView& view, RodTargets& targets) override;

 private:
  void come_to(const MatchView& view);
  void hold_or_adopt(const MatchView& view);

  int team_;
  Temper temper_;
  Random random_;
  ComputerScreens screens_;
  ComputerSight sight_;
  std::vector<RodTactics> rods_;  // from its own goal outwards
  Layout layout_ = Layout::tournament;
};

void ClassicPlayer::play(const MatchView& view, RodTargets& targets) {
  come_to(view);
  sight_.look(view);
  const TableSpec& table = table_spec(view.layout);
  if (!view.paused) {
    RodTactics& own = rods_[ComputerScreens::kRod];
    if (!screens_.work(view, own.slide(), own.swing())) {
      for (RodTactics& rod : rods_) rod.play(table, sight_.now(), temper_, random_);
    }
  }
  const auto indices = rods_of_team(table, team_);
  for (std::size_t line = 0; line < rods_.size(); ++line) {
    const HandAxis& slide = rods_[line].slide();
    const HandAxis& swing = rods_[line].swing();
    RodTarget& target = targets[indices[line]];
    target = {team_slide(team_, slide.position()), team_swing(team_, swing.position()),
              team_slide(team_, slide.rate()), team_swing(team_, swing.rate()), true};
    if (view.paused) target.slide_rate = target.angle_rate = 0.0;
  }
}

// A new table or a new screen.
void ClassicPlayer::come_to(const MatchView& view) {
  if (rods_.empty() || layout_ != view.layout) {
    layout_ = view.layout;
    rods_.clear();
    for (const int rod : rods_of_team(table_spec(layout_), team_)) rods_.emplace_back(team_, rod);
  }
  screens_.see(view, rods_[ComputerScreens::kRod].swing().position(), random_);
  hold_or_adopt(view);
}

// Takes each rod over where it is: at first, and when something else has moved it far off.
void ClassicPlayer::hold_or_adopt(const MatchView& view) {
  const auto indices = rods_of_team(table_spec(layout_), team_);
  for (std::size_t line = 0; line < rods_.size(); ++line) {
    RodTactics& rod = rods_[line];
    const RodState& state = view.rods[indices[line]];
    const double slide = team_slide(team_, state.slide);
    const double swing = team_swing(team_, state.angle);
    const bool far = std::fabs(slide - rod.slide().position()) > 0.15 ||
                     std::fabs(swing - rod.swing().position()) > vp::kPi;
    if (!rod.adopted() || far) rod.adopt(slide, swing);
  }
}

}  // namespace

std::unique_ptr<ComputerPlayer::Impl> make_classic_player(const ComputerPlayerDesc& desc) {
  return std::make_unique<ClassicPlayer>(desc);
}

}  // namespace foosball
