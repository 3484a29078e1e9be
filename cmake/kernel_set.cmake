# carom_kernel_set(SOURCES FOLDER [wasm]): the kernels of generator/clients, emitted when CMake configures and
# again where the generator has changed. Python_EXECUTABLE must have the generator's packages.
function(carom_kernel_set sources_out folder_out)
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/generator/*.py ${PROJECT_SOURCE_DIR}/generator/*.toml
    ${PROJECT_SOURCE_DIR}/templates/*.j2)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${inputs})
  set(folder ${PROJECT_BINARY_DIR}/kernels)
  execute_process(
    COMMAND ${Python_EXECUTABLE} -m generator.clients ${folder} ${ARGN}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} # found there; PYTHONPATH is pip's while it builds a wheel
    COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB sources ${folder}/*.cpp)
  set(${sources_out} ${sources} PARENT_SCOPE)
  set(${folder_out} ${folder} PARENT_SCOPE)
endfunction()
