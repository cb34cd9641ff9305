// The game chosen by the host, and the challenge of the day.
#include "control_server.h"
#include "os/clock.h"
#include "server/game_choice.h"
#include "wire/enums.h"

namespace server {
namespace {

using wire::make_sentence;
using wire::SentenceId;

bool is_default(const wire::Tuning& tuning) {
  const foosball::Tuning usual;
  for (std::size_t i = 0; i < tuning.values.size(); ++i)
    if (tuning.values[i] != usual.*foosball::kTuningFields[i].value) return false;
  return true;
}

}  // namespace

bool ControlServer::in_challenge() const {
  return game_ && game_->mode == number(wire::Mode::challenge);
}

// Only the host chooses the game, as for the tuning. A challenge is today's.
void ControlServer::take_game(ControlConnection& connection, wire::Game game) {
  const Seat* seat = seats_.find(connection.client);
  const auto refuse_it = [&](const wire::Sentence& why_not) {
    count(Count::requests_dropped);
    answer(connection, wire::kGameAnswerTopic, why_not);
  };
  if (seat == nullptr || !connection.requests.take(os::monotonic_us())) {
    count(Count::requests_dropped);
    return;
  }
  if (!options_.teams_open) return refuse_it(make_sentence<SentenceId::recording_plays>());
  if (seat->role != wire::Role::host)
    return refuse_it(make_sentence<SentenceId::only_host_chooses>());
  GameSite site = options_.site;
  if (tuning_) site.default_tuning = is_default(*tuning_);
  if (const wire::Sentence why = why_not(game, site); !why.empty()) return refuse_it(why);
  if (game.mode == number(wire::Mode::challenge)) {
    game.date = challenge_day();
    if (game.date == 0) return refuse_it(make_sentence<SentenceId::challenge_undated>());
  }
  if (pending_.size() > kMaxPending)
    return refuse_it(make_sentence<SentenceId::server_overloaded>());
  count(Count::requests);
  send(connection, wire::Notice{wire::Notice::Level::cleared, wire::kGameAnswerTopic, "chosen"});
  choose(game, seat->client);
}

void ControlServer::choose(const wire::Game& game, std::uint32_t client) {
  ControlEvent event;
  event.kind = ControlEvent::Kind::game;
  event.client = client;
  event.game = game;
  pending_.push_back(std::move(event));
  push_events();
}

std::uint32_t ControlServer::challenge_day() const {
  if (options_.challenge_date != 0) return options_.challenge_date;
  return options_.date ? day_of(options_.date()) : 0;
}

// At midnight selects the challenge of the next day, for the matches that begin from then on.
void ControlServer::follow_the_day() {
  if (!in_challenge() || !options_.teams_open || os::monotonic_us() < look_at_the_day_us_) return;
  look_at_the_day_us_ = os::monotonic_us() + kLookAtTheDayUs;
  const std::uint32_t day = challenge_day();
  if (day == 0 || day == game_->date || day == followed_day_) return;
  followed_day_ = day;
  wire::Game next;
  next.mode = number(wire::Mode::challenge);
  next.date = day;
  choose(next, 0);
}

}  // namespace server
