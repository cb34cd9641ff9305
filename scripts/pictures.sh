#!/bin/bash
# Makes the pictures and tables of README.md and docs: see the usage below.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh

usage() {
  cat <<'TEXT'
scripts/pictures.sh [NAME...] makes what the documents show: all of it, or only NAME...

  sandbox   docs/pictures/sandbox-*.png: scenes in the sandbox's window, on a virtual display, with the
            step times that they took just then; on a machine that does nothing else
  plots     docs/pictures/rigid-*.png, drift-*.png: from the files that ./bench rigid, ./bench scaling
            and ./bench drift have kept in benchmarks/results; of several machines the newest file
  tables    the tables of docs/benchmarks.md, from the same files
  play      docs/pictures/play.webp: a goal of two computer players, drawn in software
TEXT
}

# The figure of the paper, ours, and more: picture, scene, options.
sandbox_pictures() {
  cat <<'TEXT'
towers1120 towers1120 --skip-to 9.5 --seconds 10
pyramid1128 pyramid1128 --skip-to 9.5 --seconds 10 --look=-70,14
pile1120 pile1120 --skip-to 5.5 --seconds 6 --look=-60,30,0.92
contacts tower10 --rate 60 --skip-to 1 --seconds 2 --contacts --impulses --frames --look=-60,12,0.55
ragdolls ragdolls --skip-to 1 --seconds 1.1 --look=-60,25,0.6
TEXT
}

make_sandbox() {
  local name scene options
  packages_install build/log/packages.log build play
  [[ -f build/release/build.ninja ]] || configure release build/log/configure.log -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
  build release build/log/pictures.log vphysics-sandbox
  virtual_display
  trap 'stop "$XVFB_PID"' EXIT
  while read -r name scene options; do
    # shellcheck disable=SC2086  # one word per option
    LIBGL_ALWAYS_SOFTWARE=1 build/release/bin/vphysics-sandbox "$scene" $options \
      --screenshot "docs/pictures/sandbox-$name.png" </dev/null
  done < <(sandbox_pictures)
}

# newest NAME: of all machines' results, if there are any.
newest() {
  local files=(benchmarks/results/*/"$1")
  # shellcheck disable=SC2012  # names of our own making
  [[ ! -e ${files[0]} ]] || ls -t "${files[@]}" | head -n 1
}

make_plots() {
  local file
  packages_install build/log/packages.log bench
  file=$(newest rigid.csv)
  [[ -z $file ]] || /usr/bin/python3 scripts/plot_rigid.py steps "$file" docs/pictures
  file=$(newest scaling.csv)
  [[ -z $file ]] || /usr/bin/python3 scripts/plot_rigid.py scaling "$file" docs/pictures
  file=$(newest drift-curves.csv)
  [[ -z $file ]] || /usr/bin/python3 scripts/plot_drift.py "$file" docs/pictures
}

make_tables() { python3 scripts/benchmark_tables.py; }

# The recording is the same in every run.
make_play() {
  local folder
  packages_install build/log/packages.log build play video
  [[ -f build/release/build.ninja ]] || configure release build/log/configure.log -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
  build release build/log/pictures.log space-foosball-server space-foosball-video
  folder=$(mktemp -d)
  build/release/bin/space-foosball-server --quiet --port 0 --no-real-time --seconds 12 --seed 11 --level 5 \
    --team0 computer --team1 computer --record "$folder/match.sfr"
  virtual_display
  trap 'stop "$XVFB_PID"' EXIT
  LIBGL_ALWAYS_SOFTWARE=1 build/release/bin/space-foosball-video "$folder/match.sfr" "$folder/match.mp4" \
    --from 4.4 --to 9.4 --fps 20 --size 960x540 --mute </dev/null
  ffmpeg -v error -y -i "$folder/match.mp4" -vf scale=640:-1:flags=lanczos -c:v libwebp_anim -loop 0 -quality 55 \
    docs/pictures/play.webp </dev/null
  rm -r "$folder"
}

names=()
while (($#)); do
  case $1 in
    --help | -h) usage && exit 0 ;;
    sandbox | plots | tables | play) names+=("$1") ;;
    *) die 2 "there is no \"$1\" to make; there is: sandbox, plots, tables, play. See --help." ;;
  esac
  shift
done
((${#names[@]})) || names=(sandbox plots tables play)
for name in "${names[@]}"; do "make_$name"; done
