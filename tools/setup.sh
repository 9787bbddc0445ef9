#!/bin/sh
# Sets up what is missing: a virtual environment with Cartwheel in it, and Debian's packages
# that pip cannot bring. Usage: tools/setup.sh run|test|lint|docs|ros1
set -eu
cd "$(dirname "$0")/.."
purpose=${1:-run}
python=${PYTHON:-python3}
venv=${VENV:-.venv}

say() { printf '%s\n' "$*" >&2; }

# Installs Debian packages; where that cannot be, says which ones and fails.
install() {
    if ! command -v apt-get >/dev/null 2>&1; then
        say "missing, by their Debian names: $*"
        say "Install them with your system's package manager."
        return 1
    fi
    if [ "$(id -u)" = 0 ]; then as_root=""
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then as_root="sudo"
    else
        say "missing: $*"
        say "Installing is not allowed here. Ask for: sudo apt-get install --no-install-recommends $*"
        return 1
    fi
    say "installing: $*"
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -qq -y --no-install-recommends "$@" >/dev/null 2>&1 || {
        # The package lists may be missing or old.
        $as_root apt-get update -qq >/dev/null 2>&1 || true
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -qq -y --no-install-recommends "$@" >/dev/null
    }
}

has_library() { (ldconfig -p 2>/dev/null || /sbin/ldconfig -p) | grep -q "$1"; }
has_driver() { ls /usr/lib/*/dri/*swrast* >/dev/null 2>&1 || ls /usr/lib/*/libgallium* >/dev/null 2>&1; }

# ROS 1 as Debian 12 has it: to build the folder ros1, and what the launch files start.
ros1_packages() {
    sed 's/#.*//' <<'END'
make cmake g++                          # catkin_make
catkin ros-message-generation ros-message-runtime
libstd-msgs-dev libgeometry-msgs-dev libtrajectory-msgs-dev libstd-srvs-dev
libactionlib-msgs-dev ros-actionlib-msgs python3-actionlib-msgs
ros-std-msgs ros-geometry-msgs ros-trajectory-msgs ros-sensor-msgs ros-std-srvs
python3-std-msgs python3-geometry-msgs python3-trajectory-msgs python3-sensor-msgs python3-std-srvs
python3-nav-msgs python3-tf2-msgs python3-rosgraph-msgs python3-roscpp-msg  # to echo topics
python3-dynamic-reconfigure             # to set parameters of /gazebo and of cameras
# rosmsg and rossrv find a type by its package.xml, which is in these:
libsensor-msgs-dev libnav-msgs-dev libtf2-msgs-dev libros-rosgraph-msgs-dev libroscpp-dev
libdynamic-reconfigure-config-init-mutex-dev
python3-rospy python3-roslaunch python3-rosmaster rosout
rosbash rospack-tools ros-environment   # rosrun, roscd
python3-rostopic python3-rosnode python3-rosservice python3-rosparam python3-rosmsg python3-rosbag
ros-robot-state-publisher joint-state-publisher rviz
tf-tools tf2-tools                      # static_transform_publisher
END
}

# Those of the packages that are not installed; nothing where that cannot be asked.
absent_of() {
    command -v dpkg-query >/dev/null 2>&1 || return 0
    # It fails where one of them is missing, which is what is asked.
    there=$(dpkg-query -W -f '${Status} ${Package} \n' "$@" 2>/dev/null) || true
    for package in "$@"; do
        case $there in *"ok installed $package "*) ;; *) printf ' %s' "$package" ;; esac
    done
}

# Whether there is such a package. Where apt has no lists yet, Debian's release says it.
in_archive() {
    apt-cache show "$1" >/dev/null 2>&1 || {
        ! ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1 && grep -q 'VERSION_CODENAME=bookworm' /etc/os-release
    }
}

# What nothing works without.
needed=""
if ! command -v "$python" >/dev/null 2>&1; then needed="python3 python3-venv"
elif ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then needed="python3-venv"; fi
# What some things work without: cameras need OpenGL, the viewer's tests a browser.
wanted=""
has_library libEGL.so.1 || wanted="$wanted libegl1"
has_library libGL.so.1 || wanted="$wanted libgl1"
has_driver || wanted="$wanted libgl1-mesa-dri"
[ -z "$wanted" ] || loss="Going on without: cameras will show nothing."
if [ "$purpose" = test ]; then
    before=$wanted
    command -v chromium >/dev/null 2>&1 || wanted="$wanted chromium"
    command -v Xvfb >/dev/null 2>&1 || wanted="$wanted xvfb"
    # Foxglove's own client, which the tests of that wire read with, is a program for Node.
    command -v npm >/dev/null 2>&1 || wanted="$wanted nodejs npm"
    # The program that drives the browser needs it, and slim images lack it.
    has_library libatomic.so.1 || wanted="$wanted libatomic1"
    # A peer for the tests of ROS 2, which Debian has as of ROS 2's default middleware.
    [ -e /usr/include/fastdds/dds/domain/DomainParticipant.hpp ] || wanted="$wanted g++ libfastrtps-dev"
    # Another, which needs Rust 1.88: Debian 12 has a new one beside its old one.
    if ! command -v cargo >/dev/null 2>&1; then
        if in_archive cargo-web; then wanted="$wanted cargo-web"; else wanted="$wanted cargo"; fi
    fi
    [ "$wanted" = "$before" ] || loss="Going on without: tests of cameras or the browser may fail or be skipped."
fi
if [ "$purpose" = test ] || [ "$purpose" = ros1 ]; then
    absent=""
    # Another ROS 1, with a setup file of its own, brings its own packages.
    if [ "${ROS_VERSION:-}" != 1 ] || [ "${ROS_DISTRO:-Debian}" = Debian ]; then
        # shellcheck disable=SC2046 # they are words
        absent=$(absent_of $(ros1_packages))
    fi
    if [ "$purpose" = ros1 ]; then needed="$needed$absent"
    elif [ -n "$absent" ] && in_archive catkin; then
        wanted="$wanted $absent"
        loss="Going on without: tests of what is missing are skipped or may fail."
    fi
fi

# Asked for together, so that nobody has to ask twice.
# shellcheck disable=SC2086 # they are words
if [ -n "$needed" ]; then
    install $needed $wanted || exit 1
elif [ -n "$wanted" ]; then
    install $wanted || say "$loss"
fi

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    say "Cartwheel needs Python 3.11 or newer; $python is $("$python" --version). Set PYTHON=/path/to/python3.11."
    exit 1
}

extras="[test,lint]"
stamp="$venv/.ready-tools"
if [ "$purpose" = docs ]; then
    extras="[docs]"
    stamp="$venv/.ready-docs"
elif [ "$purpose" = run ] && [ ! -e "$stamp" ]; then
    extras=""
    stamp="$venv/.ready"
fi
if [ ! -e "$stamp" ] || [ pyproject.toml -nt "$stamp" ]; then
    # One that was interrupted while it was made has no pip.
    "$venv/bin/python" -m pip --version >/dev/null 2>&1 || "$python" -m venv --clear "$venv"
    say "installing Cartwheel${extras:+ with its tools} into $venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -e ".$extras"
    touch "$stamp"
fi
