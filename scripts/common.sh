#!/bin/bash
# Shared by play, check and bench; sourced with the repository's root as working directory.

die() { # die CODE SENTENCE
  echo "$0: $2" >&2
  exit "$1"
}

seconds_since() { # seconds_since EPOCHREALTIME: with one decimal
  awk -v a="$1" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f", b - a }'
}

# Nobody should have to compile the same file twice: ccache is used where it is installed, and what it
# keeps serves every checkout.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros # with precompiled headers
launcher_flags() {
  command -v ccache >/dev/null || return 0
  echo "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache"
}

# configure PRESET LOG [-D...]: configures build/PRESET.
configure() {
  local preset=$1 log=$2
  shift 2
  mkdir -p "$(dirname "$log")"
  # shellcheck disable=SC2046  # one word per flag
  if ! cmake --preset "$preset" $(launcher_flags) "$@" >"$log" 2>&1; then
    grep -A6 -m3 'CMake Error' "$log" >&2 || tail -n 15 "$log" >&2
    echo "Configuring build/$preset failed; the whole log is in $log." >&2
    return 1
  fi
}

# build PRESET LOG TARGET...: builds, showing how far it is; the words go to the log.
build() {
  local preset=$1 log=$2 line shown=0 now status begun=$EPOCHREALTIME
  shift 2
  mkdir -p "$(dirname "$log")"
  : >"$log"
  set +o pipefail
  flock -n "build/$preset.lock" true || echo "  another build of build/$preset is under way: waiting for it"
  NINJA_STATUS='[%f/%t] ' nice -n 5 flock "build/$preset.lock" ninja -C "build/$preset" -j "${SF_JOBS:-$(nproc)}" "$@" 2>&1 |
    tee -a "$log" | while IFS= read -r line; do
      [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
      now=$((BASH_REMATCH[1] * 100 / BASH_REMATCH[2]))
      if [[ -t 1 ]]; then
        printf '\r  compiling %3d%% of %d steps' "$now" "${BASH_REMATCH[2]}"
      elif ((now >= shown + 10)); then
        shown=$((now / 10 * 10))
        echo "  compiled $shown% of ${BASH_REMATCH[2]} steps after $(seconds_since "$begun") s"
      fi
    done
  status=${PIPESTATUS[0]}
  set -o pipefail
  [[ -t 1 ]] && printf '\r%40s\r' ''
  if ((status != 0)); then
    grep -E -A4 'error|FAILED' "$log" | head -n 40 >&2 || tail -n 20 "$log" >&2
    echo "Building build/$preset failed; the whole log is in $log." >&2
    return 1
  fi
}

# virtual_display: starts Xvfb on a free number; sets DISPLAY and XVFB_PID.
virtual_display() {
  local number fifo
  fifo=$(mktemp -u)
  mkfifo "$fifo"
  # Out of reach of a Ctrl-C: what draws in it may have a last picture to draw.
  setsid setpriv --pdeathsig TERM Xvfb -displayfd 3 -screen 0 1280x720x24 -nolisten tcp 3>"$fifo" >/dev/null 2>&1 &
  # shellcheck disable=SC2034  # read by the callers' clean-up
  XVFB_PID=$!
  # Opening for reading waits for the writer; Xvfb writes its number once it can be used, or dies.
  IFS= read -r -t 20 number <"$fifo" || number=
  rm -f "$fifo"
  if [[ -z $number ]]; then
    echo "Xvfb, the virtual display, did not start." >&2
    return 1
  fi
  export DISPLAY=:$number
  unset WAYLAND_DISPLAY
}

# stop PID...: asks the processes to end, and after STOP_SECONDS (3) makes them. Fails if one had to be
# made, or ended with an error: with its status.
stop() {
  local pid status i looks=$((${STOP_SECONDS:-3} * 20)) failed=0
  for pid in "$@"; do kill -TERM "$pid" 2>/dev/null || true; done
  for pid in "$@"; do
    for ((i = 0; i < looks; ++i)); do
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.05
    done
    kill -KILL "$pid" 2>/dev/null || true
    status=0
    wait "$pid" 2>/dev/null || status=$?
    ((status == 0 || status == 143 || status == 127)) || failed=$status # 143: by our signal; 127: no child
  done
  return "$failed"
}

# By itself: scripts/common.sh FUNCTION ARGUMENT... runs one of the above, for wrappers such as setarch.
if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  set -euo pipefail
  "$@"
fi
