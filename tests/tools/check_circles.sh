#!/bin/sh
# check_circles.sh - no circle of files in the program: who calls whom is read from src/cli_*/*.c, where a name that begins with cli_
# belongs to the file that defines it at the start of a line.
set -eu
cd "$(dirname "$0")/../.."
LC_ALL=C
export LC_ALL

# Text without comments and strings, each line with its file.
for f in src/cli_*/*.c; do
    sed -e 's/\\"//g' -e 's/"[^"]*"/""/g' -e 's|/\*.*\*/||g' "$f" | awk -v f="$f" '
        /\/\*/ { sub(/\/\*.*/, ""); print f "\t" $0; inside = 1; next }
        inside { if (!/\*\//) next; sub(/.*\*\//, ""); inside = 0 }
        { print f "\t" $0 }'
done | awk -F '\t' '
    { line[NR] = $2; file[NR] = $1 }
    $2 ~ /^[a-z][a-z_0-9 *]*[ *]cli_[a-z_0-9]+(\(|\[\]| =)/ && $2 !~ /^static / && $2 !~ /;$/ || $2 ~ /^[a-z][a-z_0-9 *]*[ *]cli_[a-z_0-9]+(\[\]| =)/ && $2 !~ /^static / {
        text = $2
        sub(/(\(|\[\]| =).*/, "", text)
        sub(/.*[ *]/, "", text)
        if (text in home && home[text] != $1) { print text " is defined in " home[text] " and in " $1; bad = 1 }
        home[text] = $1
    }
    function visit(f,    g, n, i, list) { # 1: being visited, 2: done
        state[f] = 1
        path[++depth] = f
        n = split(next_of[f], list, " ")
        for (i = 1; i <= n; i++) {
            g = list[i]
            if (state[g] == 1) { circle(g); bad = 1 }
            else if (state[g] == 0) visit(g)
        }
        state[f] = 2
        depth--
    }
    function circle(g,    i, text) {
        for (i = depth; path[i] != g; i--) text = " -> " path[i] " (" by[path[i - 1], path[i]] ")" text
        print "error: circle of files: " g text " -> " g " (" by[path[depth], g] ")"
    }
    END {
        for (i = 1; i <= NR; i++) {
            text = line[i]
            while (match(text, /cli_[a-z_0-9]+/)) {
                name = substr(text, RSTART, RLENGTH)
                text = substr(text, RSTART + RLENGTH)
                if (!(name in home) || home[name] == file[i] || (file[i], home[name]) in by) continue
                by[file[i], home[name]] = name
                next_of[file[i]] = next_of[file[i]] " " home[name]
                arrows++
            }
            files[file[i]] = 1
        }
        for (f in files) if (state[f] == 0) visit(f)
        if (arrows < 100) { print "error: only " arrows + 0 " arrows between files were found: the sources are not read"; bad = 1 }
        exit bad
    }'
