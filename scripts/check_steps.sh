#!/bin/bash
# The steps of ./check: each a function that fails or not. Run by ./check in a process of its own, its
# words going to LOGS/STEP.log, with STEP, the step's name, and LOGS, the folder, in the environment.
set -euo pipefail
. scripts/packages.sh
. scripts/common.sh

said() { echo "$*" >"$LOGS/$STEP.said"; } # shown beside the step's time

our_files() { # our_files PATTERN...: tracked and new files, without build outputs
  git ls-files --cached --others --exclude-standard -- "$@" | while IFS= read -r f; do
    if [[ -f $f ]]; then echo "$f"; fi
  done
}

step_packages() {
  packages_install "$LOGS/packages-apt.log" build play check wasm
  # A node that is not Debian's brings its own npm, which Debian's would not go beside.
  command -v npm >/dev/null || packages_install "$LOGS/packages-apt.log" node
}

step_format() {
  local files
  mapfile -t files < <(our_files '*.h' '*.cpp' '*.c')
  ((${#files[@]} > 0)) || { echo "git lists no source files here" && return 1; }
  clang-format --dry-run --Werror "${files[@]}" 2>"$LOGS/format.all" && said "${#files[@]} files" && return
  echo "these are not as .clang-format has them; clang-format -i FILE puts them right:"
  sed -n 's/^\([^: ]*\):[0-9]*:[0-9]*: error.*/\1/p' "$LOGS/format.all" | uniq -c
  return 1
}

step_layers() {
  python3 scripts/check_layers.py --self-test
  python3 scripts/check_layers.py | tee "$LOGS/layers.said"
}

step_docs() {
  python3 scripts/check_docs.py
  python3 scripts/rigid_tables.py --self-test
  python3 scripts/plot_rigid.py --self-test
  python3 scripts/plot_study.py --self-test
  python3 scripts/benchmark_tables.py --self-test
  python3 scripts/benchmark_tables.py --check
  python3 scripts/build_guide.py --self-test
  python3 scripts/build_guide.py --check
  python3 scripts/render_parts.py --self-test
  python3 scripts/render_parts.py --pictures-current
  python3 scripts/rods.py --self-test
}

step_doxygen() {
  python3 scripts/doxygen_filter.py --self-test
  mkdir -p build
  rm -rf build/doxygen
  doxygen docs/Doxyfile
  local pages
  pages=$(find build/doxygen/html -name '*.html' | wc -l)
  ((pages > 50)) || { echo "doxygen wrote only $pages pages" && return 1; }
  said "$pages pages"
}

step_scripts() {
  local files
  mapfile -t files < <(our_files '*.sh' | cat - <(printf '%s\n' play check bench packaging/space-foosball-play .ci/run))
  shellcheck -x "${files[@]}"
  python3 -m py_compile scripts/*.py
  said "${#files[@]} scripts"
}

# build_with_tests PRESET FIRMWARE TARGET...: warnings are errors.
build_with_tests() {
  configure "$1" "$LOGS/$1-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=ON -DSF_FIRMWARE="$2"
  build "$1" "$LOGS/$1-build.log" "${@:3}"
}

step_gcc() { build_with_tests release ON all; }
step_clang() { build_with_tests clang OFF numbers_tests foosball-replay; }

# A missing include, or a name that shadows another, is not found where sources are compiled together.
step_alone() {
  configure alone "$LOGS/alone-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
  build alone "$LOGS/alone-build.log" all
}

# run_tests PRESET [ctest options]: under a virtual display; leaves the numbers for the totals.
run_tests() {
  local preset=$1 junit=$PWD/$LOGS/$STEP.xml status=0
  shift
  rm -f "$junit"
  virtual_display
  trap 'stop "$XVFB_PID"' EXIT
  LIBGL_ALWAYS_SOFTWARE=1 no_address_randomisation ctest --test-dir "build/$preset" -j "${SF_JOBS:-$(nproc)}" \
    --no-tests=error --output-on-failure --output-junit "$junit" "$@" || status=$?
  count_tests "$junit"
  return "$status"
}

count_tests() { # count_tests JUNIT
  local all failures skips
  [[ -f $1 ]] || return 0
  all=$(grep -o -m1 '\btests="[0-9]*"' "$1" | tr -dc 0-9)
  failures=$(grep -o -m1 '\bfailures="[0-9]*"' "$1" | tr -dc 0-9)
  skips=$(grep -o -m1 '\bskipped="[0-9]*"' "$1" | tr -dc 0-9)
  echo "$((all - failures - skips)) $failures $skips" >"$LOGS/$STEP.count"
  said "$((all - failures - skips)) passed, $skips skipped"
}

# The thread sanitizers of g++ 12 and clang 14 do not start under the address randomisation of newer kernels.
no_address_randomisation() {
  if setarch "$(uname -m)" -R true 2>/dev/null; then setarch "$(uname -m)" -R "$@"; else "$@"; fi
}

step_tests_gcc() { run_tests release; }
step_tests_clang() { run_tests clang -L numbers; }

sanitized_build() { # sanitized_build PRESET TARGET
  configure "$1" "$LOGS/$1-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=ON -DSF_FIRMWARE=OFF
  no_address_randomisation bash scripts/common.sh build "$1" "$LOGS/$1-$2-build.log" "$2"
}

# sanitized_tests PRESET TARGET LABEL [ctest options]: the fast tests are 20 times as slow here, so that
# tests of many random cases are told to take fewer: of 500, all, every 37th and each elsewhere.
sanitized_tests() {
  export VP_CHURN_SEQUENCES=150 VP_SAMPLES_SHARE=4 SF_FLIPPED_EVERY=149 SF_TRUNCATED_EVERY=5
  export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
  export UBSAN_OPTIONS=print_stacktrace=1 TSAN_OPTIONS=second_deadlock_stack=1
  sanitized_build "$1" "$2"
  rm -rf "build/$1/gtest"
  run_tests "$1" -L "${@:3}"
}

# Where ctest knows only the programs: their tests, in place of them.
count_cases() { # count_cases FOLDER
  local files=("$1"/*.xml) passed failed skipped all skips
  read -r passed failed skipped <"$LOGS/$STEP.count"
  all=$(cat "${files[@]}" | grep -c '<testcase ')
  skips=$(cat "${files[@]}" | grep -c 'result="skipped"' || true)
  passed=$((passed - ${#files[@]} + all - skips)) skipped=$((skipped + skips))
  echo "$passed $failed $skipped" >"$LOGS/$STEP.count"
  said "$passed passed, $skipped skipped"
}

step_asan() {
  # Scenes of seconds, whose code the other tests go through: half of the time. --full has them.
  local long='Regions.StandAsOnePieceDoes:Regions.HoldChainsOfAFewLinksEach:Heaps/SleepIn.AWholePitComesToAll/?'
  long+=':SelfCollision.LinksThatOverlapDeeplyAtFirstDoNotExplode:SelfCollision.AChainFallsIntoAHeapOfItself'
  long+=':ElasticBalls.GainNoEnergy:Overlap.OfManyBodiesAtOnePlaceIsPushedOutSlowly:FourBar.KeepsItsEnergyAndStaysClosed'
  long+=':ImpactNormal.OnATiledFloorNothingIsStoppedByTheSeams:ContradictoryJoints.BetweenTheSameTwoBodiesPullSlowly'
  long+=':LinkJoint.AFourBarSwingsAsItsEquationsOfMotionSay:Stack.OnAKinematicLiftRidesAsWellAfterHundredsOfMetres'
  GTEST_FILTER="-$long" sanitized_tests asan-ubsan engine_tests engine
  count_cases build/asan-ubsan/gtest
}
step_asan_all() {
  sanitized_tests asan-ubsan all fast
  count_cases build/asan-ubsan/gtest
}

step_tsan() {
  # Of programs with threads the tests that start none and took half of the time.
  local without='CalibrationGuide|CalibrationFit|MountErrors|Drifting|IndexMark|StateAtTick|CheckpointFile'
  sanitized_tests tsan threads_tests threads -E "$without|ServerProgram.(Refuses|Names)"
}

# generate PRESET: the sources that a build generates are made; nothing is compiled.
generate() {
  local generated
  mapfile -t generated < <(ninja -C "build/$1" -t targets all | sed -En 's/^([^/].*\.(h|cpp)): CUSTOM_COMMAND$/\1/p')
  build "$1" "$LOGS/$1-generate.log" "${generated[@]}"
}

# clang-debug says how the libraries and programs are compiled, clang how the tests are, each by itself; of
# both no more is built than their sources include.
step_tidy() {
  configure clang-debug "$LOGS/clang-debug-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
  generate clang-debug
  configure clang "$LOGS/clang-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=ON -DSF_FIRMWARE=OFF -DCMAKE_UNITY_BUILD=OFF
  generate clang
  build clang "$LOGS/clang-headers.log" sf_test_headers
  python3 scripts/tidy.py --unity build/clang-debug --build build/clang | tee "$LOGS/tidy.all"
  tail -n 1 "$LOGS/tidy.all" >"$LOGS/tidy.said"
}

step_fuzz() {
  local seconds=${SF_FUZZ_SECONDS:-5} status=0
  sanitized_build asan-ubsan fuzz_targets
  rm -rf "$LOGS/fuzz"
  mkdir -p "$LOGS/fuzz"
  [[ -s build/asan-ubsan/fuzz-targets.txt ]] || { echo "there is no fuzz target" && return 1; }
  xargs -a build/asan-ubsan/fuzz-targets.txt -P "${SF_JOBS:-$(nproc)}" -L 1 \
    bash scripts/fuzz_one.sh "$seconds" "$LOGS/fuzz" || status=1
  cat "$LOGS"/fuzz/*.result
  local good all
  good=$(cat "$LOGS"/fuzz/*.result | grep -c '^passed' || true)
  all=$(wc -l <build/asan-ubsan/fuzz-targets.txt)
  echo "$good $((all - good)) 0" >"$LOGS/$STEP.count"
  said "$all targets, $seconds s each"
  ((status == 0 && good == all))
}

# replays PRESET...: a match of two computer players, recorded by the g++ Release server, goes through the
# replayers of these presets, each also with save and restore in the middle. The sanitizers' has
# assertions on.
replays() {
  local record=$LOGS/replay.sfr preset hash server_pid
  rm -f "$record"
  build/release/bin/space-foosball-server --port 0 --team0 computer --team1 computer --seed 7 --quiet \
    --seconds 20 --record "$record" &
  server_pid=$!
  sanitized_build asan-ubsan foosball-replay
  wait "$server_pid"
  : >"$LOGS/replay.hashes"
  for preset in "$@"; do
    replay_hash "$preset" "$record" >>"$LOGS/replay.hashes"
    replay_hash "$preset" "$record" --restore-at 10000 >>"$LOGS/replay.hashes"
  done
  cat "$LOGS/replay.hashes"
  [[ $(wc -l <"$LOGS/replay.hashes") == $((2 * $#)) ]]
  hash=$(awk '{ print $NF }' "$LOGS/replay.hashes" | sort -u)
  [[ $hash =~ ^[0-9a-f]{16}$ ]] || { echo "the replays differ" && return 1; }
  said "$((2 * $#)) replays of one recording, hash $hash"
}
step_replay() { replays release asan-ubsan; }
step_replay_all() {
  configure debug "$LOGS/debug-configure.log" -DSF_WERROR=ON -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
  build debug "$LOGS/debug-build.log" foosball-replay
  replays release debug clang asan-ubsan
}

# replay_hash PRESET FILE [options]: "PRESET options HASH"
replay_hash() {
  local preset=$1 words
  words=$("build/$preset/bin/foosball-replay" "${@:2}")
  echo "$preset ${*:3} $(sed -n 's/^hash *//p' <<<"$words")"
}

# The same sources of tests, compiled for another machine.
step_wasm() {
  local status=0
  configure wasm "$LOGS/wasm-configure.log" -DSF_WERROR=ON
  build wasm "$LOGS/wasm-build.log" golden_test
  rm -f "$LOGS/wasm.xml"
  node --no-warnings scripts/wasi.mjs build/wasm/bin/golden_test.wasm --gtest_output="xml:$PWD/$LOGS/wasm.xml" ||
    status=$?
  count_tests "$LOGS/wasm.xml"
  return "$status"
}

# expect STATUS COMMAND...: runs it, its words going to LOGS/STEP.said_by, and compares its exit status.
expect() {
  local wanted=$1 status=0
  shift
  "$@" >"$LOGS/$STEP.said_by" 2>&1 || status=$?
  cat "$LOGS/$STEP.said_by"
  ((status == wanted)) || { echo "\"$*\" ended with $status, not with $wanted" && return 1; }
}
has_said() { # has_said REGULAR_EXPRESSION: the last command that was expected
  grep -Eq "$1" "$LOGS/$STEP.said_by" || { echo "it did not say \"$1\"" && return 1; }
}

# What a newcomer may get wrong is answered by one sentence and exit code 2.
play_refusals() { # play_refusals FOLDER
  local options
  head -c 40 "$1/exhibition.sfr" >"$1/no.sfr"
  while read -r -a options; do
    expect 2 ./play "${options[@]}"
    [[ $(wc -l <"$LOGS/$STEP.said_by") == 1 ]] || { echo "that was more than one sentence" && return 1; }
  done <<TEXT
--nonsense
--seconds 0
--seconds 1000001
--seed -1
--seed 18446744073709551616
--headless --out $1/no.sfr
--minutes 0.05
--minutes 1e1
--sets 18
--headless --change-sides --sets 3
--headless --change-sides --sets 3 --device evdev:/dev/input/event5:4
--mode ladder --level 3
--mode challenge --minutes 1
--headless --calibration $1/no.sfr
--headless --record $1
--headless --replay $1/no.sfr
TEXT
}

# A replay says whether it is the match that was played, and ends with a status that says so too.
play_replays() { # play_replays FOLDER
  build/release/bin/space-foosball-server --port 0 --team0 computer --team1 computer --quiet --seconds 1.5 \
    --seed 18446744073709551615 --record "$1/short.sfr"
  head -c -40 "$1/short.sfr" >"$1/cut.sfr"
  python3 - "$1" <<'PYTHON' # another hash at the recorded end, the last 8 bytes
import struct, sys, zlib
data = bytearray(open(sys.argv[1] + '/short.sfr', 'rb').read())
at = 0
while at + 8 + struct.unpack_from('<I', data, at)[0] < len(data):
    at += 8 + struct.unpack_from('<I', data, at)[0]
data[-1] ^= 1
struct.pack_into('<I', data, at + 4, zlib.crc32(data[at + 8:]))
open(sys.argv[1] + '/differs.sfr', 'wb').write(data)
PYTHON
  expect 1 ./play --headless --replay "$1/differs.sfr" --screenshot "$1/differs.png"
  has_said '^verdict +the replay differs .* tick 1500:'
  has_said '^written .*/differs.png$'
  expect 4 ./play --headless --replay "$1/cut.sfr" --screenshot "$1/cut.png"
  has_said '^verdict .*cut.sfr stops early .* was played so far'
  has_said '^written .*/cut.png$'
}

# Stopped, it names what it leaves; killed, it leaves no process.
play_signals() { # play_signals FOLDER
  local pid pids status=0
  ./play --headless --seconds 600 --out "$1" --record "$1/stopped.sfr" >"$LOGS/$STEP.said_by" 2>&1 &
  pid=$!
  await larger_than 4000 "$1/stopped.sfr" # beyond the header: the match goes on, the renderer has joined it
  kill -TERM "$pid"
  wait "$pid" || status=$?
  cat "$LOGS/$STEP.said_by"
  ((status == 143)) || { echo "stopped, ./play ended with $status, not with 143" && return 1; }
  has_said '^left .*/exhibition.png$'
  has_said '^left .*/stopped.sfr$'
  expect 0 build/release/bin/foosball-replay "$1/stopped.sfr"

  ./play --headless --seconds 600 --out "$1" >/dev/null 2>&1 &
  pid=$!
  await has_children "$pid" Xvfb space-foosball space-foosball-server
  pids=$(children "$pid")
  kill -KILL "$pid"
  wait "$pid" || true
  for pid in $pids; do await is_gone "$pid"; done
}

await() { # await COMMAND...: until it succeeds, at most 30 s
  for _ in {1..600}; do
    "$@" && return
    sleep 0.05
  done
  echo "not within 30 s: $*"
  return 1
}
# Ended, though whoever adopted it may not have waited for it yet.
is_gone() { [[ $(sed -n 's/^State:[[:space:]]*\(.\).*/\1/p' "/proc/$1/status" 2>/dev/null) =~ ^[ZX]?$ ]]; }
larger_than() { [[ -f $2 && $(stat -c %s "$2") -gt $1 ]]; } # larger_than BYTES FILE
# Read from every process, since not every kernel lists children. One may end meanwhile.
children() { sed -n "s/^\([0-9]*\) (.*) [A-Za-z] $1 .*/\1/p" /proc/[0-9]*/stat 2>/dev/null || true; }
has_children() { # has_children PID PROGRAM...
  local pid program programs=' '
  for pid in $(children "$1"); do
    programs+="$(basename "$(readlink "/proc/$pid/exe" || echo ended)") "
  done
  for program in "${@:2}"; do [[ $programs == *" $program "* ]] || return 1; done
}

step_play() {
  local out=$LOGS/play
  rm -rf "$out"
  ./play --headless --seconds 6 --out "$out" | tee "$LOGS/play.words"
  local file
  for file in exhibition.png exhibition.sfr; do
    [[ -s $out/$file ]] || { echo "./play left no $file" && return 1; }
  done
  [[ $(head -c 8 "$out/exhibition.png" | od -An -tx1 | tr -d ' ') == 89504e470d0a1a0a ]]
  local wanted
  for wanted in '^score +[0-9]+ : [0-9]+$' '^physics +(9[0-9]{2}|1[0-9]{3})[.0-9]* ticks/s' \
    '^snapshots +[1-9][0-9]* received' '^picture +[0-9.]*[1-9][0-9.]* frames/s'; do
    grep -Eq "$wanted" "$LOGS/play.words" || { echo "./play did not say \"$wanted\"" && return 1; }
  done
  play_refusals "$out"
  play_replays "$out"
  play_signals "$out"
  said "$(grep -m1 score "$LOGS/play.words")"
}

"step_${STEP//-/_}"
