#!/usr/bin/env bash
# Installs the Debian 12 packages that are missing to build, run and test Scree. Needs root or sudo only if some are.
# Usage: install_dependencies.sh [PACKAGE...]     (further packages to look for)
set -euo pipefail

packages=(g++ cmake ninja-build libeigen3-dev libtbb-dev libhwy-dev librandom123-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev
          libgdal-dev libproj-dev libsqlite3-dev libcgal-dev gdal-bin python3-gdal python3-numpy
          libgtest-dev libgmock-dev libbenchmark-dev
          "$@")

if ! command -v apt-get >/dev/null; then
    echo "No apt-get here: nothing is installed. Should cmake miss something, install your system's equivalent of" >&2
    echo "  ${packages[*]}" >&2
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)" == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $EUID -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
        echo "Packages are missing, and neither root nor sudo is at hand. Ask an administrator for:" >&2
        echo "  apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
