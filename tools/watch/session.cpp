#include "session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "render/translate.h"
#include "share.h"

namespace watch {
namespace {

constexpr double kMessageSeconds = 10.0;
constexpr double kStickRate = 8'000.0;  // ticks per second, for a held stick
constexpr double kStickRest = 0.3;
constexpr std::array<const char*, client::kViews> kViewNames{
    N_("seat"), N_("from above (cabinet)"), N_("follow the ball"), N_("spectator")};

std::string date_text(std::time_t moment) {
  std::tm local{};
  ::localtime_r(&moment, &local);
  char text[40];
  std::strftime(text, sizeof text, "%Y-%m-%d  %H:%M", &local);
  return text;
}

const char* state_text(const server::RecordingSummary& recording) {
  using State = server::RecordingSummary::State;
  constexpr std::array<const char*, 4> kModes{"", N_("training"), N_("challenge"), N_("ladder")};
  switch (recording.state) {
    case State::bad:
      return N_("cannot be watched");
    case State::being_made:
      return N_("is being played");
    case State::cut_short:
      return N_("stops early");
    case State::whole:
      break;
  }
  return kModes[static_cast<std::size_t>(std::clamp(recording.mode, 0, 3))];
}

client::ReplayList::Row row_of(const server::RecordingSummary& recording) {
  client::ReplayList::Row row;
  row.when = date_text(recording.began);
  row.players = recording.characters;
  const wire::JournalStanding& standing = recording.standing;
  for (std::size_t t = 0; t < row.score.size(); ++t) {
    row.computer[t] = standing.computer[t];
    row.score[t] = standing.score[t];
    row.sets[t] = standing.sets[t];
  }
  row.seconds = 1e-3 * static_cast<double>(recording.ticks);
  row.state = state_text(recording);
  row.name = std::filesystem::path(recording.path).filename().string();
  row.bad = recording.state == server::RecordingSummary::State::bad;
  row.kept = recording.kept;
  return row;
}

}  // namespace

Session::Session(SessionOptions options) : options_(std::move(options)), view_(options_.view) {
  read_folder();
  if (!options_.file.empty()) open(options_.file);
}

void Session::wait() const {
  if (listing_.running()) listing_.wait();
  if (opening_.running()) opening_.wait();
  if (copying_.running()) copying_.wait();
}

void Session::read_folder() {
  if (options_.folder.empty()) return;
  list_.reading = true;
  listing_.start([folder = options_.folder] { return server::list_recordings(folder); });
}

void Session::open(const std::string& path) {
  if (opening_.running()) return;
  list_.reading = true;
  opening_.start([path, from = options_.from] {
    auto timeline = Timeline::open(path);
    if (timeline && from > 0.0) (*timeline)->wait_until_read();
    return timeline;
  });
}

void Session::show_message(const std::string& text, bool warning) {
  message_ = text;
  warning_ = warning;
  message_until_ = seconds_ + kMessageSeconds;
}

void Session::take_list(Listed listed) {
  list_.reading = false;
  if (!listed) return show_message(listed.error(), true);
  // The selection stays with its file.
  const std::string chosen = recordings_.empty() ? "" : path();
  recordings_ = std::move(*listed);
  list_.rows.clear();
  int row = 0;
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    list_.rows.push_back(row_of(recordings_[i]));
    if (recordings_[i].path == chosen) row = static_cast<int>(i);
  }
  if (list_.rows.empty()) {
    list_.chosen = list_.first = 0;
  } else {
    choose(row);
  }
}

void Session::take_recording(Opened opened) {
  list_.reading = listing_.running();
  if (!opened) {
    if (first_problem_.empty() && recordings_.empty()) first_problem_ = opened.error();
    return show_message(opened.error(), true);
  }
  player_ = std::make_unique<Player>(std::move(*opened));
  kept_ = server::summarise_recording(player_->timeline().path()).kept;
  opened_ = true;
  verdict_shown_ = hidden_ = false;
  message_.clear();
  if (options_.from > 0.0) {
    player_->go_to(1e3 * options_.from);
    options_.from = 0.0;
  }
}

