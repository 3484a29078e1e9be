#!/usr/bin/env bash
# Fuzzes every target in turn: tools/fuzz.sh SECONDS [FOLDER [TARGET...]]. The time is shared out as
# `share` says, of which TARGETs get their part alone.
# Corpora grow in FOLDER (build/fuzz-corpus), logs and findings too. Exit status 1 where a promise of an
# interface was broken; results that are grossly over a budget (`budget`) are counted, and kept.
set -euo pipefail

root=$(cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.." && pwd)
seconds=${1:?"name the seconds to spend, as tools/fuzz.sh 3600"}
folder=${2:-$root/build/fuzz-corpus}
only=" ${*:3} "
logs=$folder/logs
mkdir -p "$logs"
cd "$root"

# target | share of the time in percent | what runs it
share=(
  "collide 20 build/fuzz/fuzz/collide_fuzzer"
  "collide-memory 10 build/fuzz-memory/fuzz/collide_fuzzer"
  "batch 15 build/fuzz/fuzz/batch_fuzzer"
  "batch-memory 5 build/fuzz-memory/fuzz/batch_fuzzer"
  "budget 15 build/fuzz/fuzz/budget_fuzzer"
  "scene 10 parser"
  "targets 7 parser"
  "cases 10 parser"
  "selection 5 parser"
  "names 3 parser"
)

build() { # PRESET
  cmake --preset "$1" >"$logs/build-$1.log" 2>&1
  cmake --build --preset "$1" >>"$logs/build-$1.log" 2>&1
}

parsers() { # an environment with atheris; $python is its own
  local venv=$root/build/venvs/fuzz
  if [[ ! -e $venv/made ]]; then
    .venv/bin/python -m venv --clear "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check -r requirements.lock \
      -r fuzz/requirements.txt
    touch "$venv/made"
  fi
  python=$venv/bin/python
}

seed() { # TARGET: what its corpus starts from
  local corpus=$folder/$1
  mkdir -p "$corpus"
  case $1 in
    scene) cp generator/impacts/ball_ball/scenes/*.toml "$corpus" ;;
    targets) cp generator/targets/targets.toml "$corpus" ;;
    cases) head -n 4 tests/data/reference/inputs.csv >"$corpus/reference" ;;
    selection) cp generated/ball-ball/zen3/any/selection.json "$corpus" ;;
    names) sed -n 's#^// question: *##p; s#^// recipe: *##p' generated/*/zen3/any/*.cpp | paste -d ' ' - - |
      while read -r name; do printf '%s' "$name" >"$corpus/$(basename "${name%% *}")"; done ;;
  esac
}

fuzz() { # TARGET PERCENT PROGRAM
  local name=$1 limit=$((seconds * $2 / 100)) run=("$3")
  if [[ $3 == parser ]]; then run=("$python" fuzz/parsers.py "$name"); fi
  seed "$name"
  if [[ $name == budget ]]; then run+=(-fork=1 -ignore_crashes=1); fi
  local options=("-max_total_time=$limit" "-timeout=20" "-rss_limit_mb=2048" "-print_final_stats=1"
    "-artifact_prefix=$folder/found-$name-" "$folder/$name")
  local status=0 runs found
  PYTHONPATH=$root "${run[@]}" "${options[@]}" >"$logs/$name.log" 2>&1 || status=$?
  runs=$(grep -aoE '^#[0-9]+' "$logs/$name.log" | tail -n 1)
  found=$(find "$folder" -maxdepth 1 -name "found-$name-*" | wc -l)
  printf '%-15s %5d s %12s runs %4d found\n' "$name" "$limit" "${runs#\#}" "$found"
  if [[ $name != budget ]] && ((status || found)); then failed=1; fi
}

failed=0
build fuzz
build fuzz-memory
parsers
for line in "${share[@]}"; do
  read -r name percent program <<<"$line"
  if [[ $only != "  " && $only != *" $name "* ]]; then continue; fi
  fuzz "$name" "$percent" "$program"
done
exit "$failed"
