# Functions and settings of the scripts in this folder, which source it. The scripts run as root or
# with sudo, never ask, and print each step.

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
devel=$root/devel  # not in build/: rosrun does not look there

# Only programs of the distribution: another python3 in PATH breaks catkin.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
export DEBIAN_FRONTEND=noninteractive
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1  # nodes talk to each other on this machine only
export ROS_LOG_DIR=$build/ros/log
export ROS_HOME=$build/ros/home

say() { printf '\n== %s\n' "$*"; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo -E "$@"; fi
}

# Prints the code name of this system's release, for example bookworm.
release() { sed -n 's/^VERSION_CODENAME=//p' /etc/os-release; }

is_ubuntu_2004() { [ "$(release)" = focal ]; }

# missing_packages GROUP...: prints the packages of these groups in scripts/packages that are not
# installed.
missing_packages() {
  local column=2 group name
  case "$(release)" in
    trixie) column=3 ;;
    focal) column=4 ;;
  esac
  for group in "$@"; do
    for name in $(awk -v g="$group" -v c="$column" \
      '$1 == g { name = $c == "=" ? $2 : $c; if (name != "-") print name }' "$root/scripts/packages"); do
      # Only amd64 compiles for another processor.
      case "$(dpkg --print-architecture):$name" in
        amd64:*) ;;
        *:g++-aarch64-linux-gnu | *:qemu-user-static) continue ;;
      esac
      dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed || echo "$name"
    done
  done
}

# apt_install PACKAGE...: installs packages; fails with the end of apt's output if that fails.
apt_install() {
  as_root apt-get install -y -qq --no-install-recommends "$@" >"$build/apt.log" 2>&1 ||
    { tail -n 20 "$build/apt.log" >&2; die "apt-get install failed; the complete log is $build/apt.log"; }
}

# install_packages GROUP...: installs the packages that scripts/packages lists for these groups.
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  if [ ${#missing[@]} = 0 ]; then
    say "All packages of the groups $* are installed"
    return
  fi
  say "Installing ${#missing[@]} packages of the groups $*: ${missing[*]}"
  as_root apt-get update -qq
  apt_install "${missing[@]}"
}

# install_optional_packages GROUP...: does the same, but only warns about packages that cannot be
# installed.
install_optional_packages() {
  local name
  for name in $(missing_packages "$@"); do
    say "Installing $name"
    (apt_install "$name") || echo "warning: continuing without the package $name" >&2
  done
}

# source_ros FILE: sources a setup file of ROS; those use variables that may be unset.
source_ros() {
  set +u
  # shellcheck disable=SC1090
  . "$1"
  set -u
}

# Sources the setup file of a ROS in /opt/ros, if there is one; Debian's own ROS needs none.
ros_environment() {
  local setup
  for setup in "/opt/ros/${ROS_DISTRO:-noetic}/setup.sh" /opt/ros/*/setup.sh; do
    if [ -r "$setup" ]; then
      source_ros "$setup"
      return
    fi
  done
}

# configure DIRECTORY [CMAKE_ARGUMENT...]: configures the project in DIRECTORY.
configure() {
  local directory=$1
  shift
  # The only package that Ubuntu 20.04 does not have.
  if is_ubuntu_2004; then set -- "$@" -DFPGA_STEREO_FETCH_HIGHWAY=ON; fi
  cmake -S "$root" -B "$directory" -DCATKIN_DEVEL_PREFIX="$devel" "$@" >"$directory.cmake.log" 2>&1 ||
    { tail -n 30 "$directory.cmake.log" >&2; die "cmake failed; the complete log is $directory.cmake.log"; }
}

# run_build DIRECTORY [--target TARGET...]: builds targets, or everything.
run_build() {
  local directory=$1
  cmake --build "$@" -- -j"$(nproc)" >"$directory.make.log" 2>&1 ||
    { grep -nE 'error|warning|\*\*\*' "$directory.make.log" | head -n 40 >&2
      die "the build failed; the complete log is $directory.make.log"; }
}

# build_tree DIRECTORY [CMAKE_ARGUMENT...]: configures and builds the project in DIRECTORY.
build_tree() {
  say "Building in ${1#"$root"/}"
  configure "$@"
  run_build "$1"
}

# build_targets DIRECTORY TARGET...: configures the project with its tests, and builds some targets.
build_targets() {
  local directory=$1
  shift
  say "Building $* in ${directory#"$root"/}"
  configure "$directory" -DCATKIN_ENABLE_TESTING=ON
  run_build "$directory" --target "$@"
}

mkdir -p "$build" "$ROS_LOG_DIR" "$ROS_HOME"
