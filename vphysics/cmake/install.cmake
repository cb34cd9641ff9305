# cmake --install: libraries, public headers, the CMake package and the pkg-config files. Everything
# finds itself from where it lies, so that the folder may be moved.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/VirtualPhysics)
file(RELATIVE_PATH VPHYSICS_UP /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
set(VPHYSICS_QUIET "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(VPHYSICS_QUIET " -Wno-psabi")
endif()

# One library: what a user links, what carries its targets, what pkg-config reads.
function(vphysics_install target exported)
  add_library(VirtualPhysics::${exported} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${exported})
  target_include_directories(${target} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS ${target} EXPORT ${ARGV2} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT ${ARGV2} NAMESPACE VirtualPhysics:: DESTINATION ${package_dir})
  configure_file(cmake/${target}.pc.in ${CMAKE_CURRENT_BINARY_DIR}/${target}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${target}.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

vphysics_install(vphysics vphysics VirtualPhysicsTargets)
vphysics_install(vphysics_packs packs VirtualPhysicsPacksTargets)
set(without "")
if(TARGET vphysics_urdf)
  vphysics_install(vphysics_urdf urdf VirtualPhysicsUrdfTargets)
else()
  foreach(header mesh_file.h urdf.h urdf_world.h)
    list(APPEND without PATTERN ${header} EXCLUDE)
  endforeach()
endif()
if(TARGET vphysics_tbb)
  vphysics_install(vphysics_tbb tbb VirtualPhysicsTbbTargets)
else()
  list(APPEND without PATTERN tbb_task_scheduler.h EXCLUDE)
endif()
install(DIRECTORY include/vphysics DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${without})

configure_package_config_file(
  cmake/VirtualPhysicsConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/VirtualPhysicsConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/VirtualPhysicsConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/VirtualPhysicsConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/VirtualPhysicsConfigVersion.cmake
        DESTINATION ${package_dir})
