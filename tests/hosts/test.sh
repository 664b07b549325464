#!/bin/sh
# Opens outputs in the programs that people use: tests/hosts/test.sh BINARY [PYTEST ARGUMENTS]
# Installs what is missing: Inkscape, LibreCAD and Poppler by apt, readers of Python in target/hosts.
set -eu
if [ $# -lt 1 ] || [ ! -x "$1" ]; then
    echo "usage: $0 BINARY [PYTEST ARGUMENTS], where BINARY is a built trace" >&2
    exit 2
fi
FIELDTRACE_BINARY=$(realpath "$1")
export FIELDTRACE_BINARY
shift
here=$(cd "$(dirname "$0")" && pwd)
venv=$here/../../target/hosts

missing=
for pair in inkscape:inkscape librecad:librecad pdftoppm:poppler-utils; do
    command -v "${pair%:*}" >/dev/null || missing="$missing ${pair#*:}"
done
python3 -c 'import ensurepip' 2>/dev/null || missing="$missing python3-venv"
if [ -n "$missing" ]; then
    apt-get update -qq
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
fi
if ! cmp -s "$here/requirements.txt" "$venv/requirements.txt"; then
    python3 -m venv --clear "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check -r "$here/requirements.txt"
    cp "$here/requirements.txt" "$venv/requirements.txt"
fi
exec "$venv/bin/python" -m pytest -p no:cacheprovider -q "$here" "$@"
