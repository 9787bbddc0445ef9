#!/bin/sh
# Sets up what is missing: a virtual environment with Cartwheel in it, and Debian's packages
# that pip cannot bring. Usage: tools/setup.sh run|test|lint
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
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null 2>&1 || {
        # The package lists may be missing or old.
        $as_root apt-get update -qq >/dev/null 2>&1 || true
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null
    }
}

has_library() { (ldconfig -p 2>/dev/null || /sbin/ldconfig -p) | grep -q "$1"; }
has_driver() { ls /usr/lib/*/dri/*swrast* >/dev/null 2>&1 || ls /usr/lib/*/libgallium* >/dev/null 2>&1; }

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
    # The program that drives the browser needs it, and slim images lack it.
    has_library libatomic.so.1 || wanted="$wanted libatomic1"
    [ "$wanted" = "$before" ] || loss="Going on without: tests of cameras or the browser may fail or be skipped."
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
if [ "$purpose" = run ] && [ ! -e "$stamp" ]; then
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
