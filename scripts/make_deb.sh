#!/bin/bash
# Builds the game and leaves it as a Debian package in out/: scripts/make_deb.sh
#   sudo apt install ./out/space-foosball_*.deb
#   sudo systemctl enable --now space-foosball-server
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh
packages_install build/log/packages.log build play deb
[[ -f build/release/build.ninja ]] || configure release build/log/configure.log -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=OFF
build release build/log/deb.log space-foosball-server space-foosball space-foosball-results space-foosball-watch \
  space-foosball-video space-foosball-match space-foosball-doctor foosball-replay
mkdir -p out
# Only the game's part is installed into the package, so nothing else needs to be built.
(cd build/release && cpack -G DEB -B ../../out) >build/log/cpack.log 2>&1 ||
  die 1 "cpack failed; its log is build/log/cpack.log"
rm -rf out/_CPack_Packages
ls out/space-foosball_*.deb
