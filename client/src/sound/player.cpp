#include "sound/player.h"

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "os/file_descriptor.h"

namespace client {
namespace {

constexpr int kFirstLoop = static_cast<int>(Sound::roll);
constexpr std::size_t kLoops = kSounds - kFirstLoop;
constexpr std::size_t kVoices = 24;  // more at once are indistinguishable; the oldest is replaced

// Silences stderr while a device is opened. Without a device the libraries below OpenAL print a
// dozen lines, which cannot be disabled; the game reports it in one sentence. No other thread runs
// then.
class QuietStderr {
 public:
  QuietStderr() : kept_(::dup(STDERR_FILENO)) {
    const os::FileDescriptor nowhere(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    if (kept_ && nowhere) ::dup2(nowhere.get(), STDERR_FILENO);
  }
  ~QuietStderr() {
    if (kept_) ::dup2(kept_.get(), STDERR_FILENO);
  }
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  os::FileDescriptor kept_;
};

}  // namespace

struct SoundPlayer::Impl {
  ALCdevice* device = nullptr;
  ALCcontext* context = nullptr;
  std::array<ALuint, kSounds> buffers{};
  std::array<ALuint, kVoices> voices{};
  std::array<ALuint, kLoops> loops{};
  std::size_t next = 0;
  bool made = false;
  LPALCRENDERSAMPLESSOFT render = nullptr;  // of an offline player

