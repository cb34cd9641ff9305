// Logging never waits, whatever the reader does.
#include "server/log_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include "os/file_descriptor.h"

namespace server {
namespace {

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{-1, -1};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    reading = os::FileDescriptor(ends[0]);
    writing = os::FileDescriptor(ends[1]);
  }
  std::string read_some() {
    std::array<char, 65536> buffer;
    const ssize_t size = ::read(reading.get(), buffer.data(), buffer.size());
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : std::string();
  }
  os::FileDescriptor reading, writing;
};

TEST(LogWriter, WritesAllInOrder) {
  Pipe pipe;
  {
    LogWriter log(pipe.writing.get());
    for (int i = 0; i < 100; ++i) log.write(std::to_string(i) + "\n");
    EXPECT_TRUE(log.flush(5'000'000));
  }
  std::string expected;
  for (int i = 0; i < 100; ++i) expected += std::to_string(i) + "\n";
  EXPECT_EQ(pipe.read_some(), expected);
}

TEST(LogWriter, NeverWaitsForAPipeThatNobodyReadsAndSaysWhatItLeftOut) {
  Pipe pipe;
  LogWriter log(pipe.writing.get());
  const std::string line(99, 'x');
  const auto begun = std::chrono::steady_clock::now();
  constexpr int kLines = 20'000;  // 2 MB: a pipe takes 64 kB
  for (int i = 0; i < kLines; ++i) log.write(line + "\n");
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
  EXPECT_FALSE(log.flush(1000));
  EXPECT_GT(log.dropped(), 10'000u);
  std::string read;
  while (read.find("lines were omitted here") == std::string::npos) {
    const std::string more = pipe.read_some();
    ASSERT_FALSE(more.empty());
    read += more;
  }
  while (!log.flush(1000)) pipe.read_some();  // pending text is being written
}

TEST(LogWriter, EndsThoughNobodyReadsAndThoughTheReaderHasGone) {
  ::signal(SIGPIPE, SIG_IGN);
  const auto begun = std::chrono::steady_clock::now();
  {
    Pipe stuck;
    LogWriter log(stuck.writing.get());
    log.write(std::string(200'000, 'x'));
  }
  Pipe gone;
  gone.reading.reset();
  LogWriter log(gone.writing.get());
  log.write("nobody hears this\n");
  EXPECT_TRUE(log.flush(5'000'000));
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(10));
}

}  // namespace
}  // namespace server
