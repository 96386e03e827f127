#!/bin/sh
# list_symbols.sh LIBRARY.so - names that a shared library exports, sorted.
set -eu
nm -D --defined-only "$1" | awk 'NF >= 2 { print $NF }' | LC_ALL=C sort
