# shellcheck shell=bash
# Sets up what carom needs: system packages where it may, and .venv. Sourced by gen and check, which
# give $root. Says on stderr what it does; does nothing, quickly, when nothing is to do.

: "${root:?is set by gen and check}"

# program or header | Debian package | needed ("hard") or only useful ("soft") | whom it is for:
# "build" kernels and the bench, "measure" misses, make code for an architecture that is not this
# machine's ("cross"), or run all tests ("check")
carom_needs=(
  "g++:g++:soft:build"
  "clang++:clang:soft:build"
  "clang++-19:clang-19:soft:build"
  "llvm-mca-19:llvm-19:soft:build"
  "cmake:cmake:hard:build"
  "ninja:ninja-build:hard:build"
  "include/CLI/CLI.hpp:libcli11-dev:soft:build"
  "include/nlohmann/json.hpp:nlohmann-json3-dev:soft:build"
  "valgrind:valgrind:soft:measure"
  "aarch64-linux-gnu-g++:g++-aarch64-linux-gnu:soft:cross"
  "qemu-aarch64:qemu-user:soft:cross"
  "chromium-headless-shell:chromium-headless-shell:soft:check"
  "wasm-ld-19:lld-19:soft:check"
  "node:nodejs:soft:check"
  "include/gtest/gtest.h:libgtest-dev:soft:check"
)

carom_say() { printf 'carom: %s\n' "$*" >&2; }

carom_fail() {
  carom_say "$*"
  exit 2
}

