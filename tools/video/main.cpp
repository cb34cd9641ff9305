// space-foosball-video: encodes a recorded match as a video, drawn like the game.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string>

#include "film.h"
#include "options.h"
#include "os/clock.h"
#include "server/exit_code.h"
#include "server/recorded_scene.h"
#include "soundtrack.h"

namespace {

constexpr int kNoDisplay = 4;

int fail(int code, const std::string& sentence) {
  std::fprintf(stderr, "space-foosball-video: %s\n", sentence.c_str());
  return code;
}

// Progress on one line of a terminal, or each tenth elsewhere.
class Progress {
 public:
  explicit Progress(std::uint64_t frames) : frames_(frames), began_us_(os::monotonic_us()) {}

  void drawn(std::uint64_t frame) {
    const double seconds = 1e-6 * static_cast<double>(os::monotonic_us() - began_us_);
    const double rate = static_cast<double>(frame) / std::max(seconds, 1e-3);
    const double left = static_cast<double>(frames_ - frame) / std::max(rate, 1e-3);
    const std::uint64_t tenth = 10 * frame / frames_;
    if (!terminal_ && tenth == tenth_) return;
    tenth_ = tenth;
    std::printf("%sframe %llu of %llu, %.1f a second, %.0f s left%s", terminal_ ? "\r" : "",
                static_cast<unsigned long long>(frame), static_cast<unsigned long long>(frames_),
                rate, left, terminal_ && frame != frames_ ? "   " : "\n");
    std::fflush(stdout);
  }

 private:
  std::uint64_t frames_, tenth_ = 0;
  std::int64_t began_us_;
  bool terminal_ = ::isatty(STDOUT_FILENO) == 1;
};

std::uint64_t ticks_of(double seconds) {
  return static_cast<std::uint64_t>(seconds / foosball::kTick);
}

// Opens the recording again for the sound. On failure the video is silent, with a message.
os::FileDescriptor sound_of(const video::Options& options, const video::Span& span) {
  if (options.mute) return {};
  auto scene = server::RecordedScene::open(options.recording);
  auto sound =
      scene ? video::soundtrack(*scene, span, options.team, options.view, options.encoder.size)
            : tl::unexpected(scene.error());
  if (!sound) {
    fail(0, sound.error() + " The video has no sound.");
    return {};
  }
  return std::move(*sound);
}

int run(const video::Options& options) {
  auto scene = server::RecordedScene::open(options.recording);
  if (!scene) return fail(server::kExitUsage, scene.error());
  const std::uint64_t from = ticks_of(options.from);
  const std::uint64_t end =
      std::min(options.to ? ticks_of(*options.to) : scene->total_ticks(), scene->total_ticks());
  if (from >= end) {
    return fail(server::kExitUsage, options.recording + " is over after " +
                                        std::to_string(scene->total_ticks() / 1000) +
                                        " s: --from begins after that.");
  }
  auto film = video::Film::open({options.encoder.size, options.quality}, scene->characters());
  if (!film) return fail(kNoDisplay, film.error().sentence);
  const video::Span span{from, end, static_cast<std::uint64_t>(options.encoder.frames_per_second)};
  const os::FileDescriptor sound = sound_of(options, span);
  auto encoder = video::Encoder::start(options.encoder, sound.get());
  if (!encoder) return fail(server::kExitFailed, encoder.error());

  video::Staging staging(options.team, scene->characters(), options.view);
  Progress progress(span.frames());
  const float dt = 1.0f / static_cast<float>(span.frames_per_second);
  scene->advance_to(from);
  scene->take_events();  // drops events before the first frame
  for (std::uint64_t frame = 0; frame < span.frames(); ++frame) {
    scene->advance_to(span.tick(frame + 1));
    staging.advance(scene->snapshot(), scene->take_events(), dt, nullptr);
    const float time = dt * static_cast<float>(frame);
    if (auto written = encoder->write((*film)->frame(scene->snapshot(), staging, time)); !written)
      return fail(server::kExitFailed, written.error());
    progress.drawn(frame + 1);
  }
  if (end == scene->total_ticks()) scene->advance_to(end + 1);  // reads the entry of the end
  if (auto done = encoder->finish(); !done) return fail(server::kExitFailed, done.error());
  std::printf("written  %s: %.1f s of the match\nverdict  %s\n", options.encoder.path.c_str(),
              1e-3 * static_cast<double>(end - from), scene->playback().verdict_sentence().c_str());
  return server::exit_code(scene->playback().verdict());
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // ffmpeg may end early; write() then returns the error
  const auto options = video::parse_options(argc, argv);
  if (!options) {
    const draw::Leave& leave = options.error();
    if (leave.exit_code != 0) return fail(leave.exit_code, leave.text);
    std::fputs(leave.text.c_str(), stdout);
    return 0;
  }
  return run(*options);
}
