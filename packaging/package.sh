# Debian packages: `./dev package` reads this file. They are built in a clean system of Debian 12, installed in a second one and tried there.
# shellcheck shell=bash disable=SC2154 # functions and variables of dev

package_folder=build-package
packages_package='
mmdebstrap     | cmd mmdebstrap           | makes clean systems of Debian
git            | cmd git                  | lists the files of the sources
'

# package_system NAME : unpack a clean system into build-package/NAME
package_system()
{
    local root="$here/$package_folder/$1" tar="$here/$package_folder/bookworm.tar"
    package_unmount "$1"
    as_root rm -rf --one-file-system "$root"
    if [ ! -f "$tar" ]; then
        say "downloading a clean system of Debian 12"
        as_root mmdebstrap --quiet --format=tar --variant=minbase --include=ca-certificates bookworm "$tar.part" "${WISP_DEBIAN_MIRROR:-http://deb.debian.org/debian}"
        as_root mv "$tar.part" "$tar"
    fi
    mkdir -p "$root"
    as_root tar -C "$root" -xf "$tar" --exclude './dev/*'
    as_root cp /etc/resolv.conf "$root/etc/resolv.conf"
    as_root mount --bind /dev "$root/dev"
    as_root mount -t proc proc "$root/proc"
}

package_unmount()
{
    local root="$here/$package_folder/$1" place
    for place in dev proc; do
        if mountpoint -q "$root/$place" 2>/dev/null; then as_root umount "$root/$place"; fi
    done
}

# package_in NAME COMMAND... : run a command in a clean system
package_in()
{
    local root="$here/$package_folder/$1"
    shift
    as_root chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        SOURCE_DATE_EPOCH="$package_epoch" DEB_BUILD_OPTIONS="${JOBS:+parallel=$JOBS}" "$@" </dev/null
}

# package_sources FOLDER : the files of the tree as a source package
package_sources()
{
    local version soversion file
    version=$(sed -n "s/^  version : '\(.*\)',$/\1/p" "$here/meson.build")
    soversion=${version%.*}
    [ "${version%%.*}" = 0 ] || soversion=${version%%.*}
    rm -rf "$1"
    mkdir -p "$1"
    git -C "$here" ls-files -z | (cd "$here" && xargs -0 ls -d 2>/dev/null || true) | tar -C "$here" --files-from=- -c | tar -C "$1" -x
    cp -r "$here/packaging/debian" "$1/debian"
    sed "s/@SOVERSION@/$soversion/g" "$here/packaging/debian/control.in" >"$1/debian/control"
    mv "$1/debian/libwisp.install" "$1/debian/libwisp$soversion.install"
    printf 'wisp (%s) bookworm; urgency=medium\n\n  * See CHANGES.md.\n\n -- The Wisp authors <wisp@localhost>  %s\n' \
        "$version" "$(date -R -u -d "@$package_epoch")" >"$1/debian/changelog"
    rm "$1/debian/control.in" "$1/debian/try.sh"
    find "$1" -exec touch -h -d "@$package_epoch" {} +
}

# package_build NAME PLACE : build the packages at PLACE of a clean system, and print the folder that has them
package_build()
{
    local root="$here/$package_folder/$1"
    package_system "$1"
    package_sources "$here/$package_folder/sources"
    as_root mkdir -p "$root$2"
    as_root cp -a "$here/$package_folder/sources" "$root$2/wisp"
    rm -rf "$here/$package_folder/sources"
    package_in "$1" apt-get -q update
    package_in "$1" apt-get -q -y --no-install-recommends install build-essential
    package_in "$1" sh -c "cd $2/wisp && apt-get -q -y --no-install-recommends build-dep ./"
    package_in "$1" sh -c "cd $2/wisp && dpkg-buildpackage -us -uc -b"
    package_unmount "$1"
}

package_try()
{
    local root="$here/$package_folder/try"
    package_system try
    as_root mkdir -p "$root/debs"
    as_root cp "$here/$package_folder"/debs/*.deb "$here/packaging/debian/try.sh" "$root/debs/"
    package_in try apt-get -q update
    package_in try sh -c 'apt-get -q -y --no-install-recommends install /debs/*.deb gcc g++ libc6-dev make cmake pkgconf'
    package_in try bash /debs/try.sh
    package_unmount try
}

command_package()
{
    case ${1:-} in
        '' | --twice) ;;
        *) say "package takes --twice or nothing, got '$1'" >&2 && exit 64 ;;
    esac
    need "$packages_package"
    package_epoch=$(git -C "$here" log -1 --format=%ct)
    mkdir -p "$here/$package_folder/debs"
    # Two runs would share their folders.
    exec 9>"$here/$package_folder/lock"
    flock -n 9 || fail "another ./dev package is running"
    trap 'for system in build again try; do package_unmount "$system" || :; done' EXIT
    package_build build /build
    rm -f "$here/$package_folder"/debs/*
    cp "$here/$package_folder"/build/build/*.deb "$here/$package_folder/debs/"
    if [ "${1:-}" = --twice ]; then
        # In another place: what the packages hold must not depend on it.
        package_build again /another/place
        local deb
        for deb in "$here/$package_folder"/debs/*.deb; do
            cmp "$deb" "$here/$package_folder/again/another/place/${deb##*/}" || fail "${deb##*/} is not the same when it is built again"
        done
        say "built twice, in two places: the same bytes"
    fi
    package_try
    say "packages that work in a clean system:"
    (cd "$here/$package_folder/debs" && sha256sum ./*.deb)
}
