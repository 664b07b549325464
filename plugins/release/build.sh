#!/usr/bin/env bash
# Builds the archive of a release and prints its path: plugins/release/build.sh [TARGET]
#
# TARGET is a target of Rust, by default this machine's. Environment:
#   TRACE_BINARY, WHEEL   results that are built already
#   HOST_BINARY           a `trace` that runs here, where the one for TARGET does not
#   OUT                   folder of the archive, by default `release-archives` in the target folder
#   MATURIN, TAR          programs; TAR has to be GNU's
#   SOURCE_DATE_EPOCH     time of all files, by default that of the last commit
# The same inputs give the same bytes.
set -euo pipefail
export LC_ALL=C
umask 022
root="$(cd "$(dirname "$0")/../.." && pwd)"
target="${1:-$(rustc -vV | sed -n 's/^host: //p')}"
built="${CARGO_TARGET_DIR:-$root/target}"
SOURCE_DATE_EPOCH="${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct)}"
export SOURCE_DATE_EPOCH
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

case "$target" in *windows*) exe=.exe ;; *) exe= ;; esac

binary="${TRACE_BINARY:-}"
if [ -z "$binary" ]; then
    cargo build --manifest-path "$root/Cargo.toml" --release --locked --target "$target" --bin trace >&2
    binary="$built/$target/release/trace$exe"
fi

wheel="${WHEEL:-}"
if [ -z "$wheel" ]; then
    (cd "$root/plugins/python" &&
        "${MATURIN:-maturin}" build --release --locked --target "$target" --out "$work/wheel" >&2)
    wheel="$(echo "$work"/wheel/*.whl)"
fi

tool="${HOST_BINARY:-$binary}"
version="$("$tool" --version | cut -d ' ' -f 2)"
name="fieldtrace-$version-$target"
stage="$work/$name"

put() { # FOLDER FILE...
    mkdir -p "$stage/$1"
    install -m 644 "${@:2}" "$stage/$1"
}

completions() { # SHELL FILE
    mkdir -p "$stage/share/$(dirname "$2")"
    "$tool" completions "$1" >"$stage/share/$2"
}

put . "$root"/{README.md,CHANGELOG.md,LICENSE-MIT,LICENSE-APACHE}
put python "$wheel"
put inkscape "$root"/plugins/inkscape/{fieldtrace.inx,fieldtrace.py,README.md,picture.png}
mkdir -p "$stage/bin"
install -m 755 "$binary" "$stage/bin/trace$exe"
# One program has both names, and lies beside the extension for Inkscape too: links keep it in the archive once.
ln "$stage/bin/trace$exe" "$stage/bin/fieldtrace$exe"
ln "$stage/bin/trace$exe" "$stage/inkscape/trace$exe"

completions bash bash-completion/completions/trace
completions zsh zsh/site-functions/_trace
completions fish fish/vendor_completions.d/trace.fish
completions powershell powershell/trace.ps1
completions elvish elvish/lib/trace.elv
mkdir -p "$stage/share/man/man1"
"$tool" man >"$stage/share/man/man1/trace.1"
echo '.so man1/trace.1' >"$stage/share/man/man1/fieldtrace.1"

(cd "$stage" && find ./* -type f -exec sha256sum {} + | sed 's|  \./|  |' | sort -k 2 >"$work/sums" && mv "$work/sums" SHA256SUMS)

out="${OUT:-$built/release-archives}"
mkdir -p "$out"
out="$(cd "$out" && pwd)"
"${TAR:-tar}" -C "$work" --format=ustar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner \
    --mode='u=rwX,go=rX' -cf - "$name" | gzip -n -9 >"$out/$name.tar.gz"
(cd "$out" && sha256sum "$name.tar.gz" >"$name.tar.gz.sha256")
echo "$out/$name.tar.gz"
