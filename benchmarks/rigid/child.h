// A child process that reads and writes lines. Its failure does not stop the parent.
#pragma once

#include <sys/types.h>

#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace rigid {

struct Answer {
  std::string word, text;  // "end", "finished"
};

class Child {
 public:
  // Starts the program; its standard error is appended to the file log. The error is a sentence.
  static tl::expected<Child, std::string> start(const std::vector<std::string>& words,
                                                const std::string& log);
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  ~Child();  // kills it

  void send(const std::string& line);
  // Returns the next answer: ready, cannot, more or end. Skips other lines. The error says how the
  // program ended, or that it did not answer in time; then it is killed.
  tl::expected<Answer, std::string> receive(double seconds);

 private:
  Child(pid_t pid, int to, int from) : pid_(pid), to_(to), from_(from) {}
  void end();
  std::string how_it_ended();

  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
  std::string received_;
};

}  // namespace rigid
