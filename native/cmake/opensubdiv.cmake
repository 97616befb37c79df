# Defines tripatch_opensubdiv, the CPU parts far, vtr, sdc and bfr of OpenSubdiv, by TRIPATCH_OPENSUBDIV.
if(TRIPATCH_OPENSUBDIV STREQUAL "system")
  # Not find_package: Debian's OpenSubdivConfig.cmake names a static library that the package does not contain.
  find_path(OPENSUBDIV_INCLUDE_DIR opensubdiv/version.h REQUIRED)
  find_library(OPENSUBDIV_LIBRARY osdCPU REQUIRED)
  set(include_dir ${OPENSUBDIV_INCLUDE_DIR})
elseif(TRIPATCH_OPENSUBDIV STREQUAL "static")
  if(NOT EXISTS ${TRIPATCH_OPENSUBDIV_SOURCE}/opensubdiv/version.h)
    message(FATAL_ERROR "TRIPATCH_OPENSUBDIV=static wants TRIPATCH_OPENSUBDIV_SOURCE, a source tree of OpenSubdiv; \
'${TRIPATCH_OPENSUBDIV_SOURCE}' holds no opensubdiv/version.h. scripts/setup gets one")
  endif()
  # A build of its own, made once and kept for every build with the same sources, compiler and flags.
  set(include_dir ${TRIPATCH_OPENSUBDIV_SOURCE})
  file(GLOB_RECURSE files ${include_dir}/opensubdiv/*.cpp ${include_dir}/opensubdiv/*.h ${CMAKE_CURRENT_LIST_DIR}/../opensubdiv/CMakeLists.txt)
  set(options "")
  foreach(name IN ITEMS CMAKE_CXX_FLAGS CMAKE_MSVC_RUNTIME_LIBRARY CMAKE_OSX_ARCHITECTURES
                        CMAKE_OSX_DEPLOYMENT_TARGET CMAKE_OSX_SYSROOT CMAKE_TOOLCHAIN_FILE)
    if(DEFINED ${name})
      list(APPEND options "-D${name}=${${name}}")
    endif()
  endforeach()
  set(identity "${options};${CMAKE_CXX_COMPILER_ID};${CMAKE_CXX_COMPILER_VERSION};${CMAKE_SYSTEM_PROCESSOR}")
  foreach(path IN LISTS files)
    file(MD5 ${path} hash)
    string(APPEND identity ";${hash}")
  endforeach()
  string(MD5 hash "${identity}")
  string(SUBSTRING ${hash} 0 12 hash)
  set(folder ${TRIPATCH_OPENSUBDIV_KEPT}/opensubdiv-${hash})
  set(OPENSUBDIV_LIBRARY ${folder}/${CMAKE_STATIC_LIBRARY_PREFIX}tripatch_opensubdiv${CMAKE_STATIC_LIBRARY_SUFFIX})
  if(NOT EXISTS ${OPENSUBDIV_LIBRARY})
    message(STATUS "Compiling OpenSubdiv, once: ${folder}")
    cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/../opensubdiv -B ${folder}/build -G ${CMAKE_GENERATOR}
                            -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_BUILD_TYPE=Release -DOPENSUBDIV_SOURCE=${TRIPATCH_OPENSUBDIV_SOURCE}
                            -DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM} ${options}
                    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${folder}/build --config Release --parallel ${cores} OUTPUT_QUIET
                    COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${CMAKE_COMMAND} --install ${folder}/build --config Release --prefix ${folder} OUTPUT_QUIET
                    COMMAND_ERROR_IS_FATAL ANY)
    file(REMOVE_RECURSE ${folder}/build)
  endif()
else()
  message(FATAL_ERROR "TRIPATCH_OPENSUBDIV must be 'system' or 'static', not '${TRIPATCH_OPENSUBDIV}'")
endif()
add_library(tripatch_opensubdiv UNKNOWN IMPORTED GLOBAL)
set_target_properties(tripatch_opensubdiv PROPERTIES IMPORTED_LOCATION ${OPENSUBDIV_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${include_dir}
  INTERFACE_COMPILE_DEFINITIONS $<$<PLATFORM_ID:Windows>:_USE_MATH_DEFINES>)  # its headers use M_PI
