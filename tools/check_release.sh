#!/bin/sh
# Builds the wheel and the sdist, installs each in an empty environment and simulates the cart.
# Usage: tools/check_release.sh [vVERSION]
# With a tag it also checks that the tag names the version, and that the changelog has its date.
set -eu
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
bin=${VENV:-.venv}/bin
tag=${1:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

version=$("$bin/python" -m hatchling version)
if [ -n "$tag" ]; then
    [ "$tag" = "v$version" ] || {
        echo "error: the tag is $tag, but cartwheel.__version__ is $version" >&2
        exit 1
    }
    grep -Eq "^## $version - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md || {
        echo "error: CHANGELOG.md has no heading \"## $version - YYYY-MM-DD\"" >&2
        exit 1
    }
fi

rm -rf dist
"$bin/python" -m hatchling build >/dev/null
wheel="$PWD/dist/cartwheel-$version-py3-none-any.whl"
sdist="$PWD/dist/cartwheel-$version.tar.gz"

# In a folder of its own, so that the checkout cannot be imported.
try() {
    "$python" -m venv "$folder/$1"
    "$folder/$1/bin/python" -m pip install --quiet --disable-pip-version-check "$2"
    mkdir "$folder/$1/empty"
    (
        cd "$folder/$1/empty"
        unset PYTHONPATH
        [ "$("$folder/$1/bin/cartwheel" --version)" = "cartwheel $version" ]
        "$folder/$1/bin/cartwheel" run --headless --speed max --for 5
    )
    echo "$1: $(basename "$2") works"
}
try wheel "$wheel"
try sdist "$sdist"
ls -l dist
