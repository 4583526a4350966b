# Finds LCM as Debian packages it: liblcm-dev 1.3.1 ships no CMake files, and its lcm.pc requires glib's
# development files that it does not depend on. Defines LCM::lcm, LCM_GEN_EXECUTABLE, LCM_LOGPLAYER_EXECUTABLE.
find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp)
find_library(LCM_LIBRARY lcm)
find_program(LCM_GEN_EXECUTABLE lcm-gen)
find_program(LCM_LOGPLAYER_EXECUTABLE lcm-logplayer)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LCM
  REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR LCM_GEN_EXECUTABLE
  REASON_FAILURE_MESSAGE "install liblcm-dev and liblcm-bin (tools/install-dependencies does)")

if(LCM_FOUND AND NOT TARGET LCM::lcm)
  add_library(LCM::lcm UNKNOWN IMPORTED)
  set_target_properties(LCM::lcm PROPERTIES
    IMPORTED_LOCATION "${LCM_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${LCM_INCLUDE_DIR}")
endif()
mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN_EXECUTABLE LCM_LOGPLAYER_EXECUTABLE)
