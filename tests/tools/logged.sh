#!/bin/sh
# logged.sh LOG SECONDS COMMAND... - run a command within a limit; its output goes to LOG, its exit status and its seconds to LOG.end.
# For programs that run beside each other: whoever started them counts their logs afterwards.
log=$1
shift
start=$(date +%s)
sh tests/tools/limited.sh "$@" >"$log" 2>&1 </dev/null
echo "$? $(($(date +%s) - start))" >"$log.end"