void Session::step(double dt) {
  seconds_ += dt;
  if (auto listed = listing_.take()) take_list(std::move(*listed));
  if (auto opened = opening_.take()) take_recording(std::move(*opened));
  if (auto copied = copying_.take()) {
    if (*copied) {
      kept_ = true;
      show_message(std::string(client::tr("copied to")) + " " + **copied, false);
      if (!player_) read_folder();
    } else {
      show_message(copied->error(), true);
    }
  }
  if (player_) {
    if (stick_ != 0.0) player_->go_to(player_->tick() + kStickRate * stick_ * dt);
    player_->advance(dt);
    if (const std::string text = player_->take_message(); !text.empty())
      show_message(client::tr(text.c_str()), false);
    const Findings findings = player_->timeline().findings();
    if (findings.done && !verdict_shown_ && !findings.being_made) {
      verdict_shown_ = true;
      if (findings.verdict != server::Playback::Verdict::same)
        show_message(findings.sentence, true);
    }
  }
  if (seconds_ > message_until_) message_.clear();
  list_.message = message_;
  list_.warning = warning_;
  list_.show_keys = show_keys_;
}

void Session::leave() {
  if (show_keys_) {
    show_keys_ = false;
  } else if (opening_.running()) {
    opening_.forget();
    list_.reading = listing_.running();
  } else if (player_ && !options_.folder.empty()) {
    player_.reset();
    message_.clear();
    stick_ = 0.0;
    read_folder();
  } else {
    over_ = true;
  }
}

std::string Session::path() const {
  if (player_) return player_->timeline().path();
  return recordings_.empty() ? "" : recordings_[static_cast<std::size_t>(list_.chosen)].path;
}

void Session::keep() {
  if (path().empty()) return;
  const auto row = static_cast<std::size_t>(list_.chosen);
  const bool keep = player_ ? !kept_ : !list_.rows[row].kept;
  if (const auto done = server::keep_recording(path(), keep); !done)
    return show_message(done.error(), true);
  if (player_) kept_ = keep;
  if (!player_) list_.rows[row].kept = keep;
  show_message(client::tr(keep ? N_("kept: this recording is never deleted")
                               : N_("no longer kept: it is deleted when there are too many")),
               false);
}

void Session::copy() {
  if (path().empty() || copying_.running()) return;
  copying_.start([from = path(), to = options_.share_to] { return share(from, to); });
}

void Session::choose(int row) {
  const int all = static_cast<int>(list_.rows.size());
  if (all == 0) return;
  const int shown = client::replay_list_layout(size_).shown;
  list_.chosen = std::clamp(row, 0, all - 1);
  list_.first = std::clamp(list_.first, list_.chosen - shown + 1, list_.chosen);
  list_.first = std::clamp(list_.first, 0, std::max(0, all - shown));
}

// The selection stays visible.
void Session::scroll(int rows) {
  const int all = static_cast<int>(list_.rows.size());
  const int shown = client::replay_list_layout(size_).shown;
  list_.first = std::clamp(list_.first + rows, 0, std::max(0, all - shown));
  choose(std::clamp(list_.chosen, list_.first, list_.first + shown - 1));
}

void Session::act(Command command) {
  if (player_ && player_->act(command)) return;
  const int page = client::replay_list_layout(size_).shown;
  switch (command) {
    case Command::camera:
      view_ = static_cast<client::View>((static_cast<int>(view_) + 1) % client::kViews);
      break;
    case Command::side:
      team_ = 1 - team_;
      break;
    case Command::hide:
      hidden_ = !hidden_;
      break;
    case Command::keep:
      keep();
      break;
    case Command::share:
      copy();
      break;
    case Command::picture:
      picture_ = true;
      break;
    case Command::keys:
      show_keys_ = !show_keys_;
      hidden_ = hidden_ && !show_keys_;
      break;
    case Command::leave:
      leave();
      break;
    case Command::up:
      choose(list_.chosen - 1);
      break;
    case Command::down:
      choose(list_.chosen + 1);
      break;
    case Command::page_up:
      choose(list_.chosen - page);
      break;
    case Command::page_down:
      choose(list_.chosen + page);
      break;
    case Command::begin:
      choose(0);
      break;
    case Command::end:
      choose(static_cast<int>(list_.rows.size()) - 1);
      break;
    case Command::confirm:
      if (!path().empty()) open(path());
      break;
    default:
      break;
  }
}

