// A program that is told lines and answers lines. Whatever it does, the one who asks goes on.
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
  // Its errors are added to the file log. The error is a sentence.
  static tl::expected<Child, std::string> start(const std::vector<std::string>& words,
                                                const std::string& log);
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  ~Child();  // ends it

  void tell(const std::string& line);
  // The next answer that is one of ready, cannot, more, end; other lines are passed over. The error
  // says how it ended, or that it did not answer in time; it is ended then.
  tl::expected<Answer, std::string> hear(double seconds);

 private:
  Child(pid_t pid, int to, int from) : pid_(pid), to_(to), from_(from) {}
  void end();
  std::string how_it_ended();

  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
  std::string heard_;
};

}  // namespace rigid
