// Progress of a run on stderr: a bar that is redrawn on a terminal; otherwise a line every ten
// seconds.
#pragma once

#include <cstdint>
#include <string>

#include "match/executor.h"

namespace app {

class Progress {
 public:
  explicit Progress(bool quiet);
  // Total number of matches, if the schedule does not have all of them yet.
  void expect(std::uint64_t matches) { expected_ = matches; }
  void show(const match::Schedule& schedule, const match::Effort& effort);
  void note(const std::string& line);  // printed without disturbing the bar
  void finish();

 private:
  bool quiet_, terminal_;
  bool drawn_ = false, begun_ = false;
  std::int64_t begun_ns_, shown_ns_ = 0;
  std::uint64_t expected_ = 0;
  std::uint64_t known_ = 0;  // games finished by an earlier run
};

}  // namespace app
