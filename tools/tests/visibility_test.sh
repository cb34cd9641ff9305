#!/bin/bash
# visibility_test.sh BIN: in recorded matches of both layouts the ball is never more than half hidden
# for long, in any view that is meant for play, from either side.
set -euo pipefail
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1
for layout in tournament paper; do
  "$bin/space-foosball-server" --quiet --port 0 --no-real-time --seconds 12 --team0 computer --team1 computer \
    --level 4 --layout "$layout" --record "$work/$layout.sfr" --seed 5 &
done
wait
for layout in tournament paper; do
  "$bin/space-foosball-visibility" "$work/$layout.sfr" >"$work/words" || { cat "$work/words" && exit 1; }
  cat "$work/words"
  # Each view of each side, at 20 looks a second; some of the ball's time is in goals and ceremonies.
  awk 'NR > 1 && $4 > 60 { good++ } END { exit good != 6 }' "$work/words"
done
status=0
"$bin/space-foosball-visibility" "$work/none.sfr" 2>"$work/err" || status=$?
((status == 2)) && grep -q "none.sfr" "$work/err"
