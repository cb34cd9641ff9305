// The sentences that the server shows to people: every sentence of a Notice, a Refusal or a Bye, as
// a form with placeholders. They are sent in English, as logs have them. A client knows the same
// forms and shows them in the person's language. A Sentence is made from a form, so that clients
// know all of them.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace wire {

// Name and English form. %1 .. %9 are placeholders, each used once. A placeholder may hold another
// sentence, or several separated by "; ". Texts are truncated to kMaxText bytes.
// clang-format off
#define WIRE_SENTENCES(X) \
  /* joining, and why it fails */ \
  X(other_version, "this server uses control version %1, this client %2: use the same release of both") \
  X(other_snapshots, "your snapshots have another layout: use the same release of both") \
  X(other_password_share, "invalid key share: use the same release of both") \
  X(no_such_request, "a request that does not exist: use the same release of client and server") \
  X(unreadable, "your message could not be read: is this a Space Foosball client?") \
  X(out_of_place, "message out of order: send Hello first, and once") \
  X(no_hosts_from_afar, "nobody can be host from another machine: start the server with --host-password-file") \
  X(nobody_from_afar, "nobody can join from another machine: start the server with --password-file") \
  X(password_wanted, "from another machine a password is needed: give --password-file") \
  X(wrong_passwords, "too many wrong passwords from your network: wait a minute") \
  X(server_overloaded, "the server is overloaded: try again") \
  X(server_full, "the server is full: try again when somebody has left") \
  X(too_many_connections, "too many connections from your address: close one first") \
  X(no_socket_left, "the server has no socket left for you: try again") \
  X(recording_plays, "this server plays a recording") \
  X(recording_plays_join, "this server plays a recording: join to watch") \
  /* assignment of rods */ \
  X(which_team, "choose the team whose rods you want: 0 or 1") \
  X(team_taken, "team %1 is taken: ask for the other one, or join to watch") \
  X(rods_of_both_teams, "only the table's own machine may have rods of both teams: ask for rods of team %1, or start the server with --mixed-teams") \
  X(rods_taken, "rods %1 of team %2 are taken: rods %3 are free") \
  X(rods_and_team_taken, "rods %1 of team %2 are taken: ask for the other one, or join to watch") \
  X(joined_to_watch, "you joined to watch") \
  X(player_lost, "%1 was lost: rods %2 are reserved for %3 s") \
  X(rods_for, "rods %1 for %2") \
  X(a_player, "a player") \
  X(computer_plays, "the computer plays %1") \
  X(rods_offered, "reserved for the team for %1 s, then played by the computer: %2") \
  X(waits_for_players, "the match waits: no input from any player") \
  X(not_rated, "the match does not count for the rating of players who played too little of it: %1") \
  X(lost_by_leaving, "players who leave a match lose it: %1") \
  /* choice of the game */ \
  X(only_host_chooses, "only the host chooses what is played") \
  X(no_such_game, "this game cannot be played: 1 to 99 goals, an odd number of sets up to 17, at most 60 minutes, level 1 to 5") \
  X(challenge_is_set, "the challenge of the day has its own rules and opponent: choose none with it") \
  X(training_has_no_end, "training does not end: choose no goals, sets or minutes with it") \
  X(ladder_has_its_levels, "on the ladder the computer is stronger from match to match: choose no level or style with it") \
  X(no_computer_here, "the computer plays no team on this server: start it with --team1 computer") \
  X(challenge_table, "the challenge of the day is played on the tournament table: start the game without --layout paper") \
  X(challenge_characters, "the challenge of the day is played by the built-in characters: move yours of the same names away, or start the game without --characters") \
  X(challenge_tuning, "the challenge of the day is played with the default tuning: set all values to their defaults first") \
  X(challenge_keeps_tuning, "the challenge of the day keeps the default tuning: choose another game first") \
  X(sides_at_a_cabinet, "players walk around a cabinet to change sides, seats at windows stay: start the server with a cabinet's --device (no mouse), or do not change sides") \
  X(sides_between_sets, "sides change between sets, and this match has one: choose 3 sets or more, or do not change sides") \
  X(challenge_undated, "this server does not know the date, so it has no challenge of the day") \
  /* votes */ \
  X(asks_for_pause, "%1 asks for a pause: %2 of %3 votes. Ask for it too to agree") \
  X(asks_for_restart, "%1 asks for a restart: %2 of %3 votes. Ask for it too to agree") \
  X(asks_to_go_on, "%1 asks to continue the game: %2 of %3 votes. Ask for it too to agree") \
  X(watchers_have_no_vote, "watchers have no vote") \
  X(target_has_left, "the player you want to remove has left") \
  X(target_is_you, "you cannot remove yourself: give up your rods") \
  X(target_watches, "only players can be removed, and this one is watching") \
  X(target_is_host, "the host cannot be removed") \
  X(target_at_your_address, "your address has no vote about its own players") \
  X(one_alone, "one player alone cannot remove another: ask the host") \
  X(vote_just_begun, "you started a vote a moment ago: wait a minute") \
  X(would_put_out, "%1 wants to remove %2 from the match: %3 of %4 votes") \
  X(vote_goes_on, "%1 comes from the address of %2, who has left: the vote to remove that player continues against %3") \
  X(vote_at_your_address, "a vote against a player at your address is open: wait for its end") \
  X(put_out_by_host, "the host removed you: join to watch. You may play when a match has ended, or in %1 minutes") \
  X(put_out_by_players, "the players removed you: join to watch. You may play when a match has ended, or in %1 minutes") \
  X(address_put_out, "somebody at your address was removed: join to watch. You may play when a match has ended, or in %1 minutes") \
  /* answers to the questionnaire */ \
  X(answers_of_other_match, "your answers are not stored: the match is not the one you were asked about") \
  X(answers_given_already, "your answers are not stored: they were given already, or belong to others") \
  X(answers_of_both_teams, "your answers are not stored: one player has rods of one team") \
  X(answers_empty, "your answers are not stored: there are none") \
  /* the server's machine */ \
  X(cannot_keep_up, "the physics server cannot keep up: end other programs on its machine") \
  X(nothing_is_sent, "no snapshot can be sent: %1; check the network's routes, or omit --multicast") \
  X(disk_too_slow, "recording to %1 ended early: the disk is too slow; play goes on") \
  X(recording_failed, "recording to %1 ended early: %2; play goes on") \
  X(recording_too_large, "recording to %1 ended early: it has reached its %2 MiB; play goes on") \
  X(recording_stalled, "recording to %1 ended early: the disk, or the pipe's reader, did not take the rest in time") \
  X(results_not_kept, "%1; play goes on") \
  X(results_problem, "results in %1: %2") \
  /* values of %2: the sentences of results::Store, which does not know wire */ \
  X(results_locked, "another program has them locked; end it and try again") \
  X(results_no_database, "the file is not a database of results; choose another file") \
  X(results_damaged, "the file is damaged; move it away, a new one is made") \
  X(results_not_opened, "the file cannot be opened; check its folder and permissions") \
  X(results_not_written, "the file cannot be written; check its permissions") \
  X(results_disk_full, "the disk is full; make room") \
  X(results_no_file, "it is not a regular file; choose another") \
  X(results_too_new, "they are of version %1, this program knows %2; use the release that wrote them") \
  /* the server's devices */ \
  X(device_not_allowed, "%1 cannot be opened: %2; install cabinet/70-space-foosball.rules or join the device's group") \
  X(device_busy, "%1 cannot be opened: %2; end the other program that uses it") \
  X(device_refused, "%1 cannot be opened: %2; plug it in again, or give another address") \
  X(device_unplugged, "%1 unplugged: its rods are held; plug it in again") \
  X(device_missing, "%1 does not exist: plug it in, or give the right address") \
  X(device_silent, "%1 is connected but sends nothing: plug it in again, and check its firmware") \
  X(device_garbled, "%1 sends no valid frames: is it the right device, with our firmware?") \
  X(device_too_fast, "%1: a rod moved faster than its sensor can follow; push it to both stops once") \
  X(device_over, "%1 has ended: its rods are held") \
  X(device_without_frames, "%1 contains no frame: give a recording of a controller") \
  /* the server's end */ \
  X(server_stopped, "the server was stopped") \
  X(server_ends, "the server ends") \
  X(time_is_over, "the time is over") \
  X(everybody_left, "everybody has left") \
  X(recording_over, "the recording is over")
