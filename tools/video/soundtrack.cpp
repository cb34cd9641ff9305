#include "soundtrack.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "film.h"

namespace video {
namespace {

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

std::uint64_t Span::frames() const {
  return std::max<std::uint64_t>(1, (end - from) * frames_per_second / 1000);
}

tl::expected<os::FileDescriptor, std::string> soundtrack(server::RecordedScene& scene,
                                                         const Span& span, int team,
                                                         client::View view,
                                                         const glm::ivec2& size) {
  auto sounds = client::SoundPlayer::open_offline();
  if (!sounds) return tl::unexpected(sounds.error());
  os::FileDescriptor file(::memfd_create("soundtrack", MFD_CLOEXEC));
  if (!file) return tl::unexpected(std::string("No room for the sound: ") + std::strerror(errno));
  Staging staging(team, scene.characters(), view);
  scene.advance_to(span.from);
  scene.take_events();  // drops events before the first frame
  const auto fps = static_cast<float>(span.frames_per_second);
  std::uint64_t moments = 0;  // number of samples so far
  for (std::uint64_t frame = 0; frame < span.frames(); ++frame) {
    scene.advance_to(span.tick(frame + 1));
    staging.advance(scene.snapshot(), scene.take_events(), 1.0f / fps, sounds->get());
    (*sounds)->set_listener(staging.camera(size).eye, glm::vec3(0));
    const std::uint64_t until = (frame + 1) * client::kSampleRate / span.frames_per_second;
    const auto samples = (*sounds)->render(static_cast<int>(until - moments));
    moments = until;
    if (!write_all(file.get(), std::as_bytes(std::span(samples))))
      return tl::unexpected(std::string("No room for the sound: ") + std::strerror(errno));
  }
  if (::lseek(file.get(), 0, SEEK_SET) != 0)
    return tl::unexpected(std::string("The sound cannot be read back: ") + std::strerror(errno));
  return file;
}

}  // namespace video