void Session::key(int key, bool shift) {
  if (show_keys_ && command_of_key(key, shift, !player_) == Command::confirm) {
    show_keys_ = false;
    return;
  }
  act(command_of_key(key, shift, !player_));
}

void Session::press(const glm::vec2& at) {
  if (show_keys_) {
    show_keys_ = false;
    return;
  }
  if (!player_) {
    const auto layout = client::replay_list_layout(size_);
    if (layout.leave.holds(at)) return leave();
    if (layout.keep.holds(at)) return keep();
    if (layout.share.holds(at)) return copy();
    if (const auto row = client::row_at(layout, list_, at)) {
      choose(*row);
      open(recordings_[static_cast<std::size_t>(*row)].path);
    }
    return;
  }
  if (hidden_) {
    hidden_ = false;
    return;
  }
  const auto layout = client::replay_bar_layout(size_);
  if (layout.line.holds(at)) return player_->drag(client::moment_at(layout, at.x, bar().total));
  for (int i = 0; i < client::kReplayButtons; ++i) {
    if (layout.buttons[static_cast<std::size_t>(i)].holds(at))
      return act(command_of_button(static_cast<client::ReplayButton>(i)));
  }
  if (!layout.panel.holds(at)) player_->act(Command::play);
}

void Session::pointer(const PointerEvent& event) {
  switch (event.kind) {
    case PointerEvent::Kind::press:
      press(event.at);
      break;
    case PointerEvent::Kind::move:
      if (player_ && player_->dragging()) {
        player_->drag(client::moment_at(client::replay_bar_layout(size_), event.at.x, bar().total));
      } else if (!player_) {
        // Selects the row under the pointer, to which keys and buttons apply.
        const auto row = client::row_at(client::replay_list_layout(size_), list_, event.at);
        if (row) choose(*row);
      }
      break;
    case PointerEvent::Kind::release:
      if (player_) player_->drop();
      break;
    case PointerEvent::Kind::wheel: {
      wheel_ += static_cast<double>(event.steps);
      const double steps = std::trunc(wheel_);  // touch pads scroll in fractions of a step
      wheel_ -= steps;
      if (player_ && steps != 0.0) player_->go_to(player_->tick() + 1e3 * steps);
      if (!player_) scroll(-3 * static_cast<int>(steps));
      break;
    }
  }
}

void Session::pad(const client::InputEvents& events) {
  commands_of_pad(events, !player_, player_ && player_->paused(), [&](Command c) { act(c); });
  const auto stick = static_cast<double>(events.pad.left_x);
  stick_ = player_ && std::abs(stick) > kStickRest ? stick : 0.0;
}

client::ReplayBar Session::bar() const {
  const Findings findings = player_->timeline().findings();
  client::ReplayBar bar;
  bar.now = 1e-3 * static_cast<double>(player_->timeline().scene().ticks());
  bar.read = 1e-3 * static_cast<double>(findings.read);
  bar.total = 1e-3 * static_cast<double>(findings.total);
  bar.speed = player_->speed();
  bar.paused = player_->paused();
  bar.kept = kept_;
  bar.being_made = findings.being_made;
  bar.show_keys = show_keys_;
  const auto& score = player_->timeline().scene().snapshot().score;
  bar.score = {score[0], score[1]};
  for (const Goal& goal : findings.goals)
    bar.goals.push_back({1e-3 * static_cast<double>(goal.tick), goal.team});
  bar.camera = kViewNames[static_cast<std::size_t>(view_)];
  bar.message = message_;
  bar.warning = warning_;
  return bar;
}

std::string Session::state() const {
  if (!player_) {
    if (list_.reading) return "reading";
    return "list of " + std::to_string(list_.rows.size()) + ", row " +
           std::to_string(list_.chosen + 1);
  }
  char text[200];
  std::snprintf(text, sizeof text, "%s, speed %g, %s, view %s, side %d%s",
                std::filesystem::path(player_->timeline().path()).filename().c_str(),
                player_->speed(), player_->paused() ? "paused" : "playing",
                kViewNames[static_cast<std::size_t>(view_)], team_, hidden_ ? ", hidden" : "");
  return text;
}

}  // namespace watch
