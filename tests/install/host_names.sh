#!/bin/sh
# Prints a C file that defines a function under each internal name of the library, as a host might.
#
#     host_names.sh NM ARCHIVE
set -eu

names=$("$1" -g --defined-only "$2" | awk 'NF == 3 && $3 !~ /^wisp_/ && $3 ~ /^[A-Za-z_][A-Za-z0-9_]*$/ { print $3 }' | sort -u)
[ -n "$names" ] || { echo "$2: found no internal name" >&2; exit 1; }
echo '#include <stdlib.h>'
for name in $names; do
    echo "void $name( void ); void $name( void ) { abort(); }"
done