carom_has() {
  case $1 in
    include/*) [[ -e /usr/$1 || -e /usr/local/$1 ]] ;;
    *) command -v "$1" >/dev/null ;;
  esac
}

# The python that can make a .venv goes to $carom_python; fails where there is none.
carom_find_python() {
  local name
  for name in python3 python3.14 python3.13 python3.12 python3.11; do
    if command -v "$name" >/dev/null && "$name" -c \
      'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
      carom_python=$(command -v "$name")
      return 0
    fi
  done
  return 1
}

carom_is_in() { # WORD WORDS...
  local word=$1 each
  shift
  for each in "$@"; do
    if [[ $each == "$word" ]]; then return 0; fi
  done
  return 1
}

# Whom packages are looked for goes to $carom_groups: nobody where the command of gen, with all its
# ARGS, builds no kernel.
carom_choose() { # ARGS...
  local word command="" before="" names="" arch measures=""
  carom_groups=()
  for word in "$@"; do
    case $word in
      --help | --version | --check | --update) return 0 ;;
      --cost | --measure) measures=$word ;;
      --target=* | --cpu=*) names+=",${word#*=}" ;;
      -*) ;;
      *)
        if [[ $before == --target || $before == --cpu ]]; then
          names+=",$word"
        elif [[ -z $command && $before != --* ]]; then
          command=$word
        elif [[ $command == results && $before == results ]]; then
          command="results $word"
        fi
        ;;
    esac
    before=$word
  done
  case $command in
    emit | explain | results | results\ [!r]*) return 0 ;;
    list) if [[ $measures != --cost ]]; then return 0; fi ;;
    report) if [[ $measures != --measure ]]; then return 0; fi ;;
    "") if (($# == 0)); then return 0; fi ;;
  esac
  carom_groups=(build)
  if [[ $command == report ]]; then carom_groups+=(measure); fi
  for word in ${names//,/ }; do
    arch=$(sed -n "/^\\[${word//[^a-z0-9-]/}\\]/,/^arch/s/^arch = \"\\(.*\\)\"/\\1/p" \
      "$root/generator/targets/targets.toml")
    if [[ -n $arch && $arch != "$(uname -m)" ]]; then carom_groups+=(cross); fi
  done
}

# Packages that are missing go to $carom_missing, those without which nothing works to $carom_hard.
carom_look() {
  local need name package kind group
  carom_missing=() carom_hard=()
  for need in "${carom_needs[@]}"; do
    IFS=: read -r name package kind group <<<"$need"
    if carom_is_in "$group" "${carom_groups[@]}" && ! carom_has "$name"; then
      carom_missing+=("$package")
      if [[ $kind == hard ]]; then carom_hard+=("$package"); fi
    fi
  done
  if carom_is_in build "${carom_groups[@]}" &&
    ! carom_has g++ && ! carom_has clang++ && ! carom_has clang++-19; then
    carom_hard+=("g++")
  fi
  if [[ $1 == need-python ]] && ! carom_find_python; then
    carom_missing+=("python3-venv")
    carom_hard+=("python3-venv (Python 3.11 or later)")
  fi
}

# What pip may take from the user's variables and configuration: where packages come from. Anything
# else (as user, target, require-hashes) would put them elsewhere or keep them away.
carom_is_network() { # NAME, as in pip's configuration
  case $1 in
    index-url | extra-index-url | find-links | no-index | proxy | cert | client-cert | \
      trusted-host | timeout | retries | cache-dir | no-cache-dir) return 0 ;;
  esac
  return 1
}

carom_pip() { # ARGS...
  ( # what is exported here is pip's alone
    python=$root/.venv/bin/python
    while IFS== read -r key value; do
      name=${key##*.}
      if [[ $key != :env:* ]] && carom_is_network "$name"; then
        value=${value:1:-1} name=${name//-/_}
        name=PIP_${name^^}
        export "$name=${!name-${value//\\n/ }}"
      fi
    done < <("$python" -m pip config list 2>/dev/null)
    PIP_CONFIG_FILE=/dev/null exec "$python" -m pip --require-virtualenv "$@"
  )
}

carom_apt() {
  local log=$1 package known=()
  shift
  # dpkg needs the sbin folders, which a bare PATH may lack.
  local apt=(env "PATH=$PATH:/usr/local/sbin:/usr/sbin:/sbin" DEBIAN_FRONTEND=noninteractive
    apt-get -qq -o DPkg::Lock::Timeout=300)
  carom_say "updating the package lists (apt-get update)"
  "${apt[@]}" update >>"$log" 2>&1 || carom_say "apt-get update failed; going on with the old lists"
  for package in "$@"; do
    if [[ -n $(apt-cache show --no-all-versions "$package" 2>/dev/null) ]]; then
      known+=("$package")
    fi
  done
  if ((${#known[@]} == 0)); then return; fi
  carom_say "installing ${known[*]} (apt-get install)"
  if ! "${apt[@]}" install -y --no-install-recommends "${known[@]}" >>"$log" 2>&1; then
    for package in "${known[@]}"; do # one that cannot be had must not keep the others away
      "${apt[@]}" install -y --no-install-recommends "$package" >>"$log" 2>&1 || true
    done
  fi
}

# System packages. A set that could not be had is tried once, not in every run.
carom_system() {
  local python=$1 log why=""
  carom_look "$python"
  if ((${#carom_missing[@]} == 0)) || carom_known_missing; then return; fi
  if carom_no_apt; then
    why=" (CAROM_NO_APT is set, so that $0 installs no system packages)"
  elif [[ $EUID -eq 0 ]] && command -v apt-get >/dev/null; then
    log=$(mktemp -t carom-apt.XXXXXX) || carom_fail "no temporary file can be made; set TMPDIR"
    carom_apt "$log" "${carom_missing[@]}"
    hash -r
    carom_look "$python"
    if ((${#carom_missing[@]} == 0)); then
      rm -f "$log"
    else
      carom_say "apt-get: $(grep -m1 '^E: ' "$log" || tail -n1 "$log") (log: $log)"
    fi
  fi
  if ((${#carom_hard[@]})); then
    carom_fail "missing: ${carom_hard[*]}; as root: apt-get update && apt-get install ${carom_missing[*]}$why"
  elif ((${#carom_missing[@]})) && [[ -z $why ]]; then
    carom_say "going on without some useful packages; as root: apt-get install ${carom_missing[*]}"
  fi
}

# What the stamp says when .venv is as it should be: the lock's hash, this folder (scripts in .venv
# name it) and the Python behind it (which a system upgrade exchanges).
carom_want() {
  local hash
  hash=$(sha256sum <"$root/requirements.lock")
  printf '%s\n%s\n%s' "${hash%% *}" "$root" "$(readlink -f -- "$root/.venv/bin/python")"
}

# Leaves `current`, `stale` (the lock has changed, or there is no stamp) or `unusable` in $carom_state.
carom_look_venv() {
  local want stamp=""
  carom_state=unusable
  # Without pyvenv.cfg it would be the system's Python by another name.
  [[ -x $root/.venv/bin/python && -e $root/.venv/pyvenv.cfg ]] || return 0
  want=$(carom_want)
  if [[ -e $root/.venv/carom-stamp ]]; then stamp=$(<"$root/.venv/carom-stamp"); fi
  if [[ $stamp == "$want" ]]; then
    carom_state=current
  elif [[ -z $stamp || ${stamp#*$'\n'} == "${want#*$'\n'}" ]]; then
    carom_state=stale
  fi
}

# The first reason in pip's log: what broke a connection, or an error that says more than "failed".
carom_reason() {
  [[ -s $1 ]] || { echo "it said nothing (is the disk full?)" && return; }
  grep -v 'subprocess-exited-with-error' "$1" | grep -m1 -iE 'error|no space left' || tail -n1 "$1"
}

carom_owner() { stat -c %U -- "$1" 2>/dev/null || echo "another user"; }

# Ends where .venv is to be made or mended and cannot be.
carom_may_write() {
  local what=$root/.venv me
  me=$(id -un 2>/dev/null || id -u)
  if [[ -e $what && ! -w $what ]]; then
    carom_fail "$what is out of date or cannot be read, and $me cannot write to it; let its owner" \
      "($(carom_owner "$what")) run ./gen list targets, or remove it"
  elif [[ ! -e $what && ! -w $root ]]; then
    carom_fail "$root is not set up, and $me cannot write to it; let its owner ($(carom_owner "$root"))" \
      "run ./gen list targets once, or clone it to a folder of your own"
  fi
}

carom_venv() {
  local venv=$root/.venv log reason
  carom_may_write
  if [[ $carom_state == unusable ]] || ! "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
    # To clear a link would empty the folder behind it, which another clone uses.
    if [[ -L $venv ]]; then
      carom_fail "$venv is a link to $(readlink -f -- "$venv"), which is not of this clone; remove the link"
    fi
    carom_find_python || carom_fail "missing: Python 3.11 or later with its venv module (python3-venv)"
    carom_say "making .venv with $carom_python"
    if ! reason=$("$carom_python" -m venv --clear "$venv" 2>&1); then
      carom_fail "cannot make $venv with $carom_python: $(tail -n1 <<<"$reason")"
    fi
  fi
  carom_say "installing the pinned Python packages into .venv (about half a minute)"
  log=$venv/carom-pip.log
  if ! carom_pip install --quiet --no-input --disable-pip-version-check \
    -r "$root/requirements.lock" >"$log" 2>&1; then
    carom_fail "pip could not install requirements.lock: $(carom_reason "$log") (log: $log)"
  fi
  carom_want >"$venv/carom-stamp"
}

# May apt-get be asked for nothing?
carom_no_apt() { [[ -n ${CAROM_NO_APT-} && ${CAROM_NO_APT-} != 0 ]]; }

# Is nothing missing that is needed, or that was not tried before and could not be had?
carom_known_missing() {
  local package tried=()
  if ((${#carom_hard[@]})); then return 1; fi
  if carom_no_apt; then return 0; fi
  if [[ -e $root/.venv/carom-missing ]]; then read -ra tried <"$root/.venv/carom-missing" || true; fi
  for package in "${carom_missing[@]}"; do
    carom_is_in "$package" "${tried[@]}" || return 1
  done
}

# Keeps what was tried and could not be had, beside what other commands tried.
carom_note_missing() {
  local package tried=()
  # Where .venv is another user's, packages are looked for each time.
  if carom_no_apt || [[ ! -w $root/.venv ]]; then return 0; fi
  if [[ -e $root/.venv/carom-missing ]]; then read -ra tried <"$root/.venv/carom-missing" || true; fi
  for package in "${carom_missing[@]}"; do
    carom_is_in "$package" "${tried[@]}" || tried+=("$package")
  done
  printf '%s\n' "${tried[*]}" >"$root/.venv/carom-missing"
}

# Ends where this place or the caller's variables would break what comes later.
carom_require_place() {
  [[ -e $root/requirements.lock ]] || carom_fail "$root/requirements.lock is missing: not a whole clone?"
  [[ -r $root/requirements.lock ]] || carom_fail "$root/requirements.lock cannot be read by $(id -un)"
  if [[ $root == *[:$'\n']* ]]; then
    carom_fail "$root has a colon or a line's end in its name, which PYTHONPATH and CMake cannot" \
      "take; move the clone to another folder"
  fi
  if [[ -n ${TMPDIR-} && ! ( -d $TMPDIR && -w $TMPDIR ) ]]; then
    carom_fail "TMPDIR=$TMPDIR: no folder that can be written; name one that can, or unset it"
  fi
}

# What the groups in $carom_groups need, and .venv.
carom_setup() {
  carom_environment
  carom_require_place
  carom_look_venv
  carom_look have-python
  if [[ $carom_state == current ]] && { ((${#carom_missing[@]} == 0)) || carom_known_missing; }; then
    return
  fi

  # Something is to do: one process at a time does it, the others wait and then find it done.
  exec 9<"$root/requirements.lock"
  if command -v flock >/dev/null && ! flock -n 9; then
    carom_say "waiting for another set-up of this clone"
    flock 9
  fi
  carom_look_venv
  if [[ $carom_state == unusable ]]; then carom_system need-python; else carom_system have-python; fi
  if [[ $carom_state != current ]]; then carom_venv; fi
  carom_look have-python
  carom_note_missing
  exec 9<&-
}

# The same Python for all: its own packages and this clone, nothing of the caller's.
carom_environment() {
  local name option
  export PYTHONPATH=$root
  unset PYTHONHOME PYTHONSTARTUP PYTHONINSPECT PYTHONUSERBASE PYTHONPLATLIBDIR
  for name in "${!PIP_@}"; do
    option=${name#PIP_} option=${option//_/-}
    if [[ $name != PIP_CONFIG_FILE ]] && ! carom_is_network "${option,,}"; then unset "$name"; fi
  done
}
