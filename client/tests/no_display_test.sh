#!/usr/bin/env bash
# Without a display the renderer says one sentence with what to do, and exits with 4.
set -u
said=$(env -u DISPLAY -u WAYLAND_DISPLAY "$1" --mute 2>&1)
code=$?
echo "exit $code: $said"
[[ $code == 4 && $said == *xvfb-run* && $(wc -l <<<"$said") == 1 ]]
