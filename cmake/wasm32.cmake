# WebAssembly without a system: no C library, no C++ library (js/include has the few names in use).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
find_program(clang_wasm NAMES clang++-19 clang++ REQUIRED)
find_program(clang_wasm_c NAMES clang-19 clang REQUIRED)
set(CMAKE_C_COMPILER ${clang_wasm_c})
set(CMAKE_CXX_COMPILER ${clang_wasm})
set(CMAKE_C_COMPILER_TARGET wasm32)
set(CMAKE_CXX_COMPILER_TARGET wasm32)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # nothing can be linked into a program
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
