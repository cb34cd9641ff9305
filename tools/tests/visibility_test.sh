#!/bin/bash
# visibility_test.sh BIN: in a recorded match the ball is never more than half hidden for long, in any
# view that is meant for play.
set -euo pipefail
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1
"$bin/space-foosball-server" --quiet --port 0 --no-real-time --seconds 12 --team0 computer --team1 computer \
  --record "$work/match.sfr" --seed 5
"$bin/space-foosball-visibility" "$work/match.sfr"
status=0
"$bin/space-foosball-visibility" "$work/none.sfr" 2>"$work/err" || status=$?
((status == 2)) && grep -q "none.sfr" "$work/err"
