// The page of the game: what is played, by which rules and against whom, chosen by the host, shown
// to all others. No drawing here.
//
// What is wanted and not yet what the server says is asked for, as a whole, until the server says
// so or was asked kTries times.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/menu_page.h"
#include "foosball/game_setup.h"
#include "wire/control.h"

namespace client {

class GameMenu {
 public:
  static constexpr std::int64_t kSettleUs = 250'000;   // after a step: others may follow
  static constexpr std::int64_t kAgainUs = 1'000'000;  // a request without effect is repeated after
  static constexpr int kTries = 3;

  // What the server has told in this session; none: nothing yet. refused: why it took the last
  // request not, or empty.
  void hear(std::uint64_t session, const std::optional<wire::Game>& told, bool may_change,
            const std::string& refused);
  int rows() const;
  MenuPage page(int chosen) const;
  // True: the match in hand is to end, for the game that waits.
  bool step(int row, const MenuSteps& steps);
  // To be sent now.
  std::optional<wire::Game> ask(std::int64_t now_us);
  // As it is asked for: what the mode does not leave to be chosen is 0.
  wire::Game wanted() const;

 private:
  bool fixed(int row) const;
  std::string note(int row) const;
  MenuRow row(int row) const;
  void change(int row, int way);
  void change_goals(int way);
  void take(const wire::Game& told);

  std::uint64_t session_ = 0;
  bool may_change_ = false;
  std::optional<wire::Game> told_;
  wire::Game kept_{};     // as chosen, also what another mode than the one in hand takes of it
  bool stepped_ = false;  // since ask() was called
  bool asking_ = false;   // kept_ is not yet what is told
  int tries_ = 0;
  std::int64_t next_us_ = 0;
  std::string refused_;
};

}  // namespace client
