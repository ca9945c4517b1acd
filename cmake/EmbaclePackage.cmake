# The installed package: find_package(embacle) gives embacle::coupling to other projects' participants.
# Every target that is exported joins the export set `embacle_targets` where it is defined.
include(CMakePackageConfigHelpers)
set(embacle_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/embacle)

install(EXPORT embacle_targets NAMESPACE embacle:: FILE embacle-targets.cmake DESTINATION ${embacle_package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/embacle-config.cmake.in
  ${CMAKE_BINARY_DIR}/embacle-config.cmake INSTALL_DESTINATION ${embacle_package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/embacle-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/embacle-config.cmake ${CMAKE_BINARY_DIR}/embacle-config-version.cmake
  DESTINATION ${embacle_package_dir})
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE ${CMAKE_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
