#!/bin/sh
# Do the README's commands work on a machine that has nothing? sh tests/fresh_machine.sh [FOLDER]
#
# Puts a minimal Debian 12 into FOLDER (default: a new one under /tmp, removed at the end), clones this repository there as
# it is committed, runs the apt-get line of README.md and its two commands inside, then those of MORE (MORE=.ci/run; a line
# each), and prints the minutes each took. Needs root and a Debian mirror (MIRROR=http://...). Ends with 77 where it cannot
# be tried, 1 if a command failed.
top=$(cd "$(dirname "$0")/.." && pwd)
mirror=${MIRROR:-http://deb.debian.org/debian}
root=$1
[ "$(id -u)" = 0 ] || { echo 'skipped: needs root'; exit 77; }
scratch=$(mktemp -d /tmp/fresh-machine.XXXXXX) || exit 3
[ -n "$root" ] || root=$scratch/debian
clean_up() {
  for place in proc dev/pts dev sys; do if mountpoint -q "$root/$place"; then umount "$root/$place" || umount -l "$root/$place"; fi; done
  rm -rf --one-file-system "$scratch"
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

# debootstrap: the one that is installed, else its package unpacked beside.
make_debian() {
  if ! command -v debootstrap > /dev/null; then
    (cd "$scratch" && apt-get download -q debootstrap && dpkg-deb -x debootstrap_*.deb tool) > "$scratch/log" 2>&1 || return 1
    export DEBOOTSTRAP_DIR="$scratch/tool/usr/share/debootstrap" PATH="$scratch/tool/usr/sbin:$PATH"
  fi
  debootstrap --variant=minbase bookworm "$root" "$mirror" > "$scratch/log" 2>&1
}
make_debian || { tail -n 5 "$scratch/log"; echo 'skipped: no Debian could be installed'; exit 77; }
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc" || { echo 'skipped: no /proc can be mounted'; exit 77; }
mountpoint -q "$root/dev" || mount --bind /dev "$root/dev" || { echo 'skipped: no /dev can be mounted'; exit 77; }
mountpoint -q "$root/dev/pts" || mount --bind /dev/pts "$root/dev/pts"   # script(1) makes terminals there
mountpoint -q "$root/sys" || mount -t sysfs -o ro sysfs "$root/sys" || { echo 'skipped: no /sys can be mounted'; exit 77; }
cp /etc/resolv.conf "$root/etc/" && cp /etc/apt/apt.conf.d/*proxy* "$root/etc/apt/apt.conf.d/" 2> /dev/null
[ ! -e "$root/tempolux" ] || { echo "$root/tempolux: is there already; name another folder"; exit 2; }
git clone -q --no-local "$top" "$root/tempolux" || exit 3

# inside COMMAND: runs it in the clone on the fresh machine and says how long it took.
inside() {
  begin=$(date +%s)
  echo "\$ $1"
  chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C sh -c "cd /tempolux && $1" \
    > "$scratch/log" 2>&1 < /dev/null
  code=$? seconds=$(($(date +%s) - begin))
  tail -n 4 "$scratch/log"
  echo "exit $code after $((seconds / 60)) min $((seconds % 60)) s"
  [ $code = 0 ] || { tail -n 40 "$scratch/log"; exit 1; }
}
inside "$(sed -n 's/^    \(apt-get [^#]*[^# ]\)  *#.*/\1/p' "$root/tempolux/README.md")"
sed -n 's/^    \(make -f Makefile.example\( check\)\{0,1\}\)  *#.*/\1/p' "$root/tempolux/README.md" | sort -u > "$scratch/commands"
[ "$(wc -l < "$scratch/commands")" = 2 ] || { echo 'FAILED: README.md does not begin with two commands'; exit 1; }
printf '%s\n' "$MORE" | grep . >> "$scratch/commands"
while read -r command; do inside "$command"; done < "$scratch/commands"
chroot "$root" sh -c 'cd /tempolux && ls -l out/sheet.png && ls out/frames/*.exr | wc -l && du -sh build out && git status --short'
