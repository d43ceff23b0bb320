# Run by CPack on the files that it is about to pack: what Debian asks of a package's documents.
set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share)
set(doc ${root}/doc/tempolux)
file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: tempolux

Files: *
Copyright: 2026 the authors of tempolux
License: Apache-2.0
 On Debian systems the text of the license is in /usr/share/common-licenses/Apache-2.0.
")
file(REMOVE ${doc}/LICENSE)
file(WRITE ${doc}/changelog "tempolux (${CPACK_PACKAGE_VERSION}) stable; urgency=low

  * Made from the source tree; its git log names the changes.

 -- ${CPACK_PACKAGE_CONTACT}  Thu, 01 Jan 1970 00:00:00 +0000
")
file(GLOB pages ${root}/man/man1/*.1)
execute_process(COMMAND gzip -9n ${pages} ${doc}/changelog COMMAND_ERROR_IS_FATAL ANY)
