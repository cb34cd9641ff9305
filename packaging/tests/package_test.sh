#!/bin/bash
# package_test.sh BUILD: makes the Debian package of a finished build and looks into it: what it
# installs, what it depends on, that its programs run from where it puts them, and that systemd takes
# the service and finds it hardened.
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "package_test: $1" >&2
  exit 1
}

(cd "$build" && cpack -G DEB -B "$work" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log" && fail "cpack failed"; }
deb=("$work"/space-foosball_*.deb)
[[ -f ${deb[0]} ]] || fail "cpack made no space-foosball_VERSION_ARCH.deb"
dpkg-deb -x "${deb[0]}" "$work/root"
dpkg-deb -e "${deb[0]}" "$work/control"

for file in usr/bin/space-foosball usr/bin/space-foosball-server usr/bin/foosball-replay usr/bin/space-foosball-results usr/bin/space-foosball-watch \
  usr/bin/space-foosball-video usr/bin/space-foosball-match usr/bin/space-foosball-doctor usr/bin/space-foosball-play \
  usr/share/applications/space-foosball.desktop usr/share/icons/hicolor/scalable/apps/space-foosball.svg \
  usr/share/locale/ko/LC_MESSAGES/space-foosball.mo \
  lib/systemd/system/space-foosball-server.service lib/udev/rules.d/70-space-foosball.rules \
  etc/default/space-foosball-server usr/share/doc/space-foosball/README.md \
  usr/share/space-foosball/characters/2-average.toml; do
  [[ -f $work/root/$file || -f $work/root/usr/$file ]] || fail "the package lacks /$file"
done
[[ ! -e $work/root/usr/include ]] || fail "the engine's headers are not the game's"
for script in postinst prerm postrm; do
  [[ -x $work/control/$script ]] || fail "$script cannot be run"
done
grep -qx /etc/default/space-foosball-server "$work/control/conffiles" || fail "the options are no conffile"
grep -q '^Depends:.*libc6.*' "$work/control/control" || fail "the libraries are not among what it depends on"

# Fonts are opened by their paths, so nothing but this list brings them: each that the list of
# packages has for play.
fonts=0
while read -r font; do
  grep -q "^Depends:.*\b$font\b" "$work/control/control" || fail "it does not depend on $font"
  fonts=$((fonts + 1))
done < <(sed -n 's/^play  *\(fonts-[a-z-]*\) .*/\1/p' "${0%/*}/../../scripts/packages.sh")
((fonts == 2)) || fail "$fonts fonts in the list of packages"

"$work/root/usr/bin/space-foosball-server" --help >/dev/null || fail "the server does not run"
# The options that the service is installed with are options that the server has.
# shellcheck source=/dev/null
. "$work/root/etc/default/space-foosball-server"
mkdir "$work/state"
# shellcheck disable=SC2086  # one word per option, as systemd splits them
(cd "$work/state" && "$work/root/usr/bin/space-foosball-server" --quiet --port 0 --no-real-time --seconds 0.05 $SERVER_OPTIONS) ||
  fail "the server does not take \"$SERVER_OPTIONS\""
[[ -f $work/state/results.sqlite && -d $work/state/recordings ]] || fail "the service keeps no recordings and results"

# What the menu starts is there, and says in one sentence what is wrong with an option.
entry=$work/root/usr/share/applications/space-foosball.desktop
launcher=$work/root/usr/bin/$(sed -n 's/^Exec=//p' "$entry")
[[ -f $work/root/usr/share/icons/hicolor/scalable/apps/$(sed -n 's/^Icon=//p' "$entry").svg ]] || fail "the menu's entry has no icon"
"$launcher" --help >/dev/null || fail "what the menu starts does not run"
status=0
HOME=$work/home "$launcher" --level 9 2>"$work/words" || status=$?
((status == 2 && $(wc -l <"$work/words") == 1)) || fail "--level 9: ended with $status, said $(cat "$work/words")"

service=$(find "$work/root" -name space-foosball-server.service)
sed -i "s|^ExecStart=/usr/bin|ExecStart=$work/root/usr/bin|" "$service"
systemd-analyze verify --recursive-errors=no "$service" 2>"$work/verify.log" ||
  { cat "$work/verify.log" >&2 && fail "systemd does not take the service"; }
# 0 safe .. 10 exposed, in tenths; what remains is the network and the real-time rights.
systemd-analyze security --offline=yes --threshold=25 "$service" >"$work/security.log" ||
  { tail -n 3 "$work/security.log" >&2 && fail "the service is not hardened enough"; }
tail -n 1 "$work/security.log"
echo "package_test: ${deb[0]##*/}, $(du -k "${deb[0]}" | cut -f1) kB"
