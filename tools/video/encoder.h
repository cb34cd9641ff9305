// Encodes pictures to a video file with the program ffmpeg, which runs as a separate process and
// receives the pictures through a pipe.
#pragma once

#include <sys/types.h>

#include <glm/vec2.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "draw/image.h"
#include "os/file_descriptor.h"

namespace video {

struct EncoderOptions {
  std::string path;  // its extension selects the format: .mp4, .mkv, .webm
  glm::ivec2 size{1280, 720};
  int frames_per_second = 60;
  int samples_per_second = 44100;
};

// The codec options of ffmpeg's command line for this file name, or a sentence with the valid
// extensions.
tl::expected<std::vector<std::string>, std::string> codec_for(const std::string& path);

class Encoder {
 public:
  // Replaces an existing file. sound: file of 16-bit stereo samples, read from its present offset,
  // or -1 for none. The error is a sentence.
  static tl::expected<Encoder, std::string> start(const EncoderOptions& options, int sound);
  Encoder(Encoder&& other) noexcept;
  Encoder& operator=(Encoder&&) = delete;
  ~Encoder();  // without finish(): ends ffmpeg and leaves its output

  // Blocks while ffmpeg is busy. Precondition: the picture has the size of the options.
  tl::expected<void, std::string> write(const draw::Image& picture);
  // No more pictures: waits until the file is complete.
  tl::expected<void, std::string> finish();

 private:
  Encoder(pid_t process, os::FileDescriptor pictures, os::FileDescriptor complaints);
  std::string failure();  // waits for ffmpeg; empty: it succeeded

  pid_t process_;
  os::FileDescriptor pictures_;    // to ffmpeg
  os::FileDescriptor complaints_;  // an anonymous file with ffmpeg's messages
};

}  // namespace video
