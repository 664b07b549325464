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

cd "$root"
# Optimising across crates is what makes the file small.
export CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 CARGO_PROFILE_RELEASE_PANIC=abort \
    CARGO_PROFILE_RELEASE_STRIP=true CARGO_TARGET_DIR="$target" RUSTFLAGS="-C target-feature=+simd128"
"$here/cargo.sh" build --release --locked -p fieldtrace-web
"$tools/bin/wasm-bindgen" --target web --out-name fieldtrace --out-dir "$here/pkg" --remove-producers-section --remove-name-section \
    "$target/wasm32-unknown-unknown/release/fieldtrace_web.wasm"
