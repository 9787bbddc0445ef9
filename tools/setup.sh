#!/bin/sh
# Sets up what is missing: a virtual environment with Cartwheel in it, and Debian's packages
# that pip cannot bring. Usage: tools/setup.sh run|test|lint
set -eu
cd "$(dirname "$0")/.."
purpose=${1:-run}
python=${PYTHON:-python3}
venv=${VENV:-.venv}

say() { printf '%s\n' "$*" >&2; }

# Asks apt for the packages of which a probe says that they are missing.
install() {
    if ! command -v apt-get >/dev/null 2>&1; then
        say "missing: $* (by their Debian names). Install them with your system's package manager."
        return 1
    fi
    if [ "$(id -u)" = 0 ]; then as_root=""
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then as_root="sudo"
    else
        say "missing: $*"
        say "Not allowed to install here. Run: sudo apt-get install --no-install-recommends $*"
        return 1
    fi
    say "installing: $*"
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null 2>&1 || {
        $as_root apt-get update -qq
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null
    }
}

has_library() { ldconfig -p 2>/dev/null | grep -q "$1" || /sbin/ldconfig -p 2>/dev/null | grep -q "$1"; }

command -v "$python" >/dev/null 2>&1 || install python3 python3-venv
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    say "Cartwheel needs Python 3.11 or newer; $python is $("$python" --version). Set PYTHON=/path/to/python3.11."
    exit 1
}
"$python" -c 'import ensurepip, venv' 2>/dev/null || install python3-venv

# Cameras need OpenGL; all else works without, so a refusal here is no end.
has_library libEGL.so.1 && has_library libEGL_mesa.so.0 && ls /usr/lib/*/dri/*swrast* >/dev/null 2>&1 ||
    install libegl1 libegl-mesa0 libgl1-mesa-dri libgl1 || say "Going on without cameras."

extras=""
if [ "$purpose" = test ]; then
    extras="[test,lint]"
    command -v chromium >/dev/null 2>&1 || install chromium || say "The browser tests will be skipped."
elif [ "$purpose" = lint ]; then
    extras="[test,lint]"
fi

stamp="$venv/.ready-$purpose"
if [ ! -e "$stamp" ] || [ pyproject.toml -nt "$stamp" ]; then
    [ -x "$venv/bin/python" ] || "$python" -m venv "$venv"
    say "installing Cartwheel${extras:+ with its tools} into $venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -e ".$extras"
    touch "$stamp"
fi
