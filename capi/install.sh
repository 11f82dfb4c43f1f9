#!/bin/bash
# install.sh FOLDER PREFIX: copies the libraries in FOLDER, the headers and midair.pc to PREFIX/lib and PREFIX/include.
# If a packager sets DESTDIR, it comes before PREFIX. Root is not needed if the folders can be written.
set -eu -o pipefail
built=$1 prefix=$2
source=$(dirname "$0")
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' "$source/../Cargo.toml")
abi=$(sed -n 's/^#define MIDAIR_ABI //p' "$source/include/midair.h")
[[ $prefix = /* ]] || { echo "install: PREFIX is $prefix: give a path that begins with /" >&2; exit 2; }
[ -f "$built/libmidair.so" ] || { echo "install: $built/libmidair.so is missing: run make capi (on Linux)" >&2; exit 2; }

lib=${DESTDIR:-}$prefix/lib include=${DESTDIR:-}$prefix/include
install -d "$include" "$lib/pkgconfig"
install -m 644 "$source/include/midair.h" "$source/include/midair.hpp" "$include"
install -m 644 "$built/libmidair.a" "$lib"
install -m 755 -s "$built/libmidair.so" "$lib/libmidair.so.$version"
ln -sf "libmidair.so.$version" "$lib/libmidair.so.$abi"
ln -sf "libmidair.so.$abi" "$lib/libmidair.so"
# rustc prints the libraries for static linking: `cargo rustc -p midair-capi --release -- --print native-static-libs`.
sed -e "s|@PREFIX@|$prefix|" -e "s|@VERSION@|$version|" -e "s|@PRIVATE@|-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc|" \
    "$source/midair.pc.in" >"$lib/pkgconfig/midair.pc"
