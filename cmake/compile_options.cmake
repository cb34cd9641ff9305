# Options shared by every target. -ffp-contract=off and the absence of fast-math keep the simulation
# the same to the bit on every compiler and level.
add_library(sf_options INTERFACE)
target_compile_options(sf_options INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                                            -ffp-contract=off)
# Nobody reads errno after a function of <cmath>, or the processor's flags of floating-point exceptions.
target_compile_options(sf_options INTERFACE -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # g++ 12 copies structs of some hundred bytes by "rep movs", which takes tens of cycles to begin
  # (docs/decisions/0055).
  foreach(what memcpy memset)
    target_compile_options(sf_options INTERFACE
      -m${what}-strategy=vector_loop:1024:noalign,libcall:-1:noalign)
  endforeach()
endif()
if(CMAKE_UNITY_BUILD)
  # What one source names locally, another of the same compilation may have at its top.
  target_compile_options(sf_options INTERFACE -Wno-shadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # It takes an included source for a header, whose classes must not hold what is local to it.
    target_compile_options(sf_options INTERFACE -Wno-subobject-linkage)
  endif()
endif()
if(SF_WERROR)
  target_compile_options(sf_options INTERFACE -Werror)
endif()
if(SF_SANITIZE)
  target_compile_options(sf_options INTERFACE -fsanitize=${SF_SANITIZE} -fno-omit-frame-pointer
                                              -fno-sanitize-recover=all)
  target_link_options(sf_options INTERFACE -fsanitize=${SF_SANITIZE})
endif()
