#!/bin/sh
# Checks that a library, shared or static, defines only global names that begin with wisp_.
#
#     test_exports.sh LIBWISP.SO|LIBWISP.A
set -eu

library=${1:?which library?}
case $library in
    *.a) dynamic= ;;
    *) dynamic=-D ;;
esac
names=$(nm $dynamic -g --defined-only "$library" | awk 'NF == 3 { print $3 }')

foreign=$(printf '%s\n' "$names" | grep -v '^wisp_' || true)
if [ -n "$foreign" ]; then
    echo "these names are visible and do not begin with wisp_:"
    printf '%s\n' "$foreign"
    exit 1
fi

# An empty list would pass the check above; every host needs these three.
for name in wisp_world_create wisp_world_step wisp_world_destroy; do
    if ! printf '%s\n' "$names" | grep -qx "$name"; then
        echo "$name is not visible"
        exit 1
    fi
done
echo "$(printf '%s\n' "$names" | wc -l) names, all of them begin with wisp_"
