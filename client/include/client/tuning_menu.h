// The tuning panel: all values of the match (foosball/tuning.h), and profiles of them as files
// (profile/tuning_profile.h). The host changes them live; other clients see them. No drawing here.
//
// While a requested value differs from the server's, the panel requests it, one value at a time and
// no faster than a server accepts requests, until the server reports it or kTries requests were
// sent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/menu_page.h"
#include "foosball/tuning.h"
#include "wire/control.h"

namespace client {

class TuningMenu {
 public:
  static constexpr std::int64_t kEveryUs = 60'000;     // between two requests
  static constexpr std::int64_t kAgainUs = 1'000'000;  // repeat a request without effect
  static constexpr int kTries = 3;

  // directory: of the profiles; empty: no profiles are stored.
  explicit TuningMenu(std::string directory);

  // Takes the tuning that the server sent in this session; none: nothing yet. Requests of another
  // session are dropped: a server that restarts has its own values.
  void update(std::uint64_t session, const std::optional<foosball::Tuning>& reported,
              bool may_change);
  void find_profiles();  // reads the directory again, for new files
  int rows() const;
  MenuPage page(int chosen) const;
  void step(int row, const MenuSteps& steps);
  // The requests to send now.
  std::vector<wire::MatchRequest> requests(std::int64_t now_us);
  // The tuning when all pending requests are granted.
  foosball::Tuning wanted() const;

 private:
  struct Want {
    double value = 0.0;
    int tries = 0;
    std::int64_t asked_us = 0;
  };
  void want(int index, double value);
  void want_all(const foosball::Tuning& tuning);
  void load();
  void save();
  std::string path() const;

  std::string directory_;
  std::vector<std::string> profiles_;  // names
  std::size_t profile_ = 0;
  std::uint64_t session_ = 0;
  bool may_change_ = false;
  std::optional<foosball::Tuning> reported_;
  std::array<std::optional<Want>, foosball::kTuningValues> wants_{};
  std::int64_t last_us_ = 0;
  std::size_t next_ = 0;
  std::string problem_, done_;
};

// $XDG_CONFIG_HOME/space-foosball/tuning, or ~/.config/...; empty if neither variable is set.
std::string tuning_directory();

}  // namespace client
