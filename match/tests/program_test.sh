#!/bin/bash
# The programs as they are run: clear sentences for bad options, recordings that replay, and the same
# totals from threads, from 1, 2 and 4 ranks, and from a run that was killed and goes on.
#   program_test.sh SPACE_FOOSBALL_MATCH FOOSBALL_REPLAY SPACE_FOOSBALL_RESULTS [SPACE_FOOSBALL_MATCH_MPI]
set -euo pipefail
match=$1 replay=$2 results=$3 mpi=${4:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

# refuses SENTENCE OPTION...: exit code 2, and one line on stderr that has the sentence.
refuses() {
  local sentence=$1 code=0
  shift
  "$match" "$@" >"$folder/out" 2>"$folder/err" || code=$?
  [[ $code == 2 ]] || fail "$* ended with $code"
  [[ $(wc -l <"$folder/err") == 1 && ! -s $folder/out ]] || fail "$*: not one line: $(cat "$folder/err")"
  grep -q -- "$sentence" "$folder/err" || fail "$*: said $(cat "$folder/err")"
}
refuses 'is not a player: give one of' --home nobody
refuses 'one-rod needs another player' --home one-rod:one-rod:1
refuses 'a skill is a number from 0 to 1' --away classic:1.5
refuses 'paper' --layout square
refuses 'excludes' --sprt classic idle --report
refuses 'elo0 must be below' --sprt classic idle --elo0 5 --elo1 5
refuses 'twice' --round-robin idle idle
refuses '--matches' --matches many
refuses 'not exist' --record "$folder/none"
refuses 'choose a file' --checkpoint "$folder/none/file"
refuses '--nonsense' --nonsense
for seed in -1 18446744073709551616 1x; do refuses 'is not a whole number from 0 to' --seed "$seed"; done
refuses 'is not a number' --max-minutes nan
refuses 'is not a number' --sprt idle classic --alpha nan
refuses 'is not a number' --sprt idle classic --beta nan
refuses 'is not a number' --train --home 5 --step nan
# What the mode does not read is not taken in silence.
refuses '--opponents is used with --screen or --train only' --opponents 5
refuses '--step is used with' --report --step 0.2
refuses '--parameters is used with' --parameters shot_bar
refuses '--write is used with --train only' --screen --write "$folder/file"
refuses '--samples is used with --study only' --samples 3
refuses '--max-matches is used with --sprt or --round-robin or --balance only' --max-matches 10
refuses '--alpha is used with' --report --alpha 0.1
for option in --elo0 --elo1 --beta; do refuses "$option is used with --sprt or --round-robin only" --balance $option 0.1; done
refuses 'omit --layout' --stuck-balls --layout paper
refuses 'both go to standard output' --csv - --json -
refuses "--csv and --json both go to $folder/./same" --csv "$folder/same" --json "$folder/./same"
mkfifo "$folder/pipe"
for path in "$folder" "$folder/pipe" /dev/null; do refuses 'give another file' --checkpoint "$path"; done
# What cannot be written in the end is refused before hours of play.
for path in "$folder" "$folder/none/file"; do
  refuses "cannot write $path" --csv "$path"
  refuses "cannot write $path" --json "$path"
  refuses "cannot write $path" --train --home 5 --write "$path"
done
printf 'gravity = 9.0\nhop_gain = true\n' >"$folder/garbage.toml"
refuses 'garbage.toml:2: hop_gain must be a number' --tuning "$folder/garbage.toml"
refuses 'cannot be read' --tuning "$folder/none.toml"
refuses 'has no judgment' --train --home classic
refuses 'is not a value of judgment' --train --home 5 --parameters shot_bar,bar
refuses 'excludes' --train --home 5 --report
printf 'shot_bar = 0.4\n\npatience = "long"\n' >"$folder/hasty.toml"
refuses 'hasty.toml:3: patience must be a number from 0.1 to 3 s' --home "5@$folder/hasty.toml"
refuses 'cannot be read' --away "one-rod:5@$folder/none.toml"

# Every figure of the report is a row, whoever it is of; what cannot be is left out.
report() { # report ROWS OPTION...: the sections that it has
  local rows=$1
  shift
  "$match" --report --matches 2 --max-minutes 0.05 --quiet --csv "$folder/report.csv" "$@" >"$folder/out" ||
    fail "--report $*: ended with $?"
  [[ $(grep -c . "$folder/report.csv") == "$rows" ]] || fail "--report $*: $(grep -c . "$folder/report.csv") rows"
  odd=$(tail -n +2 "$folder/report.csv" | grep -vE '^("[^"]*",){2}[-0-9.]*,[0-9.]*,("[^"]*",){2}(pass|short|open|no data)?$' || true)
  [[ -z $odd ]] || fail "--report $*: $odd"
}
report 62 --away 1
grep -q '^"one-rod:2 against 1, 2 matches, tournament layout","points of the player with one rod",' "$folder/report.csv" ||
  fail "--report is not of the level that the game offers"
report 61 --home one-rod:2
report 57 --home one-rod:spinner --away idle
report 61 --home spinner
report 50 --home idle
report 62 --home 5:wall@shot_bar=0.4 --away classic:0.9 --layout paper

code=0
"$match" --stuck-balls --matches 2 --max-minutes 0.05 --quiet --csv "$folder/stuck.csv" >"$folder/out" || code=$?
[[ $code == 0 && $(grep -c 'longest' "$folder/stuck.csv") == 20 ]] || fail "--stuck-balls: ended with $code"

# A few seconds of play a match; the totals with all distributions are in the JSON.
options=(--quiet --matches 8 --max-minutes 0.05 --home classic:0.9 --away classic:0.3)
"$match" "${options[@]}" --json "$folder/threads.json" --record "$folder" --checkpoint "$folder/whole" >"$folder/out"
digest=$(grep digest "$folder/out")
recordings=("$folder"/*.sfr)
echo 'gravity = 9.0' >"$folder/light.toml"
"$match" "${options[@]}" --tuning "$folder/light.toml" >"$folder/light"
[[ $(grep digest "$folder/light") != "$digest" ]] || fail "--tuning changes nothing"
[[ ${#recordings[@]} == 8 ]] || fail "${#recordings[@]} recordings of 8 matches"
"$replay" "${recordings[0]}" | grep -q 'is the match that was played' || fail "a recording does not replay"

# The study that chose the defaults can be run about the values of then.
"$match" --quiet --study --samples 0 --home idle --matches 2 --max-minutes 0.05 --csv "$folder/study.csv" \
  --tuning "${0%/*}/../../docs/tuning-before-the-study.toml" >/dev/null
grep -q '^"paper; defaults gravity=14 field_restitution=0.7 .* sag_acceleration=0.45' "$folder/study.csv" ||
  fail "a study about other values: $(sed -n 2p "$folder/study.csv")"

# Into a file of results: every match once, with its recording; a file that fails loses none.
"$match" "${options[@]}" --results "$folder/matches.sqlite" --record "$folder" >"$folder/out"
grep -qx "$digest" "$folder/out" || fail "--results changes the matches"
"$results" matches "$folder/matches.sqlite" --format csv >"$folder/rows"
[[ $(wc -l <"$folder/rows") == 9 ]] || fail "$(wc -l <"$folder/rows") rows of 8 matches and a heading"
[[ $(grep -c 'computer classic:0.9' "$folder/rows") == 8 ]] || fail "the players are not named"
while IFS=, read -r _ _ _ _ _ _ _ _ _ recording _; do
  [[ $recording == recording || -f $recording ]] || fail "no recording $recording"
done <"$folder/rows"
refuses 'not a database of results' --results "$folder/whole"
refuses 'cannot be opened' --results "$folder/none/file"
python3 - "$folder/matches.sqlite" <<'SQL'
import sqlite3, sys
sqlite3.connect(sys.argv[1]).executescript(
    "CREATE TRIGGER full BEFORE INSERT ON match BEGIN SELECT RAISE(ABORT, 'as a disk that fills'); END;")
SQL
code=0
"$match" "${options[@]}" --results "$folder/matches.sqlite" >"$folder/out" 2>"$folder/err" || code=$?
[[ $code == 1 ]] || fail "a file of results that fails: ended with $code"
grep -qx "$digest" "$folder/out" || fail "a file of results that fails: no figures"
grep -q "as a disk that fills; 8 matches are in $folder/matches.sqlite.unsaved.csv" "$folder/err" ||
  fail "a file of results that fails: said $(cat "$folder/err")"
[[ $(wc -l <"$folder/matches.sqlite.unsaved.csv") == 9 ]] || fail "unsaved: $(wc -l <"$folder/matches.sqlite.unsaved.csv") rows"

same() {
  cmp -s "$folder/threads.json" "$1" || fail "$2: other figures"
  grep -qx "$digest" "$folder/out" || fail "$2: other matches: $(grep digest "$folder/out")"
}
# Cut in the middle of a line, as by a kill while it was written.
head -c "$(($(wc -c <"$folder/whole") * 2 / 3))" "$folder/whole" >"$folder/cut"
cp "$folder/cut" "$folder/cut-mpi"
"$match" "${options[@]}" --json "$folder/cut.json" --checkpoint "$folder/cut" >"$folder/out"
same "$folder/cut.json" "resumed"
grep -q '^8 matches played' "$folder/out" && fail "resumed: played all matches again"

# A search, the file of what it found, and the same search again: by three threads, and from a
# checkpoint that was cut off in its second generation.
search=(--quiet --train --home 5 --opponents 5 --parameters "shot_bar,patience,hands_goalie" --population 4
  --generations 3 --matches 2 --validate 2 --max-minutes 0.1 --seed 3)
"$match" "${search[@]}" --jobs 1 --json "$folder/search.json" --checkpoint "$folder/search" \
  --write "$folder/found.toml" >"$folder/found"
grep -q '^52 matches played' "$folder/found" || fail "a search: $(grep played "$folder/found")"
"$match" --quiet --home "5@$folder/found.toml" --matches 2 --max-minutes 0.05 >"$folder/out" ||
  fail "what a search wrote cannot be played with"
"$match" --list-judgment "5@$folder/found.toml" | diff - "$folder/found.toml" >"$folder/diff" ||
  fail "what a search wrote is listed otherwise: $(cat "$folder/diff")"
found() { cmp -s "$folder/search.json" "$folder/again.json" || fail "a search $1: other figures"; }
"$match" "${search[@]}" --jobs 3 --json "$folder/again.json" >/dev/null
found "by three threads"
head -n 27 "$folder/search" | head -c -9 >"$folder/search-cut"
cp "$folder/search-cut" "$folder/search-mpi"
"$match" "${search[@]}" --json "$folder/again.json" --checkpoint "$folder/search-cut" >"$folder/out"
found "that was stopped"
grep -q '^27 matches played' "$folder/out" || fail "a search that was stopped: $(grep played "$folder/out")"
refuses 'of other matches' "${search[@]}" --step 0.2 --checkpoint "$folder/search"
# A changed player, rule or physics shows in the fingerprint of the head; another search, in the
# digests of the samples.
sed '1s/[0-9]*$/7/' "$folder/search" >"$folder/changed"
refuses 'another version of the game, whose players' "${search[@]}" --checkpoint "$folder/changed"
sed -E '2,$s/^([0-9]+ [0-9]+) [0-9]+/\1 7/' "$folder/search" >"$folder/changed"
code=0
"$match" "${search[@]}" --checkpoint "$folder/changed" >/dev/null 2>"$folder/err" || code=$?
[[ $code == 1 ]] || fail "other samples: ended with $code"
grep -q 'games of other samples' "$folder/err" || fail "other samples: said $(cat "$folder/err")"

# Killed at whatever point it had reached.
long=(--quiet --matches 12 --max-minutes 0.2 --jobs 1)
"$match" "${long[@]}" --json "$folder/long.json" >/dev/null
timeout -s KILL 0.5 "$match" "${long[@]}" --checkpoint "$folder/killed" >/dev/null 2>&1 || true
"$match" "${long[@]}" --checkpoint "$folder/killed" --json "$folder/resumed.json" >/dev/null
cmp -s "$folder/long.json" "$folder/resumed.json" || fail "killed and resumed: other figures"
refuses 'of other matches' "${long[@]}" --seed 2 --checkpoint "$folder/killed"

if [[ -n $mpi ]]; then
  launch() { timeout 100 mpirun --oversubscribe --allow-run-as-root -n "$@"; }
  for ranks in 1 2 4; do
    launch $ranks "$mpi" "${options[@]}" --json "$folder/ranks.json" >"$folder/out"
    same "$folder/ranks.json" "$ranks ranks"
  done
  for ranks in 2 4; do
    launch $ranks "$mpi" "${search[@]}" --json "$folder/again.json" >/dev/null
    found "by $ranks ranks"
  done
  launch 3 "$mpi" "${search[@]}" --json "$folder/again.json" --checkpoint "$folder/search-mpi" >/dev/null
  found "that was stopped, by 3 ranks"
  launch 3 "$mpi" "${options[@]}" --json "$folder/ranks.json" --checkpoint "$folder/cut-mpi" >"$folder/out"
  same "$folder/ranks.json" "resumed by 3 ranks"

  # As with another version of the program on another machine.
  code=0
  timeout 100 mpirun --oversubscribe --allow-run-as-root -n 1 "$mpi" "${options[@]}" : \
    -n 1 "$mpi" "${options[@]}" --seed 2 >"$folder/out" 2>"$folder/err" || code=$?
  [[ $code != 0 ]] || fail "ranks with other options ended as if nothing were"
  grep -q 'rank 1 plays other matches, or another version' "$folder/err" ||
    fail "ranks with other options: said $(cat "$folder/err")"

  # Two ranks are stopped with a match each, which are handed out again; one is back before the end.
  # Its match is counted, and is in the checkpoint and in the file of results, once.
  back=(--quiet --matches 8 --max-minutes 8 --home idle --away idle --checkpoint "$folder/back")
  launch 4 "$mpi" "${back[@]}" --results "$folder/back.sqlite" >/dev/null 2>&1 &
  job=$!
  rank() {
    for process in $(pgrep -f -- "--checkpoint $folder/back"); do
      if tr '\0' '\n' 2>/dev/null <"/proc/$process/environ" | grep -qx "OMPI_COMM_WORLD_RANK=$1"; then echo "$process"; fi
    done
  }
  in_file() { if [[ -f $folder/back ]]; then grep -c '#' "$folder/back" || true; else echo 0; fi; }
  until_in_file() { until (($(in_file) >= $1)) || ! kill -0 $job 2>/dev/null; do sleep 0.02; done; }
  until_in_file 1
  first=$(rank 1) second=$(rank 2) third=$(rank 3)
  if [[ -n $first && -n $second && -n $third ]]; then
    kill -STOP "$second" "$third"
    until_in_file 7
    kill -STOP "$first"
    kill -CONT "$second"
    until_in_file 8
    kill -CONT "$first" "$third" || true
  fi
  wait $job || fail "ranks that were stopped: ended with $?"
  rows=$("$results" matches "$folder/back.sqlite" --format csv | wc -l)
  [[ $rows == 9 ]] || fail "ranks that were stopped: $((rows - 1)) rows of 8 matches in the file of results"
  [[ $(in_file) == 8 ]] || fail "ranks that were stopped: $(in_file) of 8 matches in the checkpoint"

  # A rank that is killed ends the job with it; what was finished is not lost, nor played again.
  lost=(--quiet --matches 24 --max-minutes 0.3)
  "$match" "${lost[@]}" --json "$folder/none-lost.json" >/dev/null
  launch 3 "$mpi" "${lost[@]}" --checkpoint "$folder/lost" >/dev/null 2>&1 &
  job=$!
  finished() { if [[ -f $folder/lost ]]; then echo $(($(wc -l <"$folder/lost") - 1)); else echo 0; fi; }
  until (($(finished) >= 2)) || ! kill -0 $job 2>/dev/null; do sleep 0.02; done
  kill -KILL "$(pgrep -n -f -- "--checkpoint $folder/lost")"  # the rank that started last
  wait $job && fail "a job with a killed rank ended as if nothing were"
  kept=$(finished)
  ((kept >= 2 && kept < 24)) || fail "a rank was killed, and $kept of 24 matches were finished"
  launch 2 "$mpi" "${lost[@]}" --checkpoint "$folder/lost" --json "$folder/lost.json" >"$folder/out"
  cmp -s "$folder/none-lost.json" "$folder/lost.json" || fail "after a lost rank: other figures"
  grep -q "^$((24 - kept)) matches played" "$folder/out" || fail "after a lost rank: $kept were finished, then $(grep played "$folder/out")"
fi
echo "program_test: $failures failures"
[[ $failures == 0 ]]
