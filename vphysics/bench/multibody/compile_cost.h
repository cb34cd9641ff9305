// The cost of compiling a program that uses the library.
#pragma once

#include <string>
#include <tl/expected.hpp>

namespace vp::bench {

struct CompileCost {
  double seconds;    // to compile and link
  double megabytes;  // peak memory of the largest of the compiler's processes
};
// Compiles user_program.cpp with the compiler, the headers and the library of this build, and runs
// it. The error is a sentence.
tl::expected<CompileCost, std::string> compile_cost();

}  // namespace vp::bench
