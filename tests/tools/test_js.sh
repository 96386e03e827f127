#!/bin/sh
# test_js.sh [page] - build the npm package and test it: golden rows, errors, progress and memory under node, types by tsc, samples under node,
# by Vite and in headless Chromium; the page, with files dropped and downloaded. page: build the page and test nothing. Called by `make test-js`, after `make js`.
# What npm fetches (typescript, vite, esbuild, three, puppeteer-core) lies in $BUILD/js/tools. Ends with "N passed, N failed[, N skipped]";
# status 77 when there is nothing to build with.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}" "${MAKE_COMMAND:=make}"
. tests/tools/counting.sh
command -v node >/dev/null 2>&1 || { skip js "node is missing (Debian: nodejs; make deps-js)"; finish; exit 77; }
command -v "${EMCC:-emcc}" >/dev/null 2>&1 || { skip js "emcc is missing (Debian: emscripten; make deps-js)"; finish; exit 77; }

work=$(cd "$BUILD" && pwd)/js
BITVOX_JS=$work/package
NODE_TOOLS=$work/tools
export BITVOX_JS NODE_TOOLS

small() {
    for entry in bitvox scalar files labels makers; do
        size=$(gzip -9 -c "$BITVOX_JS/$entry.js" | wc -c)
        echo "$entry.js: $size bytes gzipped, at most 250000"
        [ "$size" -le 250000 ] || return 1
    done
}

# An engine without 128-bit instructions takes the scalar module alone: V8 on x86 has none where SSE 4.1 is switched off.
without_simd=--no-enable-sse4-1
node $without_simd --version >/dev/null 2>&1 || without_simd=
scalar_alone() {
    [ -n "$without_simd" ] || { echo "this node cannot switch 128-bit instructions off"; exit 77; }
    for entry in bitvox scalar; do
        node $without_simd -e "process.exit(WebAssembly.validate(require('fs').readFileSync('$work/$entry.wasm')) ? 0 : 3)"
        echo "$entry.wasm: status $?"
    done >"$work/simd.txt"
    cat "$work/simd.txt"
    grep -q 'scalar.wasm: status 0$' "$work/simd.txt" && grep -q 'bitvox.wasm: status 3$' "$work/simd.txt" || return 1
    node $without_simd --input-type=module -e "import { load } from '$BITVOX_JS/bitvox.js'; await load()" >"$work/refused.txt" 2>&1 && return 1
    grep -q "import 'bitvox/scalar'" "$work/refused.txt"
}

# The README's example, with the second entry of the package.
readme_scalar() {
    sed "s|'bitvox'|'bitvox/scalar'|" "$work/user/readme.mjs" >"$work/user/readme_scalar.mjs"
    (cd "$work/user" && node $without_simd readme_scalar.mjs) | diff - "$work/readme.txt"
}

# The folder that users get by npm install.
installed() {
    rm -rf "$work/user" && mkdir -p "$work/user" || return 1
    (cd "$work/user" && npm pack --silent "$BITVOX_JS" && tar -xzf bitvox-*.tgz && mkdir -p node_modules && mv package node_modules/bitvox) || return 1
    ls "$work/user/node_modules/bitvox"
    [ "$(ls "$work/user/node_modules/bitvox" | tr '\n' ' ')" = 'LICENSE README.md bitvox.js files.d.ts files.js index.d.ts labels.d.ts labels.js makers.d.ts makers.js package.json scalar.js ' ]
}

# The first JavaScript of the README prints what its comments say.
readme() {
    awk '/^```js$/ { on = 1; next } /^```$/ { if (on) exit } on' bindings/js/README.md >"$work/user/readme.mjs"
    (cd "$work/user" && node readme.mjs) >"$work/readme.txt" || return 1
    sed -n 's|^console.log.*// ||p' "$work/user/readme.mjs" | diff - "$work/readme.txt"
}

sample_node() {
    cp bindings/js/samples/node.mjs "$work/user/"
    node "$work/user/node.mjs" fixtures/knot.ply "$work/knot.glb" | tee "$work/knot.txt"
    [ "$(head -c 4 "$work/knot.glb")" = glTF ] && [ "$(grep -c 'closed true, crossings 0' "$work/knot.txt")" = 4 ]
}

