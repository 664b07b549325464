#!/usr/bin/env bash
# Runs cargo for WebAssembly: plugins/web/cargo.sh check --lib --no-default-features
#
# Where the toolchain has no standard library for the target and rustup cannot get it, the library is built from its sources,
# which Debian's backports have for the same compiler.
set -euo pipefail
triple=wasm32-unknown-unknown
sysroot=$(rustc --print sysroot)

# Writes the sources of the standard library where cargo looks for them.
sources() {
    local version place
    version=$(rustc --version | cut -d' ' -f2)
    place=$sysroot/lib/rustlib/src/rust
    [ -e "$place/library/std/Cargo.toml" ] && return
    local work
    work=$(mktemp -d)
    mkdir -p "$work/lists/partial" "$work/cache/archives/partial"
    echo "deb [trusted=yes] http://deb.debian.org/debian trixie-backports main" >"$work/sources.list"
    local apt=(-o "Dir::Etc::sourcelist=$work/sources.list" -o "Dir::Etc::sourceparts=-" -o "Dir::State::lists=$work/lists"
        -o "Dir::Cache=$work/cache")
    apt-get "${apt[@]}" update -qq
    local package
    package=$(apt-cache "${apt[@]}" madison rust-src | awk -v v="$version" 'index($3, v "+") == 1 { print $3; exit }')
    [ -n "$package" ] || { echo "no sources of the standard library of Rust $version were found" >&2; exit 1; }
    (cd "$work" && apt-get "${apt[@]}" download -qq "rust-src=$package" && dpkg -x rust-src_*.deb unpacked)
    mkdir -p "$(dirname "$place")"
    rm -rf "$place"
    mv "$work/unpacked/usr/src/rustc-$version" "$place"
    rm -rf "$work"
}

command=$1
shift
std=()
if [ ! -d "$sysroot/lib/rustlib/$triple" ] && ! timeout 120 rustup -q target add $triple >/dev/null 2>&1; then
    sources
    export RUSTC_BOOTSTRAP=1
    std=(-Z build-std=std,panic_abort)
fi
exec cargo "$command" --target $triple "${std[@]}" "$@"
