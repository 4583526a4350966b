# What `cmake --install` puts where. Components: runtime (programs, configuration, documentation) and development (the
# messages for programs of others: .lcm files, C++ headers, CMake package, pkg-config file).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Programs for the user, and one process per stage.
install(TARGETS sgraphs sgraphs_velodyne_driver_process sgraphs_odometry_process sgraphs_planes_process sgraphs_free_space_process
  sgraphs_rooms_process sgraphs_loops_process sgraphs_backend_process sgraphs_spot_bridge_process
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(FILES config/sgraphs.yaml DESTINATION ${CMAKE_INSTALL_DATADIR}/sgraphs COMPONENT runtime)
install(FILES README.md LICENSE THIRD_PARTY_NOTICES.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sgraphs COMPONENT runtime)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sgraphs/docs COMPONENT runtime)
if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/config/systemd)
  install(DIRECTORY config/systemd/ DESTINATION lib/systemd/system COMPONENT runtime
    FILES_MATCHING PATTERN "*.service" PATTERN "*.target")
endif()

# find_package(sgraphs) gives sgraphs::lcmtypes: include "sgraphs/session_t.hpp".
list(TRANSFORM SGRAPHS_LCM_TYPES REPLACE "(.+)" "lcmtypes/\\1.lcm" OUTPUT_VARIABLE lcm_files)
install(FILES ${lcm_files} DESTINATION ${CMAKE_INSTALL_DATADIR}/sgraphs/lcmtypes COMPONENT development)
list(TRANSFORM SGRAPHS_LCM_TYPES REPLACE "(.+)" "${PROJECT_BINARY_DIR}/lcmtypes/generated/sgraphs/\\1.hpp" OUTPUT_VARIABLE headers)
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sgraphs COMPONENT development)
install(TARGETS sgraphs_lcmtypes EXPORT sgraphsTargets)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sgraphs)
install(EXPORT sgraphsTargets NAMESPACE sgraphs:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(cmake/sgraphsConfig.cmake.in ${PROJECT_BINARY_DIR}/sgraphsConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# Messages may change with every minor version before 1.0.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sgraphsConfigVersion.cmake COMPATIBILITY SameMinorVersion
  ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/sgraphsConfig.cmake ${PROJECT_BINARY_DIR}/sgraphsConfigVersion.cmake
  cmake/FindLCM.cmake DESTINATION ${package_folder} COMPONENT development)
# The tree may be moved: paths are relative to the file that holds them.
file(RELATIVE_PATH PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" PREFIX_FROM_PC ${PREFIX_FROM_PC})
configure_file(cmake/sgraphs-lcmtypes.pc.in ${PROJECT_BINARY_DIR}/sgraphs-lcmtypes.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/sgraphs-lcmtypes.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
