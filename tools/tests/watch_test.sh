#!/bin/bash
# The real program under a virtual display, worked with keys and mouse: the list, a click on its
# second row, pause, a goal, a drag along the line, slow motion, the view from above, a picture, a
# shared copy, and out again. Then bad files and options.
#   watch_test.sh BIN_DIRECTORY
set -euo pipefail
bin=$1
work=$(mktemp -d)
watch_pid='' server_pid=''
clean_up() {
  # shellcheck disable=SC2086  # either may be empty
  kill $watch_pid $server_pid 2>/dev/null || true
  rm -rf "$work"
}
trap clean_up EXIT
export HOME=$work/home XDG_CONFIG_HOME=$work/home LIBGL_ALWAYS_SOFTWARE=1 LC_ALL=C.UTF-8
mkdir -p "$HOME" "$work/recordings"
fail() { echo "failed: $*" && cat "$work/said.all" 2>/dev/null; exit 1; }

mkdir "$work/made"
"$bin/space-foosball-match" --home 4 --away 4 --matches 2 --max-minutes 1 --jobs 1 --quiet --record "$work/made" >/dev/null
made=("$work"/made/*.sfr)
cp "${made[0]}" "$work/recordings/2026-01-01_120000.sfr"
cp "${made[1]}" "$work/recordings/2026-01-02_120000.sfr"
mkfifo "$work/recordings/pipe.sfr"
touch -d 2020-01-01 "$work/recordings/pipe.sfr"

mkfifo "$work/said"
exec 3<>"$work/said"
"$bin/space-foosball-watch" --folder "$work/recordings" --share-to "$work/shared" --mute --quality low \
  --say-state --size 1280x720 >"$work/said" 2>&1 &
watch_pid=$!
said() { # said PATTERN: a line that it prints
  local line
  while read -r -t 60 -u 3 line; do
    echo "$line" >>"$work/said.all"
    [[ $line =~ $1 ]] && return
  done
  fail "it did not say \"$1\""
}
key() { xdotool key --clearmodifiers "$@"; }

said 'list of 3, row 1'
xdotool search --sync --name 'Space Foosball: recordings' windowfocus --sync >/dev/null
key Down
said 'row 2'
xdotool mousemove 640 96 # the first row: what is under the pointer is chosen
said 'row 1'
xdotool mousemove 640 128 click 1
said '2026-01-01_120000.sfr, speed 1, playing'
key space
said 'paused'
key Home
said 'tick 0$'
key Right
said 'tick 1000$'
key period
said 'tick 1001$'
key shift+Right
said 'tick 11001$'
key Down Down
said 'speed 0.25'
key c
said 'view from above'
xdotool mousemove 18 641 mousedown 1 mousemove 640 500 mouseup 1
said 'tick (29|30|31)[0-9]{3}$' # half of a minute
key n
said 'tick'
key F12
for _ in {1..300}; do
  [[ -s "$work/shared/Space Foosball picture 1.png" ]] && break
  sleep 0.1
done
[[ $(head -c 4 "$work/shared/Space Foosball picture 1.png" | tail -c 3) == PNG ]] || fail "no picture"
key s
for _ in {1..300}; do
  copies=("$work"/shared/*.sfr)
  [[ -e ${copies[0]} && -e $work/recordings/2026-01-01_120000.sfr.keep ]] && break
  sleep 0.1
done
cmp "${copies[0]}" "$work/recordings/2026-01-01_120000.sfr" || fail "the copy differs"
key u
said 'hidden'
key Escape
said 'list of 3'
key Escape
status=0
wait "$watch_pid" || status=$?
watch_pid=''
((status == 0)) || fail "it ended with $status"

# From the game: F5 opens the list in a window of its own while the game's is hidden; Esc goes back.
"$bin/space-foosball-server" --port 0 --ready-file "$work/ready" --team1 computer --exit-when-empty \
  --no-real-time --quiet --recordings "$HOME/.local/share/space-foosball/recordings" >"$work/server.log" 2>&1 &
server_pid=$!
for _ in {1..300}; do
  [[ -s $work/ready ]] && break
  sleep 0.1
done
"$bin/space-foosball" --server "127.0.0.1:$(sed -n 's/^port=//p' "$work/ready")" --quality low --mute \
  --size 640x360 >"$work/said" 2>&1 &
watch_pid=$!
said 'synchronised with the match'
xdotool search --sync --onlyvisible --name '^Space Foosball$' windowfocus --sync >/dev/null
key F5
said 'showing the recordings'
xdotool search --sync --onlyvisible --name 'Space Foosball: recordings' windowfocus --sync >/dev/null
xdotool search --onlyvisible --name '^Space Foosball$' >/dev/null && fail "the game's window is still there"
key Escape
said 'back from the recordings'
xdotool search --sync --onlyvisible --name '^Space Foosball$' windowfocus --sync >/dev/null
kill "$watch_pid"
wait "$watch_pid" || fail "the game ended with $?"
watch_pid=''
wait "$server_pid" || fail "the server ended with $?"
server_pid=''
compgen -G "$HOME/.local/share/space-foosball/recordings/*.sfr" >/dev/null && fail "a recording of nothing was left"

expect() { # expect STATUS WORDS COMMAND...
  local wanted=$1 words=$2 status=0
  shift 2
  timeout 60 "$@" >"$work/out" 2>&1 || status=$?
  ((status == wanted)) || { cat "$work/out" && fail "$* ended with $status, not with $wanted"; }
  grep -Eq "$words" "$work/out" || { cat "$work/out" && fail "$* did not say \"$words\""; }
}
head -c 3000 /dev/urandom >"$work/noise.sfr"
expect 2 'noise.sfr is not a recorded match' "$bin/space-foosball-watch" "$work/noise.sfr"
expect 2 'pipe.sfr is not a file' "$bin/space-foosball-watch" "$work/recordings/pipe.sfr"
expect 2 'none.sfr cannot be read' "$bin/space-foosball-watch" "$work/none.sfr"
expect 2 'needs the recording' "$bin/space-foosball-watch" --share
expect 0 'Space Foosball 20' "$bin/space-foosball-watch" --share "${made[0]}" --share-to "$work/shared"
expect 0 '2026-01-01_120000.sfr.*kept' "$bin/space-foosball-watch" --list --folder "$work/recordings"
DISPLAY='' expect 4 'No display' "$bin/space-foosball-watch" "${made[0]}"
echo "the list, the keys, the mouse and the copies do what they should"
