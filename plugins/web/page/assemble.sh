#!/usr/bin/env bash
# Puts the page together: site/ is what a web server serves.
set -euo pipefail
web="$(cd "$(dirname "$0")/.." && pwd)"
site="$web/site"

rm -rf "$site"
mkdir -p "$site/pkg" "$site/samples"
cp "$web"/page/*.{html,css,js,svg} "$site"
cp -r "$web/js" "$site"
cp "$web"/pkg/fieldtrace.js "$web"/pkg/fieldtrace_bg.wasm "$site/pkg"
cp "$web"/../../samples/{kettle.png,plan.png,boat.png,leaf.jpg} "$site/samples"
rm "$site"/js/{index.d.ts,node.js,node-worker.js}
sed -i 's#"\.\./js/#"./js/#' "$site"/*.js

cd "$site"
files=$(find . -type f ! -name sw.js | LC_ALL=C sort)
# shellcheck disable=SC2086
version=$(cat $files sw.js | sha256sum | cut -c1-16)
sed -i -e "s#@VERSION@#$version#" -e "s#@FILES@#./ $(echo $files)#" sw.js
