#!/usr/bin/env bash
# Builds the package's WebAssembly to pkg/. Installs wasm-bindgen of the version that the crate has where it is missing.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$here/../.."
target="${CARGO_TARGET_DIR:-$root/target}"

version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' "$root/Cargo.lock")
tools="$target/wasm-tools"
if [ "$("$tools/bin/wasm-bindgen" --version 2>/dev/null)" != "wasm-bindgen $version" ]; then
    cargo install --quiet --root "$tools" --version "$version" --target-dir "$target/wasm-tools-build" wasm-bindgen-cli
fi
command -v wasm-opt >/dev/null || apt-get install -y -qq --no-install-recommends binaryen >/dev/null

cd "$root"
RUSTFLAGS="-C target-feature=+simd128" CARGO_TARGET_DIR="$target" \
    "$here/cargo.sh" build --release --locked -p fieldtrace-web
"$tools/bin/wasm-bindgen" --target web --out-name fieldtrace --out-dir "$here/pkg" --remove-producers-section \
    "$target/wasm32-unknown-unknown/release/fieldtrace_web.wasm"
wasm-opt -O3 --enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int --enable-sign-ext --enable-mutable-globals --enable-reference-types --enable-multivalue \
    "$here/pkg/fieldtrace_bg.wasm" -o "$here/pkg/fieldtrace_bg.wasm"
