#!/bin/sh
# Joins the engine into one object, and each module into one, whose only global names are the public ones, and archives these objects.
# A host links the modules that it names, and may have a function of its own under every other name.
#
#     public_archive.sh OBJCOPY AR ARCHIVE LINKER... -- ENGINE_LIBRARY... -- MODULE_LIBRARY...
set -eu

objcopy=$1 ar=$2 archive=$3
shift 3
linker=
while [ "$1" != -- ]; do
    linker="$linker $1"
    shift
done
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# join NAME LIBRARY...
join()
{
    name=$1
    shift
    $linker -r -nostdlib -o "$folder/joined.o" -Wl,--whole-archive "$@" -Wl,--no-whole-archive
    "$objcopy" --wildcard '--keep-global-symbol=wisp_*' "$folder/joined.o" "$folder/$name.o"
    rm "$folder/joined.o"
}

engine=
while [ "$1" != -- ]; do
    engine="$engine $1"
    shift
done
shift
join wisp_engine $engine
for library in "$@"; do
    join "$(basename "$library" .a | sed 's/^lib//')" "$library"
done
rm -f "$archive"
"$ar" rcs "$archive" "$folder"/*.o
