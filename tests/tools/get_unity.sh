#!/bin/sh
# get_unity.sh [FOLDER]   (default build/unity)
# Fetch the Unity test framework (unity.c, unity.h, unity_internals.h) out of a Debian source package that carries it.
# Needs apt, gpgv and tar, no root; changes nothing in the system: apt works on lists of its own in a temporary folder.
# The archive's signature is checked by apt, the file's own sum here.
#
# Where apt is missing: put the three files of Unity 2.5.1 into the folder, or name their folder: make test UNITY_DIR=...
# UNITY_MIRROR is the Debian archive to take from (default: the one that apt uses).
set -eu

folder=${1:-build/unity}
package=ntpsec
suite=bookworm
sum=53e527e3d04d551d41af2d359c2715c2de5f5bfa2a695d4ec1a811b3e9137f63
files='unity.c unity.h unity_internals.h'
keys=/usr/share/keyrings/debian-archive-keyring.gpg

refuse() {
    echo "get_unity: $1" >&2
    echo "get_unity: put $files of Unity 2.5.1 into $folder, or name their folder by UNITY_DIR" >&2
    exit 1
}

complete=1
for f in $files; do [ -s "$folder/$f" ] || complete=0; done
[ $complete = 0 ] || exit 0

for tool in apt-get gpgv tar sha256sum; do
    command -v $tool >/dev/null 2>&1 || refuse "$tool is missing, so Unity cannot be fetched"
done
[ -r $keys ] || refuse "$keys is missing (package debian-archive-keyring), so Unity cannot be fetched"

mirror=${UNITY_MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Component: main' \
    'Origin: Debian' 2>/dev/null | grep -v -e security -e updates | head -n 1)}
[ -n "$mirror" ] || refuse "apt knows no Debian archive; set UNITY_MIRROR"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
mkdir -p "$work/state/lists/partial" "$work/cache/archives/partial" "$work/out"
echo "deb-src [signed-by=$keys] $mirror $suite main" >"$work/sources.list"
cat >"$work/apt.conf" <<CONF
Dir::Etc::SourceList "$work/sources.list";
Dir::Etc::SourceParts "-";
Dir::State "$work/state";
Dir::State::status "/dev/null";
Dir::Cache "$work/cache";
APT::Sandbox::User "$(id -un)";
Acquire::Languages "none";
Acquire::Retries "3";
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
CONF

apt-get -c "$work/apt.conf" -qq update || refuse "no list of source packages from $mirror"
(cd "$work" && apt-get -c "$work/apt.conf" -qq source --download-only $package) ||
    refuse "no source package $package from $mirror"

archive=
for f in "$work"/*.orig.tar.gz "$work"/*.orig.tar.xz "$work"/*.orig.tar.bz2; do
    if [ -f "$f" ]; then archive=$f; fi
done
[ -n "$archive" ] || refuse "the source package $package holds no original archive"
echo "$sum  $archive" | sha256sum -c - >/dev/null || refuse "$(basename "$archive") is not the archive that was expected"

tar -xf "$archive" -C "$work/out" --wildcards --no-anchored $files
mkdir -p "$folder"
for f in $files; do
    found=$(find "$work/out" -name "$f" | head -n 1)
    [ -n "$found" ] || refuse "$f is not in $(basename "$archive")"
    cp "$found" "$folder/$f"
done
awk '/define UNITY_VERSION_(MAJOR|MINOR|BUILD)/ { v = v (v == "" ? "" : ".") $3 } END { print "Unity " v }' "$folder/unity.h"
