// The sound of a recording between two moments, as samples in an anonymous file.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>

#include "client/settings.h"
#include "os/file_descriptor.h"
#include "server/recorded_scene.h"

namespace video {

// The ticks of a recording that a video shows, frame by frame. Frame i shows the scene after tick(i
// + 1).
struct Span {
  std::uint64_t from = 0, end = 0;  // [ticks]
  std::uint64_t frames_per_second = 60;

  std::uint64_t frames() const;
  std::uint64_t tick(std::uint64_t frame) const { return from + frame * 1000 / frames_per_second; }
};

// Plays the recording once, in a hundredth of its duration. The samples are 16-bit stereo,
// client::kSampleRate per second, from the beginning of the file. The error is a sentence: OpenAL
// cannot render offline, or the disk is full.
tl::expected<os::FileDescriptor, std::string> soundtrack(server::RecordedScene& scene,
                                                         const Span& span, int team,
                                                         client::View view, const glm::ivec2& size);

}  // namespace video
