#!/bin/bash
# The doctor's exit codes, and that what it prints for programs is JSON: doctor_test.sh FOLDER_OF_PROGRAMS
set -euo pipefail
doctor=$1/space-foosball-doctor
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/dev/input "$work"/sys/class/input/event4/device/capabilities
expect() { # expect CODE OPTION...
  local code=$1 got=0
  shift
  [[ " $* " == *" --seconds "* ]] || set -- --seconds 0.2 "$@"
  "$doctor" --dev "$work/dev" --sys "$work/sys" "$@" >"$work/out" 2>"$work/err" || got=$?
  [[ $got == "$code" ]] && return
  echo "space-foosball-doctor $*: exit code $got, not $code" >&2
  cat "$work/out" "$work/err" >&2
  exit 1
}
expect 1
grep -q 'do: plug one in' "$work/out"
expect 2 --seconds never
grep -q 'explains the options' "$work/err"
expect 2 --dev "$work/nowhere"
expect 2 --device ttyACM0
grep -q '"ttyACM0" is not a device: write .*event5; --help' "$work/err"
expect 1 --device "serial:$work/dev/ttyACM0"
grep -q 'the controller is not connected' "$work/out"
echo 3 >"$work/sys/class/input/event4/device/capabilities/rel"
echo 'A mouse' >"$work/sys/class/input/event4/device/name"
ln -s /dev/ptmx "$work/dev/input/event4" # a device that says nothing
expect 0
grep -q "evdev:$work/dev/input/event4  A mouse" "$work/out"
expect 0 --json
python3 -c 'import json, sys; assert json.load(sys.stdin)["healthy"] is True' <"$work/out"