  ~Impl() {
    if (made) {
      alDeleteSources(static_cast<ALsizei>(voices.size()), voices.data());
      alDeleteSources(static_cast<ALsizei>(loops.size()), loops.data());
      alDeleteBuffers(static_cast<ALsizei>(buffers.size()), buffers.data());
    }
    alcMakeContextCurrent(nullptr);
    if (context != nullptr) alcDestroyContext(context);
    if (device != nullptr) alcCloseDevice(device);
  }
};

SoundPlayer::SoundPlayer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SoundPlayer::~SoundPlayer() = default;

tl::expected<std::unique_ptr<SoundPlayer>, std::string> SoundPlayer::open() {
  auto impl = std::make_unique<Impl>();
  {
    const QuietStderr quiet;
    impl->device = alcOpenDevice(nullptr);
  }
  if (impl->device == nullptr) {
    return tl::unexpected(std::string(
        "No audio device could be opened: playing on without sound (--mute says so beforehand)."));
  }
  return prepare(std::move(impl), nullptr);
}

tl::expected<std::unique_ptr<SoundPlayer>, std::string> SoundPlayer::open_offline() {
  auto impl = std::make_unique<Impl>();
  const auto open_loopback = reinterpret_cast<LPALCLOOPBACKOPENDEVICESOFT>(
      alcGetProcAddress(nullptr, "alcLoopbackOpenDeviceSOFT"));
  impl->render =
      reinterpret_cast<LPALCRENDERSAMPLESSOFT>(alcGetProcAddress(nullptr, "alcRenderSamplesSOFT"));
  if (open_loopback != nullptr && impl->render != nullptr) impl->device = open_loopback(nullptr);
  if (impl->device == nullptr)
    return tl::unexpected(std::string("This OpenAL cannot render sound into a file."));
  constexpr std::array<int, 7> kStereo{ALC_FORMAT_CHANNELS_SOFT,
                                       ALC_STEREO_SOFT,
                                       ALC_FORMAT_TYPE_SOFT,
                                       ALC_SHORT_SOFT,
                                       ALC_FREQUENCY,
                                       kSampleRate,
                                       0};
  return prepare(std::move(impl), kStereo.data());
}

tl::expected<std::unique_ptr<SoundPlayer>, std::string> SoundPlayer::prepare(
    std::unique_ptr<Impl> impl, const int* attributes) {
  impl->context = alcCreateContext(impl->device, attributes);
  if (impl->context == nullptr || !alcMakeContextCurrent(impl->context)) {
    return tl::unexpected(
        std::string("The audio device gives no OpenAL context: playing on without sound."));
  }
  alGenBuffers(static_cast<ALsizei>(impl->buffers.size()), impl->buffers.data());
  alGenSources(static_cast<ALsizei>(impl->voices.size()), impl->voices.data());
  alGenSources(static_cast<ALsizei>(impl->loops.size()), impl->loops.data());
  impl->made = true;
  for (std::size_t i = 0; i < impl->buffers.size(); ++i) {
    const auto samples = synthesise(static_cast<Sound>(i));
    alBufferData(impl->buffers[i], AL_FORMAT_MONO16, samples.data(),
                 static_cast<ALsizei>(samples.size() * sizeof samples[0]), kSampleRate);
  }
  for (std::size_t i = 0; i < kLoops; ++i) {
    const ALuint source = impl->loops[i];
    alSourcei(source, AL_BUFFER, static_cast<ALint>(impl->buffers[kFirstLoop + i]));
    alSourcei(source, AL_LOOPING, AL_TRUE);
    alSourcef(source, AL_GAIN, 0.0f);
    alSourcePlay(source);
  }
  if (alGetError() != AL_NO_ERROR)
    return tl::unexpected(std::string("OpenAL has no room for the sounds: playing on without."));
  return std::unique_ptr<SoundPlayer>(new SoundPlayer(std::move(impl)));
}

std::vector<std::int16_t> SoundPlayer::render(int moments) {
  std::vector<std::int16_t> samples(2 * static_cast<std::size_t>(moments));
  impl_->render(impl_->device, samples.data(), moments);
  return samples;
}

void SoundPlayer::set_listener(const glm::vec3& eye, const glm::vec3& at) {
  const glm::vec3 forward = glm::normalize(at - eye);
  const float orientation[6] = {forward.x, forward.y, forward.z, 0, 0, 1};
  alListener3f(AL_POSITION, eye.x, eye.y, eye.z);
  alListenerfv(AL_ORIENTATION, orientation);
}

void SoundPlayer::set_volume(float volume) {
  alListenerf(AL_GAIN, std::clamp(volume, 0.0f, 1.0f));
}

void SoundPlayer::play(Sound sound, float volume, const glm::vec3& at, float pitch) {
  const ALuint voice = impl_->voices[impl_->next];
  impl_->next = (impl_->next + 1) % kVoices;
  alSourceStop(voice);
  alSourcei(voice, AL_BUFFER, static_cast<ALint>(impl_->buffers[static_cast<std::size_t>(sound)]));
  alSourcef(voice, AL_GAIN, std::clamp(volume, 0.0f, 1.0f));
  // Varies the pitch by up to about half a semitone, so that a rally does not sound mechanical.
  alSourcef(voice, AL_PITCH, pitch * (0.97f + 0.02f * static_cast<float>(impl_->next % 4)));
  alSource3f(voice, AL_POSITION, at.x, at.y, at.z);
  alSourcePlay(voice);
}

void SoundPlayer::set_loop(Sound loop, float volume, const glm::vec3& at, float pitch) {
  const ALuint source = impl_->loops[static_cast<std::size_t>(loop) - kFirstLoop];
  alSourcef(source, AL_GAIN, std::clamp(volume, 0.0f, 1.0f));
  alSourcef(source, AL_PITCH, std::clamp(pitch, 0.5f, 2.0f));
  alSource3f(source, AL_POSITION, at.x, at.y, at.z);
}

float volume_of_impulse(float impulse) {
  constexpr float kQuietest = 0.05f;  // -26 dB, at kSoftestImpulse
  if (!(impulse > 0.0f)) return 0.0f;
  const float share =
      std::log(impulse / kSoftestImpulse) / std::log(kHardestImpulse / kSoftestImpulse);
  return share < 0.0f ? 0.0f : std::pow(kQuietest, 1.0f - std::min(share, 1.0f));
}

RollingSound rolling_sound(float speed) {
  constexpr float kHeard = 0.05f, kFull = 6.0f;  // [m/s]
  const float share = std::clamp((speed - kHeard) / (kFull - kHeard), 0.0f, 1.0f);
  return {0.5f * std::sqrt(share), 0.7f + 0.8f * share};
}

}  // namespace client
