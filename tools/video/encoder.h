// Pictures into a video file, by the program ffmpeg, which is started as a process of its own and
// is given the pictures over a pipe.
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
  std::string path;  // its ending says the format: .mp4, .mkv, .webm
  glm::ivec2 size{1280, 720};
  int frames_per_second = 60;
  int samples_per_second = 44100;
};

// The codec's part of ffmpeg's command line for a file of that name, or a sentence that says which
// endings there are.
tl::expected<std::vector<std::string>, std::string> codec_for(const std::string& path);

class Encoder {
 public:
  // The error is a sentence. The file is replaced if it is there.
  // sound: 16-bit stereo samples from where it stands, or -1 for none.
  static tl::expected<Encoder, std::string> start(const EncoderOptions& options, int sound);
  Encoder(Encoder&& other) noexcept;
  Encoder& operator=(Encoder&&) = delete;
  ~Encoder();  // without finish(): ends ffmpeg and leaves what it has written

  // Waits while ffmpeg is busy. Precondition: the picture has the size of the options.
  tl::expected<void, std::string> write(const draw::Image& picture);
  // No more pictures: waits until the file is complete.
  tl::expected<void, std::string> finish();

 private:
  Encoder(pid_t process, os::FileDescriptor pictures, os::FileDescriptor complaints);
  std::string failure();  // waits for ffmpeg; empty: it ended well

  pid_t process_;
  os::FileDescriptor pictures_;    // to ffmpeg
  os::FileDescriptor complaints_;  // a file without a name, which holds what ffmpeg says
};

}  // namespace video
