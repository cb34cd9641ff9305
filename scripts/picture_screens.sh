#!/bin/bash
# Photographs every screen of the game's window: see the usage below.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh

usage() {
  cat <<'TEXT'
scripts/picture_screens.sh [FOLDER] draws every screen of the game on a virtual display and writes it
as FOLDER/LANGUAGE-WIDTHxHEIGHT/SCREEN.png (build/screens): English and German in a usual window,
Korean and German in narrow ones. For whoever changes a screen: look at all of them.
TEXT
}

folder=build/screens
case ${1-} in
  --help | -h) usage && exit 0 ;;
  -*) die 2 "there is no option \"$1\". See --help." ;;
  ?*) folder=$1 ;;
esac

packages_install build/log/packages.log build play
[[ -f build/release/build.ninja ]] || configure release build/log/configure.log -DSF_FIRMWARE=OFF
build release build/log/screens.log client_preview client_translations
virtual_display
trap 'stop "$XVFB_PID"' EXIT
# language size
while read -r language size; do
  out=$folder/$language-$size
  mkdir -p "$out"
  LIBGL_ALWAYS_SOFTWARE=1 build/release/bin/client_preview "$out" low "$size" "$language" \
    >"$out/costs.txt" </dev/null || die 1 "$out could not be drawn: see $out/costs.txt."
  shots=("$out"/*.png)
  echo "${#shots[@]} screens in $out"
done <<'TEXT'
en 1280x720
de 1280x720
ko 640x720
de 480x720
TEXT
