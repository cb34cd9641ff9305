// Choosing and watching recordings without a window: events in, data to be drawn out. Files are
// read in the background; the window never waits for one.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "background.h"
#include "client/settings.h"
#include "commands.h"
#include "player.h"
#include "server/recordings.h"

namespace watch {

struct SessionOptions {
  std::string folder = {};    // of the list; empty: one file only
  std::string file = {};      // opened at once; empty: the list first
  std::string share_to = {};  // folder for copies
  double from = 0.0;          // [s] of the file
  client::View view = client::View::seat;
};

class Session {
 public:
  explicit Session(SessionOptions options);

  // size: of the window's framebuffer [px].
  void resize(const glm::ivec2& size) { size_ = size; }
  void key(int key, bool shift);
  void pointer(const PointerEvent& event);
  void pad(const client::InputEvents& events);
  void act(Command command);
  // dt [s] of the clock. Takes the results of background work and advances the playback.
  void step(double dt);

  bool over() const { return over_; }  // the person has left
  bool reading() const { return listing_.running() || opening_.running(); }
  void wait() const;  // for background reading: for tests, and for a picture of the first moment
  Player* player() { return player_.get(); }  // null: the list is shown
  const Player* player() const { return player_.get(); }
  // Another recording was opened since the last call.
  bool take_opened() { return std::exchange(opened_, false); }
  bool take_picture() { return std::exchange(picture_, false); }  // a picture was requested
  client::View view() const { return view_; }
  int team() const { return team_; }  // side of the camera
  bool hidden() const { return hidden_; }
  const std::string& shared_to() const { return options_.share_to; }

  // The data to be drawn. Precondition of bar(): player().
  const client::ReplayList& list() const { return list_; }
  client::ReplayBar bar() const;
  // A line for a log: the position in the recording, or the chosen row.
  std::string state() const;
  // Shows a message for a while; text: in the person's language.
  void show_message(const std::string& text, bool warning);
  // Why the first file could not be opened; empty: no error so far.
  const std::string& first_problem() const { return first_problem_; }

 private:
  using Listed = tl::expected<std::vector<server::RecordingSummary>, std::string>;
  using Opened = tl::expected<std::unique_ptr<Timeline>, std::string>;
  using Copied = tl::expected<std::string, std::string>;

  void read_folder();
  void take_list(Listed listed);
  void take_recording(Opened opened);
  void open(const std::string& path);
  void leave();
  void keep();
  void copy();
  void choose(int row);
  void scroll(int rows);
  void press(const glm::vec2& at);
  std::string path() const;  // that keep and share apply to; empty: none

  SessionOptions options_;
  glm::ivec2 size_{1280, 720};
  client::ReplayList list_;
  std::vector<server::RecordingSummary> recordings_;  // by row
  Background<Listed> listing_;
  Background<Opened> opening_;
  Background<Copied> copying_;
  std::unique_ptr<Player> player_;
  client::View view_;
  int team_ = 0;
  bool over_ = false, hidden_ = false, show_keys_ = false, opened_ = false, picture_ = false;
  bool kept_ = false, verdict_shown_ = false;
  double stick_ = 0.0, wheel_ = 0.0;
  double seconds_ = 0.0, message_until_ = 0.0;
  std::string message_, first_problem_;
  bool warning_ = false;
};

}  // namespace watch
