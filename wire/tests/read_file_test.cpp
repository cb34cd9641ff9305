#include "wire/read_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

namespace wire::test {
namespace {

std::string written(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

TEST(ReadFile, GivesEveryByteUpToTheCap) {
  const std::string text(200'000, 'x');
  const std::string path = written("wire_read_file_whole", text);
  const auto bytes = read_file(path, text.size());
  ASSERT_TRUE(bytes.has_value()) << bytes.error();
  EXPECT_EQ(bytes->size(), text.size());
  EXPECT_EQ(bytes->back(), std::byte{'x'});
  EXPECT_FALSE(read_file(path, text.size() - 1).has_value()) << "above the cap";
}

TEST(ReadFile, AnEmptyFileIsEmpty) {
  const auto bytes = read_file(written("wire_read_file_empty", ""), 10);
  ASSERT_TRUE(bytes.has_value());
  EXPECT_TRUE(bytes->empty());
}

TEST(ReadFile, AMissingFileAndADirectoryAreNamedInTheError) {
  for (const std::string path : {"/no/such/file.journal", "/tmp"}) {
    const auto bytes = read_file(path, 1000);
    ASSERT_FALSE(bytes.has_value());
    EXPECT_TRUE(bytes.error().starts_with(path + ": ")) << bytes.error();
    EXPECT_TRUE(bytes.error().ends_with(".")) << bytes.error();
  }
}

// Like a shell's <(command).
TEST(ReadFile, APipeIsReadToItsEnd) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ASSERT_EQ(::write(ends[1], "abc", 3), 3);
  ::close(ends[1]);
  const auto bytes = read_file("/dev/fd/" + std::to_string(ends[0]), 10);
  ::close(ends[0]);
  ASSERT_TRUE(bytes.has_value()) << bytes.error();
  EXPECT_EQ(bytes->size(), 3u);
}

TEST(ReadFile, AnEndlessDeviceIsCutAtTheCap) {
  EXPECT_FALSE(read_file("/dev/zero", 1'000'000).has_value());
}

}  // namespace
}  // namespace wire::test
