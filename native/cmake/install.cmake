# What find_package(tripatch) finds: the library, its headers, and OpenSubdiv's static library beside it where that was compiled.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/tripatch)
install(TARGETS tripatch_core EXPORT tripatch-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/native/include/tripatch DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT tripatch-targets NAMESPACE tripatch:: DESTINATION ${package} COMPONENT library)
if(TRIPATCH_OPENSUBDIV STREQUAL "static")
  install(FILES ${OPENSUBDIV_LIBRARY} DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(FILES ${TRIPATCH_OPENSUBDIV_SOURCE}/LICENSE.txt ${TRIPATCH_OPENSUBDIV_SOURCE}/NOTICE.txt
          DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/tripatch/OpenSubdiv COMPONENT library)
endif()
cmake_path(GET OPENSUBDIV_LIBRARY FILENAME OPENSUBDIV_FILE)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tripatch-config.cmake.in ${PROJECT_BINARY_DIR}/tripatch-config.cmake
                              INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tripatch-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tripatch-config.cmake ${PROJECT_BINARY_DIR}/tripatch-config-version.cmake DESTINATION ${package}
        COMPONENT library)
