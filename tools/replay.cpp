// foosball-replay: simulates a recorded match without a screen, as fast as possible, and reports
// whether the result equals the match that was played.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <optional>

#include "server/exit_code.h"
#include "server/playback.h"

namespace {

struct Options {
  std::string file;
  std::uint64_t until = 0;  // 0: to the end
  std::optional<std::uint64_t> restore_at;
};

int fail(const std::string& sentence) {
  std::fprintf(stderr, "foosball-replay: %s\n", sentence.c_str());
  return server::kExitUsage;
}

// Continues in another match that is restored from the first match's snapshot alone.
bool continue_elsewhere(foosball::Match& match, const foosball::MatchDesc& desc) {
  std::vector<std::byte> saved;
  match.snapshot(saved);
  auto fresh = foosball::Match::create(desc);
  if (!fresh || !fresh->restore(saved)) return false;
  match = std::move(*fresh);
  return true;
}

int replay(const Options& options, server::Playback& playback, foosball::Match& match) {
  bool restored = !options.restore_at;
  const auto restore_here = [&] {
    if (restored || playback.ticks() != *options.restore_at) return true;
    restored = true;
    return continue_elsewhere(match, playback.match());
  };
  const auto stop_here = [&] { return options.until != 0 && playback.ticks() >= options.until; };
  if (!restore_here()) return fail("the match could not be restored from its own snapshot");
  while (!stop_here()) {
    const wire::JournalTick* tick = playback.next(match);
    if (tick == nullptr) break;
    server::step_recorded(match, *tick);
    if (!restore_here()) return fail("the match could not be restored from its own snapshot");
  }
  if (!restored) {
    return fail("--restore-at " + std::to_string(*options.restore_at) +
                " was not reached: the replay has only " + std::to_string(playback.ticks()) +
                " ticks");
  }

  const auto& view = match.view();
  std::printf("ticks    %" PRIu64 "\n", playback.ticks());
  std::printf("hash     %016" PRIx64 "\n", match.state_hash());
  std::printf("score    %d : %d\n", view.score[0], view.score[1]);
  std::printf("verdict  %s\n", playback.verdict_sentence().c_str());
  return server::exit_code(playback.verdict());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{
      "Replays a recorded match without a screen and compares it with the original.\n\n"
      "Exit codes: 0 the same; 1 it differs; 2 a bad option or file; 4 the same, but the "
      "recording\n"
      "stops early.",
      "foosball-replay"};
  Options options;
  cli.add_option("FILE", options.file, "a journal, as --record writes it")->required();
  cli.add_option("--until", options.until, "stop after this number of ticks")
      ->check(CLI::PositiveNumber);
  cli.add_option("--restore-at", options.restore_at,
                 "after this number of ticks, save the match and continue in another one");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(cli.help().c_str(), stdout);
    return server::kExitOk;
  } catch (const CLI::ParseError& error) {
    return fail(std::string(error.what()) + "; --help explains the options");
  }
  auto playback = server::Playback::open(options.file);
  if (!playback) return fail(playback.error());
  auto match = foosball::Match::create((*playback)->match());
  if (!match) return fail(match.error().message);
  return replay(options, **playback, *match);
}
