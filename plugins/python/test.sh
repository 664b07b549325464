#!/usr/bin/env bash
# Builds the wheel, installs it in an environment of its own, and tests what was installed.
#
# Arguments go to pytest. CARGO_TARGET_DIR and the CARGO_PROFILE_RELEASE_* variables are respected; the environment lies in
# the target folder and is made anew only where it is missing.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
target="${CARGO_TARGET_DIR:-$here/../../target}"
mkdir -p "$target"
environment="$(cd "$target" && pwd)/python-test"
python="${PYTHON:-python3}"

[ -x "$environment/bin/pip" ] || "$python" -m venv --clear "$environment"
"$environment/bin/pip" install --quiet --disable-pip-version-check \
    maturin numpy pillow opencv-python-headless pytest svgelements

wheels="$environment/wheels"
rm -rf "$wheels"
(cd "$here" && "$environment/bin/maturin" build --release --locked --quiet --out "$wheels")
"$environment/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps "$wheels"/*.whl

# From elsewhere, so that the installed package is found and not the sources beside it.
cd "$environment"
exec env -u PYTHONPATH "$environment/bin/python" -m pytest "$here/tests" -c "$here/pyproject.toml" --rootdir "$here" \
    -p no:cacheprovider "$@"
