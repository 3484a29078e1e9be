#!/usr/bin/env bash
# Everything that docs/trust.md speaks of but the long fuzzing (tools/fuzz.sh): sanitizers over the C++
# tests and over every kernel, and static analysis. Stops at the first finding. About 10 minutes.
set -euo pipefail

root=$(cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.." && pwd)
cd "$root"
export ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
replay=(-runs=200000 -seed=2014 -timeout=20 -print_final_stats=0)

say() { printf '== %s\n' "$*"; }

preset() { # PRESET: configured and built
  cmake --preset "$1" >/dev/null
  cmake --build --preset "$1"
}

every_kernel() { # BUILD: by call and in batches
  local way
  for way in collide batch; do
    mkdir -p "build/fuzz-corpus/$way"
    "$1/fuzz/${way}_fuzzer" "${replay[@]}" "build/fuzz-corpus/$way" 2>&1 | tail -n 1
  done
}

say "address and undefined behaviour: the C++ tests and the bench"
preset asan+ubsan
ctest --preset asan+ubsan --no-tests=error

say "address and undefined behaviour: every kernel, 200,000 inputs"
preset fuzz
every_kernel build/fuzz

say "memory: every kernel, the same inputs"
preset fuzz-memory
every_kernel build/fuzz-memory

say "static analysis: clang-tidy over C++, ruff with bandit's rules over Python"
cmake --preset default >/dev/null
# lanes_test.cpp is none of CMake's files: tests/emission/test_lanes.py renders what it includes and builds it.
GLOBIGNORE=tests/cpp/lanes_test.cpp
clang-tidy-19 -p build/default --quiet bench/*.cpp tests/cpp/*.cpp
clang-tidy-19 -p build/fuzz --quiet fuzz/*.cpp
.venv/bin/python -m ruff check --select S generator python
say "nothing found"
