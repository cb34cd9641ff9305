# Options shared by every target. -ffp-contract=off and the absence of fast-math keep the simulation
# the same to the bit on every compiler and level.
add_library(sf_options INTERFACE)
target_compile_options(sf_options INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                                            -ffp-contract=off)
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
