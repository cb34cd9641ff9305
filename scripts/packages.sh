#!/bin/bash
# The Debian packages that this project uses: the one list of them, each with its reason, and how
# they are installed. Sourced by play, check and bench; by itself it prints the list or installs:
#   scripts/packages.sh list [GROUP...]      scripts/packages.sh install GROUP...
# Groups: build (compile it), play (run it), check (compile and run all that ./check does), firmware
# (compile the micro-controllers' programs), deb (make the Debian package), video (recordings as videos),
# bench (the engines that ./bench multibody, drift and rigid compare with), docs (the printed parts and
# pictures of the build guide), wasm (compile and run the engine as WebAssembly), node (for the peers in
# WebAssembly and the simulator of the RP2040, where there is no node already).

packages_table() {
  cat <<'TABLE'
build  g++                   the C++ compiler
build  cmake                 configures the build
build  ninja-build           runs the build
build  pkg-config            finds libraries that have no CMake package
build  flatbuffers-compiler  the control messages' code from their description
build  libflatbuffers-dev    control messages
build  libboost-dev          Asio and Beast: the WebSocket that phones play over
build  libqrencode-dev       the QR code of where phones join
build  libsodium-dev         encryption and authentication of what goes over a network
build  libcli11-dev          command lines
build  libtomlplusplus-dev   profiles that people edit
build  libfmt-dev            formatted text of the reports
build  libexpected-dev       tl::expected, how errors are returned
build  liburdfdom-dev        robots' descriptions, URDF: the engine's optional part that reads them
build  libtinyxml2-dev       XML of these, with the lines of what is wrong
build  libtbb-dev            oneTBB: steps of the engine by several threads, its optional part
build  nlohmann-json3-dev    JSON, the calibration file
build  libeigen3-dev         normal equations of a calibration; matrices that the tests compare with
build  libsqlite3-dev        SQLite, the file of results
build  libglfw3-dev          the window, its keys and mouse
build  libsdl2-dev           gamepads, by events
build  libgles-dev           OpenGL ES headers
build  libglm-dev            vectors and matrices of the renderer
build  libstb-dev            fonts and PNG files
build  libimgui-dev          the sandbox's panel
build  libopenal-dev         sound
build  python3               the built-in characters as C++; layer check, document check
build  gettext               the client's sentences in other languages
play   libegl1               EGL at run time
play   libgles2              OpenGL ES at run time
play   libgl1-mesa-dri       OpenGL drivers, and the software one where there is no GPU
play   fonts-dejavu-core     the letters on the screen
play   fonts-nanum           Hangul on the screen
play   xauth                 who may draw on that display: xvfb-run asks it
play   xvfb                  a display for machines without one
check  git                   which files a change touches
check  clang                 the second compiler, sanitizers and fuzzing
check  libclang-rt-14-dev    the run-time libraries of clang's sanitizers and libFuzzer
check  clang-format          formatting
check  clang-tidy            static checks
check  doxygen               the engine's headers as pages: what their comments say must be well formed
check  shellcheck            static checks of the scripts
check  ffmpeg                writes and measures videos of recordings
check  dpkg-dev              the libraries that the Debian package depends on
check  systemd               verifies the service that the package installs
check  xdotool               keys and mouse for the test that watches a recording
check  libgtest-dev          the tests
check  libgmock-dev          matchers in the tests
check  libopenmpi-dev        space-foosball-match-mpi, matches over a cluster, is built where MPI is
check  openmpi-bin           mpirun: its test, on ranks of this machine
check  librapidcheck-dev     property tests
check  gcc-avr               compiles the firmware
check  binutils-avr          links the firmware
check  avr-libc              the firmware's C library
check  libsimavr-dev         runs the firmware against simulated mice
check  gcc-arm-none-eabi     compiles the RP2040's firmware
check  nodejs                runs that in a simulator, against simulated sensors
check  libelf-dev            simavr reads the firmware through it
firmware gcc-avr             compiles the firmware
firmware binutils-avr        links the firmware
firmware avr-libc            the firmware's C library
firmware gcc-arm-none-eabi    compiles the RP2040's firmware
video  ffmpeg                writes the videos of ./play --video
deb    dpkg-dev              the libraries that the Debian package depends on
bench  libmujoco-dev         MuJoCo, the engine that ./bench multibody sets its goals by
bench  libdart-dev           DART, another one to compare with
bench  liborocos-kdl-dev     KDL, another one
bench  libbullet-dev         Bullet and its btMultiBody, others to compare with
bench  libode-dev            ODE, which ./bench rigid compares with
bench  libsimbody-dev        Simbody, another one
bench  libeigen3-dev         matrices of DART and KDL, principal axes
bench  python3-matplotlib    draws the curves of ./bench drift, rigid and scaling
wasm   clang                 the compiler for WebAssembly too
wasm   lld-14                links WebAssembly
wasm   llvm-14               archives of WebAssembly
wasm   wasi-libc             the C library for WebAssembly
wasm   libc++-14-dev-wasm32  the C++ library
wasm   libc++abi-14-dev-wasm32 what that stands on
wasm   libclang-rt-14-dev-wasm32 what clang's code calls
wasm   nodejs                runs WebAssembly
docs   openscad              the printed parts of cabinet/parts, as STL files and pictures
docs   xvfb                  the display that openscad draws on
docs   xauth                 who may draw on that display
docs   libgl1-mesa-dri       OpenGL in software for it
docs   ffmpeg                makes the pictures smaller
docs   pngquant              the same, by fewer colours
node   nodejs                runs the engines of ./bench rigid that are WebAssembly
node   npm                   fetches them, and the simulator of the RP2040
TABLE
}

