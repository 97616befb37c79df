# Lets _native run with glibc 2.17 and newer, whatever C++ library is there; for GCC on x86-64.
#
# The C++ library goes inside. Functions that glibc has in an old and in a newer version are found first in a library without code, which
# names the old ones; where the module runs, glibc's library of the same name is loaded, and glibc has kept them. It is libpthread, which
# threads need before glibc 2.34. Those of libm may be in it too: the loader looks for a name with its version in every library.
set(names __pthread_key_create pthread_create pthread_detach pthread_getspecific pthread_join pthread_key_create pthread_key_delete
          pthread_once pthread_setspecific exp hypot lgamma log pow)
set(folder ${PROJECT_BINARY_DIR}/old_glibc)
list(TRANSFORM names REPLACE "(.+)" "extern \"C\" void \\1() {}\n")
list(JOIN names "" names)
file(CONFIGURE OUTPUT ${folder}/names.cpp CONTENT "${names}")
file(CONFIGURE OUTPUT ${folder}/versions.map CONTENT "GLIBC_2.2.5 { *; };\n")
add_library(tripatch_old_glibc SHARED ${folder}/names.cpp)
set_target_properties(tripatch_old_glibc PROPERTIES OUTPUT_NAME pthread SUFFIX .so.0 LIBRARY_OUTPUT_DIRECTORY ${folder}
                      CXX_VISIBILITY_PRESET default)
target_compile_options(tripatch_old_glibc PRIVATE -w -fno-builtin)
target_link_options(tripatch_old_glibc PRIVATE -nostdlib LINKER:--version-script=${folder}/versions.map)

target_link_libraries(_native PRIVATE tripatch_old_glibc)
# named, for the C++ library refers to it weakly and would take another copy's
target_link_options(_native PRIVATE -static-libstdc++ LINKER:--undefined=__cxa_pure_virtual)
target_sources(_native PRIVATE native/glibc/missing.cpp)
set_source_files_properties(native/glibc/missing.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
set_target_properties(_native PROPERTIES SKIP_BUILD_RPATH ON)  # nothing loads that library
