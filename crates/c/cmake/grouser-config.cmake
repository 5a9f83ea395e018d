# find_package(grouser) gives the target grouser::grouser.
# by the real folder: /lib may be a link to /usr/lib
get_filename_component(_grouser_folder "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
get_filename_component(_grouser_prefix "${_grouser_folder}/../../.." ABSOLUTE)
if(NOT TARGET grouser::grouser)
  find_package(Threads REQUIRED)
  add_library(grouser::grouser STATIC IMPORTED)
  set_target_properties(grouser::grouser PROPERTIES
    IMPORTED_LOCATION "${_grouser_prefix}/lib/libgrouser_c.a"
    INTERFACE_INCLUDE_DIRECTORIES "${_grouser_prefix}/include"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
endif()
unset(_grouser_folder)
unset(_grouser_prefix)
