#!/bin/bash
# Makes README's figures anew: see the usage below.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh

usage() {
  cat <<'TEXT'
scripts/pictures.sh [NAME...] makes what README.md shows of the engine anew: all of it, or only
NAME...

  sandbox   docs/pictures/sandbox-*.png: scenes in the sandbox's window, on a virtual display, with the
            step times that they took just then; on a machine that does nothing else
  plots     docs/pictures/rigid-*.png, drift-*.png: from the files that ./bench rigid, ./bench scaling
            and ./bench drift have kept in benchmarks/results; of several machines the newest file
  tables    README.md's tables, from the same files
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

make_tables() { python3 scripts/readme_figures.py; }

names=()
while (($#)); do
  case $1 in
    --help | -h) usage && exit 0 ;;
    sandbox | plots | tables) names+=("$1") ;;
    *) die 2 "there is no \"$1\" to make; there is: sandbox, plots, tables. See --help." ;;
  esac
  shift
done
((${#names[@]})) || names=(sandbox plots tables)
for name in "${names[@]}"; do "make_$name"; done
