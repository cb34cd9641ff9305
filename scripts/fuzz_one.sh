#!/bin/bash
# fuzz_one.sh SECONDS RESULTS NAME CORPUS: one fuzz target for so long; leaves RESULTS/NAME.result.
set -uo pipefail
seconds=$1 results=$2 name=$3 corpus=$4
fail() {
  echo "FAILED $name: $1" | tee "$results/$name.result"
  exit 1
}
[[ -n $(ls "$corpus" 2>/dev/null) ]] || fail "its kept corpus $corpus is missing or empty"
mkdir -p "$results/$name-new"
ASAN_OPTIONS=detect_leaks=1 "build/asan-ubsan/bin/$name" -seed=1 -max_total_time="$seconds" -timeout=5 \
  -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$results/$name-" "$results/$name-new" "$corpus" \
  </dev/null >"$results/$name.log" 2>&1 || {
  tail -n 40 "$results/$name.log"
  fail "the input is kept as $results/$name-*, the words in $results/$name.log"
}
runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$results/$name.log")
((${runs:-0} > 0)) || fail "it ran no input at all; its words are in $results/$name.log"
echo "passed $name: $runs runs" >"$results/$name.result"
