#!/bin/bash
# Makes npm/dist/, the content of the npm package, from the binding and its WebAssembly module (`make studio` builds both).
set -eu -o pipefail
cd "$(dirname "$0")"
tools=../studio/node_modules/.bin
rm -rf dist
"$tools/tsc" --project tsconfig.json
"$tools/vite" build --config vite.config.ts --logLevel warn
cp ../studio/built/midair.wasm dist/
cp ../LICENSE .
