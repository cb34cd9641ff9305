#!/usr/bin/env bash
# The program itself: program_test.sh PROGRAM [no-display|pictures]. Without a display it says one
# sentence; with one it takes the pictures that it is asked for, and what it simulates is to the bit
# what it simulates without a window.
set -u
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "$1"
  exit 1
}
figure() { # figure FILE KEY
  sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"]*\).*/\1/p" "$1"
}

if [[ $2 == no-display ]]; then
  said=$(env -u DISPLAY -u WAYLAND_DISPLAY "$program" tower10 2>&1)
  code=$?
  [[ $code == 4 && $said == *xvfb-run* && $said == *--no-window* && $(wc -l <<<"$said") == 1 ]] ||
    fail "without a display: exit $code: $said"
  said=$("$program" "tower of babel" 2>&1)
  code=$?
  [[ $code == 2 && $said == *"tower of babel"* && $said == *towers1120* && $(wc -l <<<"$said") == 1 ]] ||
    fail "of no scene: exit $code: $said"
  said=$("$program" tower10 --rate nan 2>&1)
  code=$?
  [[ $code == 2 && $said == *--rate* ]] || fail "of a bad rate: exit $code: $said"
  exit 0
fi

"$program" dominoes --rate 240 --seconds 0.5 --no-window --stats-file "$folder/without.json" ||
  fail "without a window: exit $?"
"$program" dominoes --rate 240 --skip-to 0.3 --seconds 0.5 --contacts --screenshot-at 0.4 \
  --screenshot "$folder/picture.png" --stats-file "$folder/with.json" --size 480x270 ||
  fail "with a window: exit $?"
for key in hash steps in_place; do
  [[ -n $(figure "$folder/with.json" $key) &&
    $(figure "$folder/with.json" $key) == "$(figure "$folder/without.json" $key)" ]] ||
    fail "$key differs: $(figure "$folder/with.json" $key) in a window, $(figure "$folder/without.json" $key) without"
done
[[ $(figure "$folder/with.json" steps) == 120 ]] || fail "not 120 steps in half a second at 240 Hz"
[[ $(head -c 8 "$folder/picture.png" | od -An -tx1 | tr -d ' \n') == 89504e470d0a1a0a ]] ||
  fail "the picture is no PNG"
(($(stat -c %s "$folder/picture.png") > 20000)) || fail "the picture is blank"
