#!/bin/sh
# Installs what is missing: a virtual environment with Cartwheel, and the Debian packages
# that pip cannot install. Usage: tools/setup.sh run|test|lint|docs|ros1
set -eu
cd "$(dirname "$0")/.."
purpose=${1:-run}
python=${PYTHON:-python3}
venv=${VENV:-.venv}

say() { printf '%s\n' "$*" >&2; }

# Installs Debian packages. If that is not possible, prints their names and fails.
install() {
    if ! command -v apt-get >/dev/null 2>&1; then
        say "missing Debian packages: $*"
        say "Install them with your system's package manager."
        return 1
    fi
    if [ "$(id -u)" = 0 ]; then as_root=""
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then as_root="sudo"
    else
        say "missing: $*"
        say "No permission to install packages. Ask your administrator for: sudo apt-get install --no-install-recommends $*"
        return 1
    fi
    say "installing: $*"
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -qq -y --no-install-recommends "$@" >/dev/null 2>&1 || {
        # The package lists may be missing or outdated.
        $as_root apt-get update -qq >/dev/null 2>&1 || true
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -qq -y --no-install-recommends "$@" >/dev/null
    }
}

has_library() { (ldconfig -p 2>/dev/null || /sbin/ldconfig -p) | grep -q "$1"; }
has_driver() { ls /usr/lib/*/dri/*swrast* >/dev/null 2>&1 || ls /usr/lib/*/libgallium* >/dev/null 2>&1; }

# ROS 1 from Debian 12: to build the folder ros1, and the programs of the launch files.
ros1_packages() {
    sed 's/#.*//' <<'END'
make cmake g++                          # catkin_make
catkin ros-message-generation ros-message-runtime
libstd-msgs-dev libgeometry-msgs-dev libtrajectory-msgs-dev libstd-srvs-dev
libactionlib-msgs-dev ros-actionlib-msgs python3-actionlib-msgs
ros-std-msgs ros-geometry-msgs ros-trajectory-msgs ros-sensor-msgs ros-std-srvs
ros-nav-msgs ros-rosgraph-msgs ros-tf2-msgs ros-roscpp-msg              # for rosmsg
python3-std-msgs python3-geometry-msgs python3-trajectory-msgs python3-sensor-msgs python3-std-srvs
python3-nav-msgs python3-tf2-msgs python3-rosgraph-msgs python3-roscpp-msg  # to echo topics
python3-dynamic-reconfigure             # to set parameters of /gazebo and of cameras
# rosmsg and rossrv need the package.xml of a type, which is in these:
libsensor-msgs-dev libnav-msgs-dev libtf2-msgs-dev libros-rosgraph-msgs-dev
libdynamic-reconfigure-config-init-mutex-dev
python3-rospy python3-roslaunch python3-rosmaster rosout
rosbash rospack-tools ros-environment   # rosrun, roscd
python3-rostopic python3-rosnode python3-rosservice python3-rosparam python3-rosmsg python3-rosbag
ros-robot-state-publisher joint-state-publisher rviz
tf-tools tf2-tools                      # static_transform_publisher
END
}

# Prints the packages that are not installed, or nothing if dpkg is not available.
absent_of() {
    command -v dpkg-query >/dev/null 2>&1 || return 0
    # It fails if one of them is missing, which is no error here.
    there=$(dpkg-query -W -f '${Status} ${Package} \n' "$@" 2>/dev/null) || true
    for package in "$@"; do
        case $there in *"ok installed $package "*) ;; *) printf ' %s' "$package" ;; esac
    done
}

# Whether a package exists. Without apt lists, this depends on the Debian release.
in_archive() {
    apt-cache show "$1" >/dev/null 2>&1 || {
        ! ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1 && grep -q 'VERSION_CODENAME=bookworm' /etc/os-release
    }
}

