// The tuning panel: all values of the match (foosball/tuning.h), changed live by the host, shown to
// all others; profiles of them as files (profile/tuning_profile.h). No drawing here.
//
// What is wanted and not yet what the server says is asked for, one value at a time and no faster
// than a server hears requests, until the server says so or was asked kTries times.
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
  static constexpr std::int64_t kAgainUs = 1'000'000;  // a request without effect is repeated after
  static constexpr int kTries = 3;

  // directory: of the profiles; empty: none are kept.
  explicit TuningMenu(std::string directory);

  // What the server has told in this session; none: nothing yet. What was wanted of another session
  // is forgotten: a server that restarts has its own values.
  void hear(std::uint64_t session, const std::optional<foosball::Tuning>& told, bool may_change);
  void find_profiles();  // anew: files may have come
  int rows() const;
  MenuPage page(int chosen) const;
  void step(int row, const MenuSteps& steps);
  // To be sent now.
  std::vector<wire::MatchRequest> requests(std::int64_t now_us);
  // As it will be when all that is wanted is granted.
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
  std::optional<foosball::Tuning> told_;
  std::array<std::optional<Want>, foosball::kTuningValues> wants_{};
  std::int64_t last_us_ = 0;
  std::size_t next_ = 0;
  std::string problem_, done_;
};

// $XDG_CONFIG_HOME/space-foosball/tuning, or ~/.config/...; empty without either.
std::string tuning_directory();

}  // namespace client
