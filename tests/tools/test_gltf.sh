#!/bin/sh
# test_gltf.sh FOLDER - files of the tests in FOLDER and of the program through Khronos' validator of glTF: no error and no warning. npm fetches
# it into $BUILD/gltf; status 77 when it cannot be had.
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:=build}"
folder=$1
work=$BUILD/gltf
command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 || { echo "node or npm is missing (make deps-js)"; exit 77; }
mkdir -p "$work/files"
if [ ! -d "$work/node_modules/gltf-validator" ]; then
    echo '{ "private": true }' >"$work/package.json"
    (cd "$work" && npm install --no-audit --no-fund --ignore-scripts --no-package-lock --fetch-retries=1 --fetch-timeout=20000 gltf-validator@2.0.0-dev.3.10) ||
        { echo "npm cannot fetch gltf-validator"; exit 77; }
fi

rm -f "$work/files"/*.glb
for test in write_attributes write_kept; do GLB_FILES=$work/files "$folder/tests/unit/test_$test" || exit 1; done
for how in --normals --quantize --up=y; do
    "$BITVOX" convert fixtures/knot.ply -o "$work/files/knot$how.glb" --input-up z $how >/dev/null || exit 1
done
"$BITVOX" lod fixtures/knot.ply -o "$work/files/levels.glb" >/dev/null || exit 1
"$BITVOX" lod fixtures/knot.ply -o "$work/files/small_levels.glb" --quantize >/dev/null || exit 1

cat >"$work/validate.cjs" <<'END'
const fs = require('fs');
const { validateBytes } = require('gltf-validator');

(async () => {
    const files = fs.readdirSync('files');
    let wrong = 0;
    for (const file of files) {
        const { issues } = await validateBytes(new Uint8Array(fs.readFileSync(`files/${file}`)));
        wrong += issues.numErrors + issues.numWarnings > 0;
        for (const { severity, message, pointer } of issues.messages) if (severity < 2) console.log(`${file}: ${pointer}: ${message}`);
    }
    console.log(`${files.length} files, ${wrong} of them not valid`);
    process.exit(files.length > 100 && wrong === 0 ? 0 : 1);
})();
END
cd "$work" && node validate.cjs
