#!/bin/sh
# logged.sh LOG SECONDS COMMAND... - run a command within a limit; its output goes to LOG, its exit status and its seconds of processor
# time to LOG.end. For programs that run beside each other: whoever started them counts their logs afterwards.
log=$1
shift
sh tests/tools/limited.sh "$@" >"$log" 2>&1 </dev/null
status=$?
times >"$log.times" # of all that this shell has run; in a pipe it would be those of another shell
echo "$status $(awk 'NR == 2 { split($0, t, /[ms ]+/); printf "%d", t[1] * 60 + t[2] + t[3] * 60 + t[4] }' "$log.times")" >"$log.end"
rm -f "$log.times"
