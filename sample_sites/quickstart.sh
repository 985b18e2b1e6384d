#!/usr/bin/env bash
# From a fresh clone to a first map: installs what is missing (Debian 12), builds Scree and runs the site quarry_a.
# Usage: sample_sites/quickstart.sh [PRESET]     (of CMakePresets.json; default: release)
# Results go to sample_sites/quarry_a/out, those of other presets to build/PRESET/quickstart.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset="${1:-release}"
site=sample_sites/quarry_a
results="$site/out"
[[ $preset == release ]] || results="build/$preset/quickstart"
scree="build/$preset/cli/scree"

sample_sites/install_dependencies.sh
cmake --preset "$preset" -Wno-dev
cmake --build --preset "$preset" --target scree

echo
"$scree" check "$site/site.toml"
echo
# The results of an earlier quickstart are replaced; anything else in that folder is kept.
"$scree" run "$site/site.toml" --output "$results" --overwrite

cat <<END

What came out, in $PWD/$results

  results.qgs       open this in QGIS: every layer, styled and in place
  results.gpkg      the same layers in one file for any GIS: where each block stopped and why (stopping_points),
                    paths (trajectories), speed, height and energy at the screens (screen_crossings),
                    share of the blocks in each deposit zone (deposit_zones), and all maps
  rasters/          the maps as GeoTIFFs, cell by cell: reach_probability (share of the blocks that crossed),
                    and for energy, passing height, speed and spin the mean, quantiles and the maximum
  run.toml          all settings of this run; scree run on it gives the same results again

Scree itself is $PWD/$scree
Next: its --help, README.md for what the numbers mean, and scree init FOLDER for a site of your own.
END