# The program says the same hashes of what it made of the same file.
as_program() {
    [ -n "${BITVOX:-}" ] || { echo "no program"; exit 77; }
    "$BITVOX" lod fixtures/knot.ply -o "$work/program.glb" >/dev/null && cmp "$work/knot.glb" "$work/program.glb"
}

tools() {
    [ -x "$NODE_TOOLS/node_modules/.bin/tsc" ] && [ -x "$NODE_TOOLS/node_modules/.bin/vite" ] && [ -d "$NODE_TOOLS/node_modules/three" ] &&
        [ -x "$NODE_TOOLS/node_modules/.bin/esbuild" ] && [ -d "$NODE_TOOLS/node_modules/puppeteer-core" ] && return
    mkdir -p "$NODE_TOOLS" && cp bindings/js/tests/package.json "$NODE_TOOLS/" || return 1
    (cd "$NODE_TOOLS" && npm install --no-audit --no-fund --ignore-scripts --no-package-lock) || { echo "npm cannot fetch typescript, vite, esbuild, three and puppeteer-core"; exit 77; }
}

needs_tool() { # NAME
    [ -e "$NODE_TOOLS/node_modules/$1" ] || { echo "$1 is missing (npm)"; exit 77; }
}

types() {
    needs_tool .bin/tsc
    rm -rf "$work/types" && cp -r bindings/js/tests/types "$work/types" && mkdir -p "$work/types/node_modules" || return 1
    cp -r "$BITVOX_JS" "$work/types/node_modules/bitvox"
    echo '{ "type": "module" }' >"$work/types/package.json"
    "$NODE_TOOLS/node_modules/.bin/tsc" -p "$work/types"
}

# Vite puts module and worker where it likes; the base is where the test serves it.
by_vite() {
    needs_tool .bin/vite
    rm -rf "$work/vite" "$work/site" && mkdir -p "$work/vite" "$work/site" || return 1
    cp bindings/js/samples/vite/* bindings/js/samples/worker.* "$work/vite/"
    mkdir -p "$work/vite/node_modules" && cp -r "$BITVOX_JS" "$work/vite/node_modules/bitvox"
    cp bindings/js/samples/module.html "$BITVOX_JS/bitvox.js" "$work/site/"
    (cd "$work/vite" && "$NODE_TOOLS/node_modules/.bin/vite" build --base /vite/ --outDir "$work/site/vite" --target esnext --logLevel warn)
}

in_browser() {
    needs_tool puppeteer-core
    command -v chromium >/dev/null 2>&1 || { echo "chromium is missing (make deps-js)"; exit 77; }
    node bindings/js/tests/browser.mjs "$work/site"
}

page() {
    needs_tool three
    node bindings/js/build_page.mjs "$BITVOX_JS" "$work/page"
}

if [ "${1:-}" = page ]; then
    (tools && page) || exit 1
    echo "$work/page: $(ls "$work/page" | tr '\n' ' ')"
    exit 0
fi

check 'js/size' small
check 'js/npm package' installed
count 'js/golden rows' node --test --test-reporter=tap bindings/js/tests/golden.test.mjs
count 'js/golden rows, scalar' env BITVOX_ENTRY=scalar.js node $without_simd --test --test-reporter=tap bindings/js/tests/golden.test.mjs
check 'js/scalar where there are no 128-bit instructions' scalar_alone
count 'js/calls' node --test --test-reporter=tap bindings/js/tests/api.test.mjs
check 'js/README' readme
check 'js/README, scalar' readme_scalar
check 'js/sample for node' sample_node
check 'js/the same file as the program' as_program
check 'js/tools from npm' tools
check 'js/types' types
check 'js/sample for Vite' by_vite
check 'js/samples in Chromium' in_browser
check 'js/page' page
if [ -f "$work/page/main.js" ] && [ -d "$NODE_TOOLS/node_modules/puppeteer-core" ] && [ -n "${BITVOX:-}" ] && command -v chromium >/dev/null 2>&1; then
    rm -rf "$work/page_site" && cp -r "$work/page" "$work/page_site"
    count 'js/page in Chromium' node bindings/js/tests/page.mjs "$work/page_site" "$BITVOX" fixtures/knot.ply "$work/page_files"
else
    skip 'js/page in Chromium' "the page, the program, puppeteer-core or chromium is missing"
fi
finish
