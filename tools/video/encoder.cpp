#include "encoder.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

namespace video {
namespace {

constexpr int kSound = 3;  // the descriptor from which ffmpeg reads the sound

std::vector<std::string> command_line(const EncoderOptions& options, bool sound,
                                      const std::vector<std::string>& codec) {
  const std::string size = std::to_string(options.size.x) + "x" + std::to_string(options.size.y);
  std::vector<std::string> words{"ffmpeg", "-loglevel", "error", "-nostdin", "-y"};
  words.insert(words.end(),
               {"-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", size, "-framerate",
                std::to_string(options.frames_per_second), "-i", "pipe:0"});
  if (sound) {
    words.insert(words.end(),
                 {"-f", "s16le", "-ac", "2", "-ar", std::to_string(options.samples_per_second),
                  "-i", "pipe:" + std::to_string(kSound)});
  }
  words.insert(words.end(), codec.begin(), codec.end());
  words.push_back("file:" + options.path);  // "file:": never parsed as another protocol
  return words;
}

// ffmpeg reads the pictures from its standard input; its messages go to the file.
int spawn(std::vector<std::string> words, int pictures, int sound, int complaints, pid_t& process) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pictures, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, complaints, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, complaints, STDERR_FILENO);
  if (sound >= 0) posix_spawn_file_actions_adddup2(&actions, sound, kSound);
  const int error =
      posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

std::string first_line(int fd) {
  std::array<char, 400> text{};
  const ssize_t size = ::pread(fd, text.data(), text.size() - 1, 0);
  std::string line(text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  return line.substr(0, line.find('\n'));
}

}  // namespace

tl::expected<std::vector<std::string>, std::string> codec_for(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension();
  // All players support yuv420p. crf: visually almost lossless.
  if (ending == ".mp4" || ending == ".mkv") {
    return std::vector<std::string>{"-c:v", "libx264",  "-preset", "veryfast",  "-crf",
                                    "18",   "-pix_fmt", "yuv420p", "-movflags", "+faststart",
                                    "-c:a", "aac",      "-b:a",    "160k"};
  }
  if (ending == ".webm") {
    return std::vector<std::string>{"-c:v",    "libvpx-vp9", "-crf",      "28",
                                    "-b:v",    "0",          "-deadline", "realtime",
                                    "-row-mt", "1",          "-pix_fmt",  "yuv420p"};
  }
  return tl::unexpected("\"" + path + "\" does not say which kind of video it is to be: name it " +
                        "*.mp4, *.mkv or *.webm.");
}

tl::expected<Encoder, std::string> Encoder::start(const EncoderOptions& options, int sound) {
  const auto codec = codec_for(options.path);
  if (!codec) return tl::unexpected(codec.error());
  std::array<int, 2> ends{};
  os::FileDescriptor complaints(::memfd_create("ffmpeg", MFD_CLOEXEC));
  if (!complaints || ::pipe2(ends.data(), O_CLOEXEC) != 0)
    return tl::unexpected(std::string("No pipe to ffmpeg: ") + std::strerror(errno) + ".");
  const os::FileDescriptor from(ends[0]);
  os::FileDescriptor pictures(ends[1]);
  pid_t process = -1;
  const int error = spawn(command_line(options, sound >= 0, *codec), from.get(), sound,
                          complaints.get(), process);
  if (error == ENOENT)
    return tl::unexpected(
        std::string("ffmpeg is not installed: on Debian, apt-get install ffmpeg."));
  if (error != 0)
    return tl::unexpected(std::string("ffmpeg cannot be started: ") + std::strerror(error) + ".");
  return Encoder(process, std::move(pictures), std::move(complaints));
}

Encoder::Encoder(pid_t process, os::FileDescriptor pictures, os::FileDescriptor complaints)
    : process_(process), pictures_(std::move(pictures)), complaints_(std::move(complaints)) {}

Encoder::Encoder(Encoder&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      pictures_(std::move(other.pictures_)),
      complaints_(std::move(other.complaints_)) {}

Encoder::~Encoder() {
  if (process_ < 0) return;
  pictures_.reset();
  ::kill(process_, SIGTERM);
  failure();
}

tl::expected<void, std::string> Encoder::write(const draw::Image& picture) {
  std::span<const std::uint8_t> left(picture.rgb);
  while (!left.empty()) {
    const ssize_t written = ::write(pictures_.get(), left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      if (auto ended = finish(); !ended) return ended;
      return tl::unexpected(std::string("ffmpeg stopped accepting pictures, without a message."));
    }
    left = left.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

tl::expected<void, std::string> Encoder::finish() {
  pictures_.reset();
  if (std::string sentence = failure(); !sentence.empty())
    return tl::unexpected(std::move(sentence));
  return {};
}

std::string Encoder::failure() {
  int status = 0;
  const pid_t process = std::exchange(process_, -1);
  if (process < 0) return "ffmpeg has ended already.";
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  // ffmpeg reports a full disk without a failing exit code.
  const std::string said = first_line(complaints_.get());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && said.empty()) return {};
  if (!said.empty()) return "ffmpeg could not write the video: " + said;
  return WIFSIGNALED(status)
             ? "ffmpeg was ended by signal " + std::to_string(WTERMSIG(status)) + "."
             : "ffmpeg could not write the video, and gave no message.";
}

}  // namespace video
