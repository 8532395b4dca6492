# Shared by the scripts of this folder; to be sourced by bash. They run as root or with sudo, ask
# nothing, and say what they do.

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build

# Nothing but the distribution's programs: a python3 from elsewhere in PATH breaks catkin.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
export DEBIAN_FRONTEND=noninteractive
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1  # nothing here leaves the machine
export ROS_LOG_DIR=$build/ros/log
export ROS_HOME=$build/ros/home

say() { printf '\n== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo -E "$@"; fi
}

# install_packages GROUP...: what scripts/packages lists for the groups and is not there yet.
install_packages() {
  local column=2
  if [ -r /etc/os-release ] && (. /etc/os-release && [ "${VERSION_CODENAME:-}" = focal ]); then
    column=3
  fi
  local group names missing=()
  for group in "$@"; do
    names=$(awk -v g="$group" -v c="$column" '$1 == g && $c != "-" { print $c }' \
      "$root/scripts/packages")
    local name
    for name in $names; do
      dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed ||
        missing+=("$name")
    done
  done
  if [ ${#missing[@]} = 0 ]; then
    say "Every package for $* is installed"
    return
  fi
  say "Installing ${#missing[@]} packages for $*: ${missing[*]}"
  as_root apt-get update -qq
  as_root apt-get install -y -qq --no-install-recommends "${missing[@]}" >"$build/apt.log" 2>&1 ||
    { tail -n 20 "$build/apt.log" >&2; die "apt-get install failed; the whole log is $build/apt.log"; }
}

# Source a file of ROS, which does not mind unset variables.
source_ros() {
  set +u
  # shellcheck disable=SC1090
  . "$1"
  set -u
}

# The environment of a ROS in /opt/ros, where there is one; Debian's needs none.
ros_environment() {
  local setup
  for setup in "/opt/ros/${ROS_DISTRO:-noetic}/setup.sh" /opt/ros/*/setup.sh; do
    if [ -r "$setup" ]; then
      source_ros "$setup"
      return
    fi
  done
}

# build_tree DIRECTORY [CMAKE-ARGUMENT...]
build_tree() {
  local directory=$1
  shift
  say "Building in ${directory#"$root"/}"
  cmake -S "$root" -B "$directory" "$@" >"$directory.cmake.log" 2>&1 ||
    { tail -n 30 "$directory.cmake.log" >&2; die "cmake failed; the whole log is $directory.cmake.log"; }
  cmake --build "$directory" -- -j"$(nproc)" >"$directory.make.log" 2>&1 ||
    { grep -nE 'error|warning|\*\*\*' "$directory.make.log" | head -n 40 >&2
      die "the build failed; the whole log is $directory.make.log"; }
}

mkdir -p "$build" "$ROS_LOG_DIR" "$ROS_HOME"
