#!/bin/sh
# limited.sh SECONDS COMMAND... - run a command that may take so many seconds of processor time, and ten times as many by the clock:
# a busy machine must not fail a test, and no test may hang for ever.
seconds=$1
shift
ulimit -t "$seconds" 2>/dev/null
if command -v timeout >/dev/null 2>&1; then exec timeout $((10 * seconds)) "$@"; fi
exec "$@"
