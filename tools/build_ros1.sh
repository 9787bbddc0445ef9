#!/bin/sh
# Builds the catkin workspace ros1 in ros1/devel, or in the folder CARTWHEEL_ROS1.
set -eu
cd "$(dirname "$0")/.."
here=$(pwd -P)
venv=${VENV:-.venv}
build=${CARTWHEEL_ROS1:-$here/ros1}
case $venv in /*) ;; *) venv=$here/$venv ;; esac

say() { printf '%s\n' "$*" >&2; }

command -v catkin_make >/dev/null 2>&1 || {
    say "ROS 1 is not installed: the program catkin_make is missing."
    say "Debian 12 has a package (tools/setup.sh ros1 installs it); docs/ros1.md lists the alternatives."
    exit 1
}

# A build from another folder or of another catkin cannot be continued.
cache=$build/build/CMakeCache.txt
if [ -e "$cache" ] && ! grep -qx "CMAKE_HOME_DIRECTORY:INTERNAL=$here/ros1/src" "$cache"; then
    rm -rf "$build/build" "$build/devel"
fi

# catkin must use the Python that rospy is installed for, whatever is first in PATH.
python=/usr/bin/python3
[ -x "$python" ] || python=$(command -v python3)
mkdir -p "$build/build"
log=$build/build/catkin_make.log
if ! ROS_VERSION=1 catkin_make -C "$build" --source "$here/ros1/src" \
    -DPYTHON_EXECUTABLE="$python" -DCARTWHEEL="$venv/bin/cartwheel" -DCATKIN_ENABLE_TESTING=OFF \
    >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    say "The workspace ros1 could not be built; the output is in $log"
    exit 1
fi

case $build in "$here"/*) shown=${build#"$here"/} ;; *) shown=$build ;; esac
say "built. Now, in each terminal:"
say "  source $shown/devel/setup.bash"
say "and then, for example:"
say "  roslaunch gazebo_ros empty_world.launch"
