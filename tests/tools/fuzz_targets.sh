# fuzz_targets.sh - read in by the scripts that fuzz: the targets that a source stands for, one for each format of a reader, else one.
fuzz_targets() { # SOURCE
    if grep -q '"fuzz_files.h"' "$1"; then
        grep -o '{"[a-z_]*", BVX_FORMAT_[A-Z]*}' "$1" | cut -d '"' -f 2
    else
        basename "$1" .c | sed 's/^fuzz_//'
    fi
}