# Installs Cartwheel with extras. uv takes a sixth of pip's processor time, partly because it does not
# compile the packages, of which tests use a part. It does not know pip's settings of indexes.
install_python() {
    pip="$venv/bin/python -m pip"
    export PIP_DISABLE_PIP_VERSION_CHECK=1
    if [ -n "$1" ] && ! $pip config list 2>/dev/null | grep -Eq '[.:](extra-)?index-url=|[.:]no-index=|[.:]constraint='; then
        $pip install --quiet --only-binary :all: uv >/dev/null 2>&1 &&
            UV_SYSTEM_CERTS=true "$venv/bin/uv" pip install --quiet --no-cache --python "$venv/bin/python" -e ".$1" &&
            return 0
    fi
    $pip install --quiet -e ".$1"
}

# Required packages.
needed=""
if ! command -v "$python" >/dev/null 2>&1; then needed="python3 python3-venv"
elif ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then needed="python3-venv"; fi
# Optional packages: cameras need OpenGL, the viewer's tests need a browser.
wanted=""
if [ "$purpose" != lint ] && [ "$purpose" != docs ]; then
    has_library libEGL.so.1 || wanted="$wanted libegl1"
    has_library libGL.so.1 || wanted="$wanted libgl1"
    has_driver || wanted="$wanted libgl1-mesa-dri"
fi
[ -z "$wanted" ] || loss="Continuing without: cameras will publish no images."
if [ "$purpose" = test ]; then
    before=$wanted
    # Without windows: half as large.
    command -v chromium >/dev/null 2>&1 || command -v chromium-headless-shell >/dev/null 2>&1 ||
        wanted="$wanted chromium-headless-shell"
    command -v Xvfb >/dev/null 2>&1 || wanted="$wanted xvfb"
    # Node needs it, which drives the browser, and slim images do not contain it.
    has_library libatomic.so.1 || wanted="$wanted libatomic1"
    # A peer for the tests of ROS 2: Fast DDS, ROS 2's default middleware.
    [ -e /usr/include/fastdds/dds/domain/DomainParticipant.hpp ] || wanted="$wanted g++ libfastrtps-dev"
    [ "$wanted" = "$before" ] || loss="Continuing without: tests of cameras or the browser may fail or be skipped."
fi
if [ "$purpose" = test ] || [ "$purpose" = ros1 ]; then
    absent=""
    # Another ROS 1 installation, with its own setup file, has its own packages.
    if [ "${ROS_VERSION:-}" != 1 ] || [ "${ROS_DISTRO:-Debian}" = Debian ]; then
        # shellcheck disable=SC2046 # they are words
        absent=$(absent_of $(ros1_packages))
    fi
    if [ "$purpose" = ros1 ]; then
        # For rosmsg with the types of roscpp. It needs 70 packages, and no test needs it.
        needed="$needed$absent$(absent_of libroscpp-dev)"
    elif [ -n "$absent" ] && in_archive catkin; then
        wanted="$wanted $absent"
        loss="Continuing without: tests that need these are skipped or may fail."
    fi
fi

# All packages in one request. Python packages can be installed meanwhile, if Python is there.
# shellcheck disable=SC2086 # they are words
if [ -n "$needed" ]; then
    install $needed $wanted || exit 1
elif [ -n "$wanted" ]; then
    { install $wanted || say "$loss"; } &
    trap wait EXIT
fi

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    say "Cartwheel needs Python 3.11 or newer; $python is $("$python" --version). Set PYTHON=/path/to/python3.11."
    exit 1
}

extras="[test,lint,docs]"
stamp="$venv/.ready-tools"
if [ "$purpose" = run ] && [ ! -e "$stamp" ]; then
    extras=""
    stamp="$venv/.ready"
fi
if [ ! -e "$stamp" ] || [ pyproject.toml -nt "$stamp" ]; then
    # A virtual environment whose creation was interrupted has no pip.
    "$venv/bin/python" -m pip --version >/dev/null 2>&1 || "$python" -m venv --clear "$venv"
    say "installing Cartwheel${extras:+ with its tools} into $venv"
    install_python "$extras"
    touch "$stamp"
fi
