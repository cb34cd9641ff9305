// The original computer player, unchanged: a fixed reference opponent. It moves all four rods at
// once, which no person can.
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

  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) override;

 private:
  void come_to(const MatchView& view);
  void hold_or_adopt(const MatchView& view);
  bool is_own(std::size_t line) const { return (lines_ >> line & 1) != 0; }

  int team_;
  Temper temper_;
  Random random_;
  ComputerScreens screens_;
  ComputerSight sight_;
  std::vector<RodTactics> rods_;  // in order from its own goal
  Layout layout_ = Layout::tournament;
  std::uint8_t lines_ = 0, before_ = 0;  // its lines now and in the previous tick, as bits by Line
};

void ClassicPlayer::play(const MatchView& view, RodTargets& targets, std::uint8_t rods) {
  lines_ = lines_of(view.layout, team_, rods);
  if (lines_ == 0) {
    sight_.forget();
    before_ = 0;
    return;
  }
  come_to(view);
  sight_.look(view);
  const TableSpec& table = table_spec(view.layout);
  if (!view.paused && ComputerScreens::worked_at(view.screen)) {
    RodTactics& own = rods_[ComputerScreens::kRod];
    if (lines_ == kAllLines) screens_.work(view, own.slide(), own.swing());
  } else if (!view.paused) {
    for (std::size_t line = 0; line < rods_.size(); ++line) {
      if (is_own(line)) rods_[line].play(table, sight_.now(), temper_, random_);
    }
  }
  const auto indices = rods_of_team(table, team_);
  for (std::size_t line = 0; line < rods_.size(); ++line) {
    if (!is_own(line)) continue;
    const HandAxis& slide = rods_[line].slide();
    const HandAxis& swing = rods_[line].swing();
    RodTarget& target = targets[indices[line]];
    target = {team_slide(team_, slide.position()), team_swing(team_, swing.position()),
              team_slide(team_, slide.rate()), team_swing(team_, swing.rate()), true};
    if (view.paused) target.slide_rate = target.angle_rate = 0.0;
  }
}

// Handles a new table or a new screen.
void ClassicPlayer::come_to(const MatchView& view) {
  if (rods_.empty() || layout_ != view.layout) {
    layout_ = view.layout;
    rods_.clear();
    before_ = 0;
    for (const int rod : rods_of_team(table_spec(layout_), team_)) rods_.emplace_back(team_, rod);
  }
  screens_.see(view, rods_[ComputerScreens::kRod].swing().position(), random_);
  hold_or_adopt(view);
  before_ = lines_;
}

// Takes over a rod at its current position when it becomes its own, or when something else has
// moved it far away.
void ClassicPlayer::hold_or_adopt(const MatchView& view) {
  const auto indices = rods_of_team(table_spec(layout_), team_);
  for (std::size_t line = 0; line < rods_.size(); ++line) {
    RodTactics& rod = rods_[line];
    const RodState& state = view.rods[indices[line]];
    const double slide = team_slide(team_, state.slide);
    const double swing = team_swing(team_, state.angle);
    const bool far = std::fabs(slide - rod.slide().position()) > 0.15 ||
                     std::fabs(swing - rod.swing().position()) > vp::kPi;
    if ((before_ >> line & 1) == 0 || far) rod.adopt(slide, swing);
  }
}

}  // namespace

std::unique_ptr<ComputerPlayer::Impl> make_classic_player(const ComputerPlayerDesc& desc) {
  return std::make_unique<ClassicPlayer>(desc);
}

}  // namespace foosball
