#!/usr/bin/env bash
# Installs the Debian 12 packages that Scree needs and that are missing. Needs root or sudo only if something is missing.
set -euo pipefail

packages=(g++ cmake ninja-build ccache libeigen3-dev libtbb-dev librandom123-dev libcli11-dev libtomlplusplus-dev
          libgdal-dev libproj-dev libsqlite3-dev libcgal-dev gdal-bin python3-gdal python3-numpy)
# Only the tests need these.
if [[ "${1:-}" == "--with-tests" ]]; then
    packages+=(libgtest-dev libgmock-dev libbenchmark-dev)
fi

missing=()
for package in "${packages[@]}"; do
    [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)" == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

echo "Installing: ${missing[*]}"
as_root=()
[[ $EUID -eq 0 ]] || as_root=(sudo)
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
