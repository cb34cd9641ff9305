#!/bin/bash
# Renders the printed parts of cabinet/parts/ to STL files in out/parts/, and checks that each is a closed
# volume that fits a printer's bed: scripts/build_parts.sh
# With --pictures the pictures of docs/build/pictures/ too, without a display; names after it: only these.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh
packages_install build/log/packages.log docs
case ${1:-} in
  '') exec python3 scripts/render_parts.py --out out/parts ;;
  --pictures)
    python3 scripts/render_parts.py --out out/parts
    virtual_display
    trap 'stop "$XVFB_PID"' EXIT
    LIBGL_ALWAYS_SOFTWARE=1 python3 scripts/render_parts.py --pictures "${@:2}"
    ;;
  *) die 2 "there is no option \"$1\": scripts/build_parts.sh [--pictures [NAME...]]" ;;
esac
