#!/usr/bin/env bash
# Tests the package in Node and the page in Chromium: plugins/web/test.sh BINARY
# Installs what is missing: the packages that the tests use by npm, Chromium by apt. Builds pkg/ only where it is missing.
set -euo pipefail
if [ $# -ne 1 ] || [ ! -x "$1" ]; then
    echo "usage: $0 BINARY, where BINARY is a built trace" >&2
    exit 2
fi
TRACE="$(realpath "$1")"
export TRACE
cd "$(dirname "$0")"

apt_install() {
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

command -v npm >/dev/null || apt_install nodejs npm
command -v "${CHROMIUM:-chromium}" >/dev/null || apt_install chromium
CHROMIUM="$(command -v "${CHROMIUM:-chromium}")"
export CHROMIUM
cmp -s package-lock.json node_modules/package-lock.json || {
    npm ci --silent --no-audit --no-fund
    cp package-lock.json node_modules/package-lock.json
}
[ -f pkg/fieldtrace_bg.wasm ] || ./build.sh
page/assemble.sh

node_modules/.bin/tsc --noEmit --strict --target es2022 --module nodenext --lib es2023,dom tests/types.ts
# One file at a time, since each keeps all cores busy.
exec node --test --test-concurrency=1 --test-timeout=900000 --test-reporter=spec tests/*.test.js
