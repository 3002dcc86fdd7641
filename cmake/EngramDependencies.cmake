# SPDX-License-Identifier: Apache-2.0
# Finds every package that Engram builds on; read by the build and by projects that use it.

# Another Python may come first on the PATH, without Debian's packages.
set(Python3_EXECUTABLE /usr/bin/python3)
find_package(Python3 REQUIRED COMPONENTS Interpreter)

find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(BLAS REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs video objdetect dnn)
find_package(PkgConfig REQUIRED)
pkg_check_modules(re2 REQUIRED IMPORTED_TARGET re2)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
find_package(ZLIB REQUIRED)
find_package(BZip2 REQUIRED)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
pkg_check_modules(spng REQUIRED IMPORTED_TARGET spng)
pkg_check_modules(turbojpeg REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5)
pkg_check_modules(curl REQUIRED IMPORTED_TARGET libcurl)
find_package(CLI11 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(Threads REQUIRED)

if(ENGRAM_SERVER)
  find_package(Protobuf REQUIRED)
  # Debian's gRPCConfig.cmake names targets that Debian does not have.
  pkg_check_modules(grpcpp REQUIRED IMPORTED_TARGET grpc++)
  find_library(ENGRAM_GRPC_REFLECTION grpc++_reflection REQUIRED)
  find_program(ENGRAM_GRPC_PLUGIN grpc_cpp_plugin REQUIRED)
endif()

if(ENGRAM_LEARNING)
  find_package(Torch REQUIRED)
  # LibTorch multiplies matrices through the system's BLAS. With the reference BLAS it reaches
  # 6 GFLOP/s where OpenBLAS reaches 213 (docs/design.md, section 5): training would never end.
  execute_process(COMMAND readlink -f /usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/libblas.so.3
                  OUTPUT_VARIABLE engram_blas OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT engram_blas MATCHES "openblas|mkl|blis|atlas")
    message(FATAL_ERROR
      "Only the reference BLAS is installed (found '${engram_blas}').\n"
      "LibTorch would train 35 times slower than it can. Install OpenBLAS:\n"
      "    apt-get install libopenblas0-pthread")
  endif()
endif()

if(ENGRAM_KITCHEN)
  # Debian's mujocoConfig.cmake names a folder that Debian does not have.
  find_library(ENGRAM_MUJOCO mujoco)
  find_path(ENGRAM_MUJOCO_HEADERS mujoco/mujoco.h)
  pkg_check_modules(egl QUIET IMPORTED_TARGET egl)
  if(NOT ENGRAM_MUJOCO OR NOT ENGRAM_MUJOCO_HEADERS OR NOT egl_FOUND)
    message(WARNING
      "The simulated kitchen is left out: MuJoCo or EGL is missing. Install them:\n"
      "    apt-get install libmujoco-dev libegl-dev")
    set(ENGRAM_KITCHEN OFF)
  endif()
endif()

if(ENGRAM_NAVIGATION)
  # Debian's omplConfig.cmake links ODE, which is not installed with it and not needed.
  find_library(ENGRAM_OMPL ompl)
  find_path(ENGRAM_OMPL_HEADERS ompl/config.h PATH_SUFFIXES ompl-1.5)
  if(NOT ENGRAM_OMPL OR NOT ENGRAM_OMPL_HEADERS)
    message(WARNING
      "Plans and drives of robots are left out, cost maps are not: OMPL is missing. Install it:\n"
      "    apt-get install libompl-dev")
    set(ENGRAM_NAVIGATION OFF)
  endif()
endif()

# BehaviorTree.CPP, which Debian does not have: 4, or 3 as robots with ROS Noetic have it.
if(NOT DEFINED ENGRAM_BEHAVIOR_TREE OR ENGRAM_BEHAVIOR_TREE)
  find_package(behaviortree_cpp QUIET)
  if(NOT behaviortree_cpp_FOUND)
    find_package(behaviortree_cpp_v3 QUIET)
  endif()
  set(ENGRAM_BEHAVIOR_TREE OFF)
  foreach(library BT::behaviortree_cpp behaviortree_cpp::behaviortree_cpp
                  BT::behaviortree_cpp_v3 behaviortree_cpp_v3::behaviortree_cpp_v3)
    if(TARGET ${library} AND NOT ENGRAM_BEHAVIOR_TREE)
      set(ENGRAM_BEHAVIOR_TREE ${library})
    endif()
  endforeach()
endif()

# AUTO is as good as ON for if(), and OFF is OFF.
if(ENGRAM_VIEWER)
  find_path(ENGRAM_BOOST_HEADERS boost/beast/version.hpp)
  if(NOT ENGRAM_BOOST_HEADERS AND ENGRAM_VIEWER STREQUAL "ON")
    message(FATAL_ERROR "ENGRAM_VIEWER=ON needs Boost.Beast:\n    apt-get install libboost-dev")
  elseif(NOT ENGRAM_BOOST_HEADERS)
    message(WARNING
      "'engram view' is left out: Boost.Beast is missing. Install it:\n"
      "    apt-get install libboost-dev")
    set(ENGRAM_VIEWER OFF)
  endif()
endif()