# packages_missing GROUP...: the names of those not installed, one a line.
packages_missing() {
  local wanted installed
  wanted=$(packages_table | awk -v groups=" $* " 'index(groups, " " $1 " ") { print $2 }' | sort -u)
  # shellcheck disable=SC2086  # one word per package
  installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' $wanted 2>/dev/null |
    awk '$2 == "installed" { print $1 }' | sort -u)
  comm -23 <(echo "$wanted") <(echo "$installed")
}

# packages_install LOG GROUP...: installs what is missing. Returns 1, having said why, if it cannot.
packages_install() {
  local log=$1 missing as_root=() command begun=$EPOCHREALTIME
  shift
  [[ ${SF_SKIP_PACKAGES:-0} == 1 ]] && return 0
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This is not a Debian system, so nothing can be installed from here: install the equivalents of" \
      "'scripts/packages.sh list $*' yourself, then run again with SF_SKIP_PACKAGES=1." >&2
    return 1
  fi
  missing=$(packages_missing "$@")
  [[ -z $missing ]] && return 0

  echo "Installing $(wc -l <<<"$missing") packages from Debian, and why (log: $log):"
  packages_table | awk -v missing=" ${missing//$'\n'/ } " \
    'index(missing, " " $2 " ") { name = $2; sub(/^[^ ]+ +[^ ]+ +/, ""); printf "  %-21s %s\n", name, $0 }'
  command="apt-get install --no-install-recommends ${missing//$'\n'/ }"
  if [[ $EUID -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
      echo "Installing needs root and there is no sudo here. As root: $command" >&2
      return 1
    fi
    if [[ ! -t 0 ]] && ! sudo -n true 2>/dev/null; then
      echo "Installing needs root, and sudo wants a password but there is no terminal to ask at. Run: sudo $command" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  mkdir -p "$(dirname "$log")"
  : >"$log"
  # shellcheck disable=SC2086  # one word per package
  set -- ${missing}
  # The lists are fetched only if apt does not know a package, or knows a version that is gone.
  if ! apt-get install --simulate --no-install-recommends "$@" >>"$log" 2>&1; then
    packages_update "$log" "${as_root[@]}" || return 1
  fi
  if packages_apt "$log" "${as_root[@]}" -- "$@" ||
    { packages_update "$log" "${as_root[@]}" && packages_apt "$log" "${as_root[@]}" -- "$@"; }; then
    awk -v a="$begun" -v b="$EPOCHREALTIME" 'BEGIN { printf "  installed after %.1f s\n", b - a }'
    return 0
  fi
  tail -n 5 "$log" >&2
  echo "The packages could not be installed; all of apt-get's words are in $log. By hand: $command" >&2
  return 1
}

# packages_apt LOG [sudo] -- PACKAGE...
packages_apt() {
  local log=$1 as_root=()
  shift
  while [[ $1 != -- ]]; do as_root+=("$1") && shift; done
  shift
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
    -o DPkg::Lock::Timeout=120 "$@" </dev/null >>"$log" 2>&1
}

# packages_update LOG [sudo]
packages_update() {
  local log=$1
  shift
  echo "  fetching the package lists"
  if ! "$@" apt-get update -q -o APT::Update::Error-Mode=any </dev/null >>"$log" 2>&1; then
    tail -n 3 "$log" >&2
    echo "The package lists could not be fetched: is this machine on the network? (log: $log)" >&2
    return 1
  fi
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  set -euo pipefail
  cd "$(dirname "$0")/.."
  verb=${1:-list}
  [[ $# -gt 0 ]] && shift
  case $verb in
    list) packages_table | awk -v groups=" ${*:-build play check bench} " 'index(groups, " " $1 " ")' ;;
    install) packages_install build/log/packages.log "${@:-build}" ;;
    *)
      echo "usage: scripts/packages.sh list|install [build|play|check|bench|firmware|docs|node]..." >&2
      exit 2
      ;;
  esac
fi
