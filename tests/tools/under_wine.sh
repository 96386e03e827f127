#!/bin/sh
# under_wine.sh PROGRAM ARGUMENTS... - run a program for Windows under wine. On a busy machine wine now and then ends with status 1 before
# the program's first instruction, and says nothing. The program itself says why whenever it fails; so a failure without a word is wine's,
# and the program is started once more. PROGRAM.again gets a line for each such start.
words=$(mktemp) || exit 1
trap 'rm -f "$words"' EXIT
wine "$@" 2>"$words"
status=$?
if [ $status = 1 ] && [ ! -s "$words" ]; then
    echo "$*" >>"$1.again"
    wine "$@" 2>"$words"
    status=$?
fi
cat "$words" >&2
exit $status
