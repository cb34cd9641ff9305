#!/bin/bash
# Builds the firmware of every controller as files to flash, with their checksums, in out/firmware/:
# scripts/release_firmware.sh
# Check them with: (cd out/firmware && sha256sum --check SHA256SUMS)
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/common.sh
packages_install build/log/packages.log build firmware
configure release build/log/firmware-configure.log -B build/firmware -DSF_BUILD_TESTS=OFF -DSF_FIRMWARE=ON
mapfile -t images < <(ninja -C build/firmware -t targets all | sed -En 's/^(firmware\/[^ :]*\.(hex|uf2)): .*/\1/p' | sort -u)
((${#images[@]} > 0)) || die 1 "the build has no firmware images; its log is build/log/firmware-configure.log"
build firmware build/log/firmware.log "${images[@]}"

version=$(sed -n 's/^project(.* VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
# Between releases the commit too, and "changed" where the tree is not as committed.
if ! git rev-parse --verify --quiet HEAD >/dev/null 2>&1; then
  version+=-unversioned # a copy without its history
elif ! git describe --exact-match --tags --match 'v*' >/dev/null 2>&1; then
  version+=-$(git rev-parse --short=9 HEAD)
  git diff --quiet HEAD -- firmware wire || version+=-changed
fi
out=out/firmware
mkdir -p "$out"
rm -f "$out"/space-foosball-*.hex "$out"/space-foosball-*.uf2 "$out/SHA256SUMS"
for image in "${images[@]}"; do
  name=$(basename "$image")
  cp "build/firmware/$image" "$out/${name%.*}-$version.${name##*.}"
done
(cd "$out" && sha256sum space-foosball-* >SHA256SUMS && sha256sum --quiet --check SHA256SUMS)
cat "$out/SHA256SUMS"
