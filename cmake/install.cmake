# make install: tools, modules, format pages.
include(GNUInstallDirs)
get_property(tools GLOBAL PROPERTY TEMPOLUX_TOOLS)
if(tools)
  install(TARGETS ${tools} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
# Man pages and completion, each made by the tool from its own options.
set(pages)
foreach(tool ${tools})
  set(page ${CMAKE_BINARY_DIR}/share/man/man1/${tool}.1)
  set(completion ${CMAKE_BINARY_DIR}/share/bash-completion/completions/${tool})
  add_custom_command(OUTPUT ${page} ${completion} DEPENDS ${tool} VERBATIM
                     COMMAND $<TARGET_FILE:${tool}> --help-man > ${page}
                     COMMAND $<TARGET_FILE:${tool}> --help-completion > ${completion})
  list(APPEND pages ${page} ${completion})
endforeach()
if(tools)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/man/man1 ${CMAKE_BINARY_DIR}/share/bash-completion/completions)
  add_custom_target(manual ALL DEPENDS ${pages})
  install(DIRECTORY ${CMAKE_BINARY_DIR}/share/man ${CMAKE_BINARY_DIR}/share/bash-completion
          DESTINATION ${CMAKE_INSTALL_DATAROOTDIR})
endif()
install(TARGETS tempolux-images tempolux-fourier LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/tempolux)
install(TARGETS tempolux-decode RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/tempolux)
if(TARGET tempolux-oiio)
  install(TARGETS tempolux-oiio RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/tempolux)
endif()
if(TARGET tempolux-vdb)
  install(TARGETS tempolux-vdb RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/tempolux)
endif()
install(DIRECTORY formats/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/formats FILES_MATCHING PATTERN "*.md")
install(FILES LICENSE README.md Makefile.example DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY pipelines/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/pipelines FILES_MATCHING PATTERN "*.mk" PATTERN "*.md" PATTERN "*.awk" PATTERN "*.sh" PATTERN "*.html"
        PATTERN scenes EXCLUDE PATTERN examples EXCLUDE)
