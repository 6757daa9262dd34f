#!/bin/sh
# Runs hosts that were built and linked in different ways: all must print the same line.
#
#     test_hosts.sh HOST...
set -eu

expected=$("$1")
case $expected in
    "wisp "*", hash "*) ;;
    *) echo "$1 prints '$expected', expected a version and a hash"; exit 1 ;;
esac
for host in "$@"; do
    printed=$("$host") || { echo "$host ends with $?: $printed"; exit 1; }
    [ "$printed" = "$expected" ] || { echo "$host prints '$printed', expected '$expected'"; exit 1; }
done
echo "$# hosts: $expected"
