#!/bin/bash
# video_test.sh BIN: space-foosball-video with a real recording, a real ffmpeg and a display of its own:
# the video has as many frames as it must, and what cannot be done is said in one sentence.
set -euo pipefail
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1
fail() {
  echo "video_test: $1" >&2
  exit 1
}
size=160x120
video() { "$bin/space-foosball-video" --size "$size" --quality low --fps 10 "$@"; }

# refused CODE WORDS ARGUMENT...: ends with that code and says these words, and nothing else.
refused() {
  local code=$1 words=$2 status=0
  shift 2
  video "$@" >"$work/out" 2>"$work/err" || status=$?
  ((status == code)) || fail "$* ended with $status, not $code: $(cat "$work/err")"
  grep -q -- "$words" "$work/err" || fail "$* said \"$(cat "$work/err")\", not \"$words\""
  (($(wc -l <"$work/err") == 1)) || fail "$* said more than one sentence: $(cat "$work/err")"
}

"$bin/space-foosball-server" --quiet --port 0 --no-real-time --seconds 1.5 --team0 computer --team1 computer \
  --record "$work/match.sfr" --seed 3

for ending in mp4 mkv webm; do
  video "$work/match.sfr" "$work/whole.$ending" >"$work/out" || fail "no $ending: $(cat "$work/out")"
  grep -q '^verdict  the replay is the match' "$work/out" || fail "no verdict: $(cat "$work/out")"
  frames=$(ffprobe -loglevel error -count_frames -select_streams v -show_entries stream=nb_read_frames,width,height \
    -of csv=p=0 "$work/whole.$ending")
  [[ $frames == 160,120,15 ]] || fail "$ending has \"$frames\", not 160,120,15"
  # The match is heard: its sound is as long as the picture, and no silence.
  loudest=$(ffmpeg -i "$work/whole.$ending" -vn -af volumedetect -f null - 2>&1 | sed -n 's/.*max_volume: \(.*\) dB/\1/p')
  awk -v db="$loudest" 'BEGIN { exit !(db != "" && db > -60) }' || fail "$ending is silent ($loudest dB)"
done
# Another view is another picture of the same moments.
for view in seat above; do
  video "$work/match.sfr" "$work/$view.mp4" --mute --to 0.3 --view "$view" >"$work/out"
  ffmpeg -loglevel error -i "$work/$view.mp4" -f rawvideo "$work/$view.raw"
done
[[ $(wc -c <"$work/seat.raw") == "$(wc -c <"$work/above.raw")" ]] || fail "another view has another length"
! cmp -s "$work/seat.raw" "$work/above.raw" || fail "--view changes nothing"
refused 2 view "$work/match.sfr" "$work/no.mp4" --view below
video "$work/match.sfr" "$work/part.mp4" --from 0.5 --to 1.0 >"$work/out"
frames=$(ffprobe -loglevel error -count_frames -select_streams v -show_entries stream=nb_read_frames -of csv=p=0 "$work/part.mp4")
[[ $frames == 5 ]] || fail "half a second has $frames frames, not 5"

refused 2 'mp4, \*.mkv or \*.webm' "$work/match.sfr" "$work/film.txt"
refused 2 'cannot write' "$work/match.sfr" "$work/no/folder/film.mp4"
refused 2 'over after 1 s' "$work/match.sfr" "$work/late.mp4" --from 60
refused 2 'must come after' "$work/match.sfr" "$work/late.mp4" --from 1 --to 1
size=161x120 refused 2 'even' "$work/match.sfr" "$work/odd.mp4"
head -c 3000 /dev/zero >"$work/zeros.sfr"
refused 2 'not a recorded match' "$work/zeros.sfr" "$work/zeros.mp4"
refused 2 'no-such' "$work/no-such.sfr" "$work/none.mp4"
# A full disk is said, and is no crash.
ln -s /dev/full "$work/full.mkv"
refused 1 'ffmpeg could not write' "$work/match.sfr" "$work/full.mkv"
# Without ffmpeg the cure is named.
status=0
PATH=$work "$bin/space-foosball-video" --size 160x120 "$work/match.sfr" "$work/none.mp4" 2>"$work/err" >&2 || status=$?
((status == 1)) || fail "without ffmpeg it ended with $status"
grep -q 'apt-get install ffmpeg' "$work/err" || fail "without ffmpeg it said \"$(cat "$work/err")\""
echo "video_test: passed"
