# make deb: a Debian package of what `make install` installs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tempolux)
set(CPACK_PACKAGE_CONTACT "tempolux maintainers <maintainers@tempolux.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "global illumination of animations by small Unix tools")
set(CPACK_PACKAGE_DESCRIPTION "The tools trace photons, gather and keep indirect light,
render, warp, filter and compare frames. Make chains them
for each frame and repeats only what an edit changes.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/bin)
set(CPACK_DEBIAN_PACKAGE_DEPENDS make)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_files.cmake)
include(CPack)
