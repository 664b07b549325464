#!/usr/bin/env bash
# Installs the plugin and fieldtrace in an environment of their own, and tests what was installed.
#
# WHEEL names a wheel of fieldtrace that is built already; without it, ../python is built. VPYPE is the version of vpype, such
# as 1.14.0, in place of the latest. Arguments go to pytest. CARGO_TARGET_DIR is respected; the environment lies in the target
# folder and is made anew only where it is missing.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
target="${CARGO_TARGET_DIR:-$here/../../target}"
mkdir -p "$target"
environment="$(cd "$target" && pwd)/vpype-test${VPYPE:+-$VPYPE}"
python="${PYTHON:-python3}"

[ -x "$environment/bin/pip" ] || "$python" -m venv --clear "$environment"
pip() { "$environment/bin/pip" --quiet --disable-pip-version-check "$@"; }
pip install "vpype${VPYPE:+==$VPYPE}" pytest pillow
pip install --force-reinstall --no-deps "${WHEEL:-$here/../python}" "$here"
pip check

# From elsewhere, so that the installed package is found and not the sources beside it.
cd "$environment"
exec env -u PYTHONPATH "$environment/bin/python" -m pytest "$here/tests" -c "$here/pyproject.toml" --rootdir "$here" \
    -p no:cacheprovider "$@"
