# Functions of the scripts in this folder, which source it.

set -euo pipefail

source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
platforms=$source/build/platforms
mkdir -p "$platforms"

say() { printf '\n== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }
# CTest counts a test that exits with 77 as skipped.
skip() { printf 'skipped: %s\n' "$*"; exit 77; }

# need_programs PROGRAM...: skips the test if one is not installed.
need_programs() {
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || skip "$program is not installed (scripts/packages lists what the tests need)"
  done
}

# debian_mirror: prints the address that this system gets Debian from.
debian_mirror() {
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' |
    head -n 1
}

# make_root RELEASE FOLDER [OPTION...]: creates a Debian in FOLDER with mmdebstrap, unless it exists.
make_root() {
  local release=$1 folder=$2 mirror
  shift 2
  [ ! -e "$folder.made" ] || return 0
  mirror=$(debian_mirror)
  [ -n "$mirror" ] || skip "apt has no index of Debian; run apt-get update on a Debian"
  say "Creating a Debian ${release} in ${folder#"$source"/}"
  rm -rf "$folder"
  mkdir -p "$(dirname "$folder")"
  mmdebstrap --quiet --dpkgopt=force-unsafe-io \
    "$@" "$release" "$folder" "deb $mirror $release main"
  touch "$folder.made"
}

# need_root: skips the test unless root runs it: only root can run programs in a root folder.
need_root() {
  [ "$(id -u)" = 0 ] || skip "only root can run programs in a system in a folder"
}

# prepare_apt FOLDER: lets apt in FOLDER reach what apt reaches here.
prepare_apt() {
  cp -a /etc/apt/apt.conf.d/. "$1/etc/apt/apt.conf.d/"
  cp /etc/resolv.conf /etc/hosts "$1/etc/"
}

# in_root FOLDER COMMAND: runs a command of bash in the system in FOLDER. Its mounts and its processes
# end with it.
in_root() {
  root=$1 command=$2 unshare --mount --pid --fork --kill-child bash -euc '
    mount --rbind /dev "$root/dev"
    mount -t proc proc "$root/proc"
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
      bash -euo pipefail -c "$command"
  '
}

# clone_into FOLDER: clones the committed state of this project into FOLDER/work/project, and copies the
# test data that stands beside the project.
clone_into() {
  rm -rf "$1/work/project"
  mkdir -p "$1/work"
  git clone --quiet "$source" "$1/work/project"
  if [ -d "$source/../shared/data" ] && [ ! -d "$1/work/shared/data" ]; then
    mkdir -p "$1/work/shared"
    cp -a "$source/../shared/data" "$1/work/shared/"
  fi
}

# run_arm64 FOLDER [OPTION...] PROGRAM...: runs a program for arm64 with qemu, which looks for its
# loader and libraries in FOLDER.
run_arm64() {
  local qemu folder=$1
  shift
  qemu=$(command -v qemu-aarch64-static || command -v qemu-aarch64) || skip "qemu-aarch64 is not installed"
  "$qemu" -L "$folder" "$@"
}
