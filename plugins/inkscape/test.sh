#!/bin/sh
# Tests the Inkscape extension: plugins/inkscape/test.sh BINARY [PYTEST ARGUMENTS]
# Installs what is missing: Inkscape, its Python packages and a display by apt, inkex and pytest in target/inkscape.
set -eu
if [ $# -lt 1 ] || [ ! -x "$1" ]; then
    echo "usage: $0 BINARY [PYTEST ARGUMENTS], where BINARY is a built trace" >&2
    exit 2
fi
FIELDTRACE_BINARY=$(realpath "$1")
export FIELDTRACE_BINARY
shift
here=$(cd "$(dirname "$0")" && pwd)
venv=$here/../../target/inkscape

missing=
for pair in inkscape:inkscape Xvfb:xvfb xdotool:xdotool; do
    command -v "${pair%:*}" >/dev/null || missing="$missing ${pair#*:}"
done
# Inkscape runs extensions by Debian's Python, of which it only recommends the packages.
/usr/bin/python3 -c 'import lxml, numpy, cssselect' 2>/dev/null ||
    missing="$missing python3-lxml python3-numpy python3-cssselect"
python3 -c 'import ensurepip' 2>/dev/null || missing="$missing python3-venv"
if [ -n "$missing" ]; then
    apt-get update -qq
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
fi
if ! cmp -s "$here/tests/requirements.txt" "$venv/requirements.txt"; then
    python3 -m venv --clear "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check -r "$here/tests/requirements.txt"
    # inkex asks for PyGObject, which needs a compiler, for windows of its own that are not opened here.
    "$venv/bin/pip" install -q --disable-pip-version-check --no-deps inkex==1.4.1
    cp "$here/tests/requirements.txt" "$venv/requirements.txt"
fi
exec "$venv/bin/python" -m pytest -p no:cacheprovider -q -n 2 "$here/tests" "$@"
