#!/usr/bin/env bash
# Tries what is in an archive of a release, on a machine of its platform: plugins/release/test.sh ARCHIVE
#
# Samples come from the checkout, all else from the archive, which is unpacked in an empty folder. Needs Python, whose pip
# fetches NumPy. What cannot be tried for want of a shell or of `man` is said to be skipped.
set -euo pipefail
export LC_ALL=C
[ $# -eq 1 ] || { echo "usage: $0 ARCHIVE" >&2; exit 2; }
samples="$(cd "$(dirname "$0")/../../samples" && pwd)"
archive="$(cd "$(dirname "$1")" && pwd)/$(basename "$1")"
name="$(basename "$archive" .tar.gz)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $*" >&2; exit 1; }
has() { command -v "$1" >/dev/null || { echo "skipped: there is no $1"; return 1; }; }

# The archive is one folder, of nobody's files, and holds what it says.
tar -tzf "$archive" >names
if grep -v "^$name/" names; then fail "these lie beside the folder"; fi
if tar --numeric-owner -tvzf "$archive" | grep -v ' 0/0 '; then fail "these have an owner"; fi
tar -xzf "$archive"
cd "$name"
sha256sum --quiet -c SHA256SUMS
[ "$(find . -type f ! -name SHA256SUMS | wc -l)" -eq "$(wc -l <SHA256SUMS)" ] || fail "SHA256SUMS leaves files out"
for file in README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE; do
    [ -s "$file" ] || fail "$file is missing"
done
echo "archive: $(wc -l <SHA256SUMS) files"

# The program needs nothing of its environment.
version="$(bin/trace --version | cut -d ' ' -f 2)"
case "$name" in "fieldtrace-$version-"*) ;; *) fail "the program is of version $version" ;; esac
for program in bin/trace bin/fieldtrace inkscape/trace; do
    env -i "./$program" "$samples/kettle.png" --quiet -o "$work/$(dirname "$program")-$(basename "$program").svg"
done
strokes="$(grep -o 'stroke-width' "$work/bin-trace.svg" | wc -l)"
[ "$strokes" -ge 10 ] || fail "the kettle has $strokes strokes"
cmp "$work/bin-trace.svg" "$work/bin-fieldtrace.svg"
cmp "$work/bin-trace.svg" "$work/inkscape-trace.svg"
echo "program: version $version, a kettle of $strokes strokes"

# Completions are read by their shells without a word, and know an option.
bash --norc -c '. share/bash-completion/completions/trace && complete -p trace' >/dev/null
bash --norc -c '. share/bash-completion/completions/trace; COMP_WORDS=(trace --pres); COMP_CWORD=1; _trace trace --pres trace
    [ "${COMPREPLY[*]}" = --preset ]' || fail "bash completes no --preset"
if has zsh; then zsh -n share/zsh/site-functions/_trace; fi
if has fish; then fish -n share/fish/vendor_completions.d/trace.fish; fi
if has pwsh; then pwsh -NoProfile -Command '. share/powershell/trace.ps1'; fi
for file in share/powershell/trace.ps1 share/elvish/lib/trace.elv; do
    grep -q -- --preset "$file" || fail "$file knows no --preset"
done
echo "completions: read"

# The manual page, under both names.
if has man; then
    for page in trace fieldtrace; do
        MANPATH="$PWD/share/man" man --warnings -P cat "$page" >"$work/page" 2>"$work/warnings"
        grep -q 'trace - Turn a raster line drawing' <(tr -s ' ' <"$work/page") || fail "man $page is no page"
        [ ! -s "$work/warnings" ] || fail "man $page: $(cat "$work/warnings")"
    done
    echo "manual page: $(wc -l <"$work/page") lines"
fi

# The wheel, in an environment of its own.
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python/*.whl
(cd "$work" && venv/bin/python - "$samples/kettle.png" "$version" <<'END'
import sys
import fieldtrace
drawing = fieldtrace.trace(sys.argv[1])
assert len(drawing) >= 10, len(drawing)
assert fieldtrace.__version__ == sys.argv[2], fieldtrace.__version__
print(f"wheel: version {fieldtrace.__version__}, a kettle of {len(drawing)} strokes")
END
)
"$work/venv/bin/fieldtrace" --version >/dev/null

# The extension: Inkscape reads the .inx, which names the Python file.
python3 - <<'END'
import ast
import xml.etree.ElementTree as tree
root = tree.parse("inkscape/fieldtrace.inx").getroot()
command = root.find("{*}script/{*}command")
assert command.get("interpreter") == "python" and command.text == "fieldtrace.py", command.text
ast.parse(open(f"inkscape/{command.text}", encoding="utf-8").read())
print(f"extension: {root.find('{*}name').text}")
END
echo "all of $name works"