// clang-format on

#define WIRE_NAME(name, form) name,
enum class SentenceId : std::uint8_t { WIRE_SENTENCES(WIRE_NAME) };
#undef WIRE_NAME
#define WIRE_FORM(name, form) form,
inline constexpr std::array kSentences{WIRE_SENTENCES(WIRE_FORM)};
#undef WIRE_FORM

// Number of placeholders of the form.
constexpr int count_placeholders(std::string_view form) {
  int places = 0;
  for (const char c : form) places += c == '%' ? 1 : 0;
  return places;
}

class Sentence {
 public:
  Sentence() = default;  // none
  // Text of other origin (operating system, library), which clients do not translate.
  static Sentence untranslated(std::string text);

  const std::string& text() const { return text_; }
  bool empty() const { return text_.empty(); }
  bool operator==(const Sentence&) const = default;

 private:
  template <SentenceId id, class... Words>
  friend Sentence make_sentence(const Words&... words);
  static Sentence filled(std::string_view form, std::initializer_list<std::string> words);
  static std::string word(const Sentence& sentence) { return sentence.text_; }
  static std::string word(std::string_view text) { return std::string(text); }
  static std::string word(std::integral auto number) { return std::to_string(number); }

  std::string text_;
};

// Fills the placeholders in order: texts, integers or sentences.
template <SentenceId id, class... Words>
Sentence make_sentence(const Words&... words) {
  constexpr std::string_view form = kSentences[static_cast<std::size_t>(id)];
  static_assert(count_placeholders(form) == sizeof...(Words), "a word for each place of the form");
  return Sentence::filled(form, {Sentence::word(words)...});
}

}  // namespace wire
