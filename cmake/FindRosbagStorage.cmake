# Finds rosbag's storage library as Debian packages it: its own CMake files expect a ROS workspace, and its headers
# include those of packages that Debian keeps one folder deeper. Defines RosbagStorage::rosbag_storage.
find_path(ROSBAG_STORAGE_INCLUDE_DIR rosbag/bag.h)
set(_directories ${ROSBAG_STORAGE_INCLUDE_DIR})
set(_variables ROSBAG_STORAGE_INCLUDE_DIR)
foreach(_pair pluginlib:class_loader.hpp class_loader:class_loader.hpp ament_index_cpp:get_resource.hpp
              rcpputils:env.hpp rcutils:macros.h)
  string(REPLACE ":" ";" _pair ${_pair})
  list(GET _pair 0 _package)
  list(GET _pair 1 _header)
  find_path(ROSBAG_STORAGE_${_package}_INCLUDE_DIR ${_package}/${_header} PATH_SUFFIXES ${_package})
  list(APPEND _directories ${ROSBAG_STORAGE_${_package}_INCLUDE_DIR})
  list(APPEND _variables ROSBAG_STORAGE_${_package}_INCLUDE_DIR)
endforeach()
set(_libraries)
foreach(_library rosbag_storage roscpp_serialization rostime cpp_common class_loader ament_index_cpp rcpputils rcutils
                 tinyxml2 console_bridge boost_system)
  find_library(ROSBAG_STORAGE_${_library}_LIBRARY ${_library})
  list(APPEND _libraries ${ROSBAG_STORAGE_${_library}_LIBRARY})
  list(APPEND _variables ROSBAG_STORAGE_${_library}_LIBRARY)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RosbagStorage
  REQUIRED_VARS ${_variables}
  REASON_FAILURE_MESSAGE "install librosbag-storage-dev (tools/install-dependencies does)")

if(RosbagStorage_FOUND AND NOT TARGET RosbagStorage::rosbag_storage)
  list(REMOVE_DUPLICATES _directories)
  add_library(RosbagStorage::rosbag_storage INTERFACE IMPORTED)
  set_target_properties(RosbagStorage::rosbag_storage PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${_directories}"
    INTERFACE_LINK_LIBRARIES "${_libraries}")
endif()
