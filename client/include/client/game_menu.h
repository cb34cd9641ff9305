// The page of the game: what is played, its rules and opponents. The host chooses; other clients
// see it. No drawing here.
//
// While the requested game differs from the server's, the menu requests it as one message, until
// the server reports it or kTries requests were sent.
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
  static constexpr std::int64_t kSettleUs = 250'000;   // after a step: wait for further steps
  static constexpr std::int64_t kAgainUs = 1'000'000;  // repeat a request without effect
  static constexpr int kTries = 3;

  // Takes the game that the server sent in this session; none: nothing yet. refused: why the server
  // rejected the last request, or empty.
  void update(std::uint64_t session, const std::optional<wire::Game>& reported, bool may_change,
              const std::string& refused);
  int rows() const;
  MenuPage page(int chosen) const;
  // True: end the current match, because another game is waiting.
  bool step(int row, const MenuSteps& steps);
  // The game to request now.
  std::optional<wire::Game> ask(std::int64_t now_us);
  // The game as requested: values that the mode does not leave open are 0.
  wire::Game wanted() const;

 private:
  bool fixed(int row) const;
  std::string note(int row) const;
  MenuRow row(int row) const;
  void change(int row, int way);
  void change_goals(int way);
  void take(const wire::Game& reported);

  std::uint64_t session_ = 0;
  bool may_change_ = false;
  std::optional<wire::Game> reported_;
  wire::Game kept_{};     // as chosen; includes values that the current mode does not use
  bool stepped_ = false;  // since the last ask()
  bool asking_ = false;   // kept_ differs from reported_
  int tries_ = 0;
  std::int64_t next_us_ = 0;
  std::string refused_;
};

}  // namespace client
