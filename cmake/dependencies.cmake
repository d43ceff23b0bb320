# Packages of Debian 12 (12 = bookworm). OpenImageIO is only for the module in modules/: no tool links it.
set(CMAKE_MESSAGE_LOG_LEVEL_SAVED ${CMAKE_MESSAGE_LOG_LEVEL})
set(CMAKE_MESSAGE_LOG_LEVEL WARNING)       # Debian's Imath prints nine lines about Python bindings
find_package(embree 3 CONFIG REQUIRED)
find_package(Imath CONFIG REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)
set(CMAKE_MESSAGE_LOG_LEVEL ${CMAKE_MESSAGE_LOG_LEVEL_SAVED})
find_package(TinyGLTF CONFIG REQUIRED)
find_package(CLI11 CONFIG REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(PNG REQUIRED)
find_package(draco CONFIG REQUIRED)          # these four are linked by the helper tempolux-decode alone
find_package(meshoptimizer CONFIG REQUIRED)
find_library(WEBP_LIBRARY NAMES webp REQUIRED)
find_library(AVIF_LIBRARY NAMES avif REQUIRED)
find_library(FFTWF_LIBRARY NAMES fftw3f REQUIRED)   # linked by the module tempolux-fourier alone
find_package(JPEG REQUIRED)
find_package(Threads REQUIRED)
find_library(XXHASH_LIBRARY NAMES xxhash REQUIRED)
