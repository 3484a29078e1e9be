# carom_kernel_set(SOURCES FOLDER [ARCHITECTURE]): the kernels of generator/clients, emitted when CMake
# configures and again where the generator has changed. Python_EXECUTABLE must have the generator's
# packages. These choose fewer kernels (names with commas between them; empty: all):
set(CAROM_KERNEL_TARGETS "" CACHE STRING "CPUs to have kernels for, best first: x86-64-v4,x86-64-v3,x86-64-v2 or armv8")
set(CAROM_KERNEL_MODELS "" CACHE STRING "contact models: mathavan2014,bottom_slip,pooltool; of the cushion clamped,printed,pooltool")
set(CAROM_KERNEL_GOALS "" CACHE STRING "fixed steps and budgets: n1000,e1m03,e1m06,e1m09")

# Ends where the preset's Python is not there yet, as in a fresh clone.
function(carom_require_generator)
  if(Python_EXECUTABLE AND NOT EXISTS "${Python_EXECUTABLE}")
    message(FATAL_ERROR "${Python_EXECUTABLE} is not there: run ./gen list targets once, which makes "
      ".venv with the generator's packages, then this command again")
  endif()
endfunction()

function(carom_kernel_set sources_out folder_out)
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/generator/*.py ${PROJECT_SOURCE_DIR}/generator/*.toml
    ${PROJECT_SOURCE_DIR}/templates/*.j2)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${inputs})
  set(folder ${PROJECT_BINARY_DIR}/kernels)
  set(architecture x86_64)
  if(ARGN)
    set(architecture ${ARGN})
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)$")
    set(architecture aarch64)
  endif()
  set(options --architecture ${architecture})
  foreach(what TARGETS MODELS GOALS)
    if(CAROM_KERNEL_${what})
      string(TOLOWER ${what} name)
      list(APPEND options --${name} ${CAROM_KERNEL_${what}})
    endif()
  endforeach()
  execute_process(
    COMMAND ${Python_EXECUTABLE} -m generator.clients ${folder} ${options}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} # found there; PYTHONPATH is pip's while it builds a wheel
    RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${Python_EXECUTABLE} -m generator.clients has failed; where a package is missing, "
      "run ./gen list targets once, which makes .venv with all of them")
  endif()
  file(GLOB sources ${folder}/*.cpp)
  set(${sources_out} ${sources} PARENT_SCOPE)
  set(${folder_out} ${folder} PARENT_SCOPE)
endfunction()
