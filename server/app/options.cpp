#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "cabinet/mouse_source.h"
#include "characters/character_file.h"
#include "os/socket_address.h"
#include "os/time_of_day.h"
#include "os/user_folder.h"
#include "profile/tuning_profile.h"
#include "server/exit_code.h"
#include "server/game_choice.h"
#include "server/option_checks.h"
#include "wire/sentence.h"

namespace app {
namespace {

constexpr std::uint16_t kDefaultPort = 7531;
constexpr double kMaxSeconds = 1e6;  // 11 days

std::string check_address(const std::string& text) {
  return os::parse_address(text, 0) ? ""
                                    : "\"" + text + "\" is not an address, such as 0.0.0.0 or ::";
}

std::optional<server::Endpoint> parse_group(const std::string& text) {
  const auto parsed = os::parse_host_port(text);
  if (!parsed || !parsed->port) return std::nullopt;
  const auto address = os::parse_address(parsed->host, *parsed->port);
  if (!address || !address->is_multicast()) return std::nullopt;
  return server::Endpoint{parsed->host, *parsed->port};
}

// The first line of the file.
std::optional<std::string> read_password(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
  constexpr std::size_t kShortest = 6, kLongest = 256;
  if (line.size() < kShortest || line.size() > kLongest) return std::nullopt;
  return line;
}

std::string check_password_file(const std::string& path) {
  return read_password(path) ? ""
                             : "\"" + path +
                                   "\" has no password of 6 to 256 bytes in its first line, or "
                                   "cannot be read";
}

std::string check_group(const std::string& text) {
  return parse_group(text)
             ? ""
             : "\"" + text +
                   "\" is not a multicast group, such as 239.7.5.31:7532 or [ff15::7531]:7532";
}

std::string check_seconds(const std::string& text) {
  double value = 0.0;
  const bool ok = CLI::detail::lexical_cast(text, value) && value > 0.0 && value <= kMaxSeconds;
  return ok ? "" : "\"" + text + "\" is not a number of seconds between 0.001 and 1000000";
}

std::string check_sets(const std::string& text) {
  int sets = 0;
  const bool ok = CLI::detail::lexical_cast(text, sets) && sets >= 1 && sets <= 17 && sets % 2 == 1;
  return ok ? "" : "\"" + text + "\" is not an odd number of sets from 1 to 17";
}

std::string check_date(const std::string& text) {
  std::uint32_t date = 0;
  const bool ok =
      text.size() == 8 && CLI::detail::lexical_cast(text, date) && foosball::is_date(date);
  return ok ? "" : "\"" + text + "\" is not a day of the calendar, such as 20261122";
}

struct Raw {
  std::string rules = "arcade", mode = "match";
  int goals = 0, sets = 0;
  double minutes = 0.0;
  std::uint32_t date = 0;
  bool change_sides = false;
  std::string layout = "tournament", team0 = "human", team1 = "human", multicast, seed, tuning;
  std::string password_file, host_password_file;
  std::string characters, check_character;
  bool checks_character = false;
  double seconds = 0.0, keep_seats = 30.0, recordings_gb = 2.0;
  int level = foosball::PlayerSpec{}.level;
  std::string style;
  bool fast = false, no_real_time = false, list_tuning = false, no_haptics = false;
  int phone_port = -1;  // not given
};

void add_match(CLI::App& cli, Options& o, Raw& raw) {
  const CLI::IsMember player({"human", "computer"});
  cli.add_option("--layout", raw.layout, "paper (8 rods of 4 men) or tournament (1-2-5-3)")
      ->check(CLI::IsMember({"paper", "tournament"}));
  cli.add_option("--seed", raw.seed, "seed of the match and the computer players")
      ->check(server::check_seed);
  cli.add_option("--tuning", raw.tuning, "profile of tuning values, TOML; see --list-tuning");
  cli.add_flag("--list-tuning", raw.list_tuning, "print all tuning values as a profile");
  cli.add_option("--characters", raw.characters,
                 "folder of character files to choose from, instead of the built-in ones and your "
                 "own in ~/.local/share/space-foosball/characters: docs/characters.md");
  cli.add_option("--check-character", raw.check_character,
                 "check a character file, print its values, and exit");
  cli.add_option("--team0", raw.team0, "human, or computer: it plays while no person has the team")
      ->check(player);
  cli.add_option("--team1", raw.team1, "the same for the other team")->check(player);
  cli.add_option("--rules", raw.rules, "arcade, or itsf: the tournament rules, best of 5 sets")
      ->check(CLI::IsMember({"arcade", "itsf"}));
  cli.add_option("--goals", raw.goals, "goals that win a set")->check(CLI::Range(1, 99));
  cli.add_option("--sets", raw.sets, "best of how many sets: 1, 3, 5 ... 17")->check(check_sets);
  cli.add_option("--minutes", raw.minutes,
                 "time of play, then the leading team wins; at a draw the next goal decides")
      ->check(CLI::Range(0.1, 60.0))
      ->check(server::check_not_nan);
  cli.add_flag("--change-sides", raw.change_sides,
               "change sides between sets, at a cabinet (--device), whose players walk around it");
  cli.add_option(
         "--mode", raw.mode,
         "match; training: the ball is served to a man again and again; challenge: two minutes, "
         "the same for everybody on one day; ladder: against stronger and stronger computers")
      ->check(CLI::IsMember({"match", "training", "challenge", "ladder"}));
  cli.add_option("--date", raw.date, "day of the challenge, such as 20261122 (default: today)")
      ->check(check_date);
  cli.add_option(
         "--level", raw.level,
         "level of the computer players, 1 to 5; the ladder and the challenge have their own")
      ->check(CLI::Range(1, foosball::kLevels));
  cli.add_option("--style", raw.style,
                 "style of the computer players: wall, shooter, passer or gambler; default: the "
                 "one that suits the level")
      ->check(CLI::IsMember({"wall", "shooter", "passer", "gambler"}));
  cli.add_flag("--computer-fills", o.computer_fills,
               "the computer also plays the free rods of a team of people");
  cli.add_option(
      "--device", o.devices,
      "a cabinet: serial:/dev/ttyACM0, hid:/dev/hidraw0 or file:RECORDING; a mouse for a "
      "rod from 1 to 8: evdev:/dev/input/event5:4; may be given more than once");
  cli.add_option("--calibration", o.calibration, "calibration of the cabinet's sensors")
      ->needs("--device");
}

void add_network(CLI::App& cli, Options& o, Raw& raw) {
  o.network.port = kDefaultPort;
  cli.add_option("--port", o.network.port,
                 "TCP for control and UDP for input, on the same number; 0: any free one")
      ->check(CLI::Range(0, 65535));
  cli.add_option(
         "--listen", o.network.listen,
         "address to listen at, 0.0.0.0 or :: for all; default: only this machine can connect")
      ->check(check_address);
  cli.add_option("--multicast", raw.multicast, "multicast GROUP:PORT to send the snapshots to")
      ->check(check_group);
  cli.add_option("--password-file", raw.password_file,
                 "its first line is the password for joining from another machine; default: one is "
                 "generated and printed")
      ->check(check_password_file);
  cli.add_option("--host-password-file", raw.host_password_file,
                 "... the same for the host: who may pause, restart and choose the game from "
                 "another machine")
      ->check(check_password_file);
  cli.add_option("--keep-seats", raw.keep_seats,
                 "time for which the rods of a player whose connection was lost are reserved, in "
                 "seconds; 0: not at all")
      ->check(CLI::Range(0.0, 3600.0))
      ->check(server::check_not_nan)
      ->capture_default_str();
  auto* phones = cli.add_flag(
      "--phones", o.phones.open,
      "phones play as pairs of rods: the screen shows a QR code; from other machines with --listen "
      "(docs/phones.md)");
  cli.add_option("--phone-port", raw.phone_port,
                 "TCP port for phones; 0: any free one; default: the one after --port")
      ->needs(phones)
      ->check(CLI::Range(0, 65535));
  cli.add_option("--phone-listen", o.phones.listen,
                 "address to listen at for phones; default: that of --listen. It lets phones of "
                 "the network play where no other machine may join")
      ->needs(phones)
      ->check(check_address);
  cli.add_flag("--no-haptics", raw.no_haptics,
               "neither the cabinet's rods nor phones shake when the ball is hit");
  cli.add_flag("--mixed-teams", o.access.mixed_teams,
               "clients of other machines may have rods of both teams");
}

void add_run(CLI::App& cli, Options& o, Raw& raw) {
  auto* record = cli.add_option("--record", o.record, "write the match's journal to this file");
  cli.add_flag("--overwrite", o.overwrite, "replace an existing recording")->needs(record);
  auto* results =
      cli.add_option("--results", o.results,
                     "add every finished match to this file; space-foosball-results lists them");
  cli.add_flag("--no-questionnaire", o.no_questionnaire,
               "do not ask those who played six questions for that file (docs/questionnaire.md)")
      ->needs(results);
  auto* replay = cli.add_option("--replay", o.replay, "play a journal to all clients, and check it")
                     ->excludes(record)
                     ->excludes("--phones")
                     ->excludes("--device");
  auto* recordings =
      cli.add_option("--recordings", o.recordings,
                     "record into this folder, with the date and time as the name; the oldest are "
                     "deleted, and a failure to record is only reported")
          ->excludes(record)
          ->excludes(replay);
  cli.add_option("--recordings-kept", o.recording_limits.count,
                 "... at most this number of recordings")
      ->needs(recordings)
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  cli.add_option("--recordings-gb", raw.recordings_gb, "... and at most this size of all, in GiB")
      ->needs(recordings)
      ->check(CLI::Range(0.5, 1e4))
      ->check(server::check_not_nan)
      ->capture_default_str();
  cli.add_flag("--fast", raw.fast, "replay at full speed")->needs(replay);
  cli.add_option("--seconds", raw.seconds, "end after this time of the match")
      ->check(check_seconds);
  cli.add_flag("--await-client", o.await_client,
               "start the match, or its replay, when the first client has joined");
  cli.add_flag("--exit-when-empty", o.run.exit_when_empty,
               "end when the last client that joined has left");
  cli.add_option("--cpu", o.loop.cpu, "pin the tick to this core")->check(CLI::Range(0, 1023));
  cli.add_flag("--no-real-time", raw.no_real_time,
               "do not ask for real-time priority and locked memory");
  cli.add_option("--ready-file", o.ready_file, "written with port=N once clients can connect");
  cli.add_option("--stats-file", o.stats_file,
                 "file for statistics of the run, as JSON or, if *.csv, CSV");
  cli.add_flag("--quiet", o.quiet, "print only what is wrong");
}

// The path itself tells the kind of device.
std::string with_scheme(const std::string& device) {
  if (device.empty() || (device[0] != '/' && device.find(':') != std::string::npos)) return device;
  if (device.rfind("/dev/hidraw", 0) == 0) return "hid:" + device;
  if (device.rfind("/dev/input/", 0) == 0) return "evdev:" + device;
  return (device.rfind("/dev/", 0) == 0 ? "serial:" : "file:") + device;
}

foosball::Mode mode_of(const std::string& name) {
  if (name == "training") return foosball::Mode::training;
  if (name == "ladder") return foosball::Mode::ladder;
  return name == "challenge" ? foosball::Mode::challenge : foosball::Mode::match;
}

foosball::GameSetup setup_of(const Raw& raw) {
  foosball::GameSetup setup;
  setup.mode = mode_of(raw.mode);
  setup.rules = raw.rules == "itsf" ? foosball::RuleSet::itsf : foosball::RuleSet::arcade;
  setup.goals = raw.goals;
  setup.sets = raw.sets;
  setup.match_ms = static_cast<std::uint32_t>(std::lround(60'000.0 * raw.minutes));
  setup.change_sides = raw.change_sides;
  return setup;
}

// The options that a rejection of a game refers to.
std::vector<const char*> options_of(const wire::Sentence& refusal) {
  using wire::SentenceId;
  const std::vector<const char*> end{"--goals", "--sets", "--minutes", "--change-sides"},
      opponent{"--level", "--style"};
  if (refusal == wire::make_sentence<SentenceId::challenge_is_set>())
    return {"--goals", "--sets", "--minutes", "--change-sides", "--rules", "--level", "--style"};
  if (refusal == wire::make_sentence<SentenceId::training_has_no_end>()) return end;
  if (refusal == wire::make_sentence<SentenceId::ladder_has_its_levels>()) return opponent;
  if (refusal == wire::make_sentence<SentenceId::challenge_table>()) return {"--layout"};
  if (refusal == wire::make_sentence<SentenceId::challenge_characters>()) return {"--characters"};
  if (refusal == wire::make_sentence<SentenceId::challenge_tuning>()) return {"--tuning"};
  return {"--change-sides"};
}

foosball::Layout layout_of(const Raw& raw) {
  return raw.layout == "paper" ? foosball::Layout::paper : foosball::Layout::tournament;
}

// Uses the given values, regardless of the mode.
server::GameSite site_of(const Options& o, const Raw& raw) {
  foosball::MatchDesc given = o.match;
  given.layout = layout_of(raw);
  return server::site_of(given, o.computer[0] || o.computer[1], !o.devices.empty());
}

// Empty, or the reason why the options contradict each other: the same sentence as for a client's
// request.
std::string contradiction(const CLI::App& cli, const Options& o, const Raw& raw,
                          const server::GameSite& site) {
  const auto given = [&](const char* name) { return cli.get_option(name)->count() > 0; };
  const foosball::GameSetup setup = setup_of(raw);
  const bool challenge = setup.mode == foosball::Mode::challenge;
  if (!challenge && raw.date > 0)
    return "--date is the day of a challenge: give --mode challenge with it, or omit it";
  if (challenge && given("--seed"))
    return "--seed and --mode challenge: the challenge of the day has a seed of its own; omit "
           "--seed";
  wire::Game asked = server::to_game(setup);
  if (given("--level") || given("--style")) {
    const server::Opponent wanted = server::opponent_of(o.computer_player);
    asked.level = static_cast<std::uint8_t>(wanted.level);
    asked.style = static_cast<std::uint8_t>(wanted.style);
  }
  const wire::Sentence why = server::why_not(asked, site);
  if (why.empty()) return {};
  std::string said;
  for (const char* name : options_of(why))
    if (said.empty() && given(name)) said = std::string(name) + " and ";
  return said + "--mode " + raw.mode + ": " + why.text();
}

void translate(Options& o, const Raw& raw) {
  o.match.layout = layout_of(raw);
  const foosball::GameSetup setup = setup_of(raw);
  o.match.rules = foosball::rules_of(setup);
  o.match.mode = setup.mode;
  o.challenge_date = raw.date;
  if (setup.mode == foosball::Mode::challenge)
    o.match = foosball::challenge_of(raw.date > 0 ? raw.date : server::day_of(os::utc_now()));
  if (!raw.seed.empty()) o.match.seed = *server::parse_seed(raw.seed);
  o.computer = {raw.team0 == "computer", raw.team1 == "computer"};
  const std::string player = std::to_string(raw.level);
  o.computer_player =
      *foosball::parse_player(raw.style.empty() ? player : player + ":" + raw.style);
  if (!raw.multicast.empty()) o.network.multicast = parse_group(raw.multicast);
  if (!raw.password_file.empty()) o.access.password = read_password(raw.password_file);
  if (!raw.host_password_file.empty()) {
    o.access.host_password = read_password(raw.host_password_file);
  }
  o.limits.seat_kept_us = std::llround(raw.keep_seats * 1e6);
  o.run.ticks = static_cast<std::uint64_t>(std::llround(std::ceil(raw.seconds / foosball::kTick)));
  o.recording_limits.bytes = static_cast<std::uint64_t>(raw.recordings_gb * (1 << 30));
  // The port after the control port; any free one if that is not a fixed port below 65535.
  const int beside = o.network.port == 0 || o.network.port == 65535 ? 0 : o.network.port + 1;
  o.phones.port = static_cast<std::uint16_t>(raw.phone_port >= 0 ? raw.phone_port : beside);
  o.haptics = !raw.no_haptics;
  o.loop.paced = !raw.fast;
  o.loop.real_time = !raw.no_real_time;
  o.loop.drop_rights = true;
  for (std::string& device : o.devices) device = with_scheme(device);
}

// Moves the mice out of the devices and gives each its rod. Mice without a rod get free rods of
// team 0, midfield first. Empty, or an error message.
std::string take_mice(Options& o) {
  constexpr std::array<foosball::Line, 4> kOrder = {foosball::Line::midfield,
                                                    foosball::Line::attack, foosball::Line::goalie,
                                                    foosball::Line::defence};
  const auto own = foosball::rods_of_team(foosball::table_spec(o.match.layout), 0);
  unsigned taken = 0;
  std::vector<std::string> others;
  for (const std::string& device : o.devices) {
    if (!cabinet::is_mouse_address(device)) {
      others.push_back(device);
      continue;
    }
    auto address = cabinet::parse_mouse_address(device);
    if (!address) return address.error();
    const int rod = address->rod;
    if (rod >= 0 && (taken >> rod & 1) != 0)
      return device + ": another mouse moves rod " + std::to_string(rod + 1) +
             " already; give each mouse a rod of its own";
    if (rod >= 0) taken |= 1U << rod;
    o.mice.push_back({device, std::move(address->path), rod});
  }
  for (Mouse& mouse : o.mice) {
    for (const foosball::Line line : kOrder) {
      const int rod = own[static_cast<std::size_t>(line)];
      if (mouse.rod >= 0 || (taken >> rod & 1) != 0) continue;
      mouse.rod = rod;
      taken |= 1U << rod;
    }
    if (mouse.rod < 0) return mouse.name + ": append the rod that it moves, such as :5";
  }
  o.devices = std::move(others);
  return {};
}

// Empty if there is no home.
std::string own_characters() {
  const std::string data = os::data_folder();
  return data.empty() ? "" : data + "/space-foosball/characters";
}

// A challenge uses the built-in characters. A named folder is loaded all the same, to be compared
// with them.
tl::expected<foosball::Characters, std::string> characters_of(const Raw& raw) {
  if (!raw.characters.empty()) return characters::load_characters(raw.characters);
  if (!foosball::chooses_rules(mode_of(raw.mode))) return foosball::built_in_characters();
  const std::string own = own_characters();
  if (own.empty()) return foosball::built_in_characters();
  return characters::load_more_characters(foosball::built_in_characters(), own);
}

// The output of --check-character: the file with all fields.
tl::expected<std::string, std::string> checked(const std::string& path) {
  const auto character = characters::load_character(path);
  if (!character) return tl::unexpected(character.error());
  return characters::format_character(*character);
}

}  // namespace

tl::expected<Options, Leave> parse(int argc, const char* const* argv) {
  CLI::App cli{
      "The physics server of Space Foosball: steps the match 1000 times a second and sends it to\n"
      "every renderer that has joined. Ctrl-C ends it.\n\n"
      "Exit codes: 0 ended as requested; 1 a replay differs, a recording lacks its end, or\n"
      "something failed; 2 a bad option; 3 the port is in use; 4 a replay stops early.",
      "space-foosball-server"};
  Options options;
  Raw raw;
  add_match(cli, options, raw);
  add_network(cli, options, raw);
  add_run(cli, options, raw);
  try {
    cli.parse(argc, argv);
    raw.checks_character = cli.get_option("--check-character")->count() > 0;
  } catch (const CLI::CallForHelp&) {
    return tl::unexpected(Leave{server::kExitOk, cli.help()});
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(
        Leave{server::kExitUsage, std::string(error.what()) + "; --help explains the options"});
  }
  translate(options, raw);
  if (const auto objection = take_mice(options); !objection.empty())
    return tl::unexpected(Leave{server::kExitUsage, "--device " + objection});
  if (!raw.tuning.empty()) {
    auto tuning = profile::load_tuning(raw.tuning);
    if (!tuning) return tl::unexpected(Leave{server::kExitUsage, "--tuning: " + tuning.error()});
    options.match.tuning = *tuning;
  }
  if (raw.checks_character) {
    const auto text = checked(raw.check_character);
    if (!text) return tl::unexpected(Leave{server::kExitUsage, text.error()});
    return tl::unexpected(Leave{server::kExitOk, *text});
  }
  if (raw.list_tuning) {
    return tl::unexpected(Leave{server::kExitOk, profile::format_tuning(options.match.tuning)});
  }
  if (!options.replay.empty()) return options;  // the recording defines the game
  auto list = characters_of(raw);
  if (!list) return tl::unexpected(Leave{server::kExitUsage, list.error()});
  options.match.characters = std::move(*list);
  if (std::string why = contradiction(cli, options, raw, site_of(options, raw)); !why.empty())
    return tl::unexpected(Leave{server::kExitUsage, std::move(why)});
  return options;
}

}  // namespace app
