#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scree beside Siconos, the engine of the paper, as Debian ships it: the same heights, hulls, soil and releases, in one go. Prints CPU time per block, the
# ratios and the distributions of the stops, and keeps all that in tests/bench/results. A benchmark, not a test: it installs packages and takes ten minutes.
#
# Usage: compare_siconos.sh [--blocks N] [--runner-blocks N] [--copies N]
#   --blocks N          blocks in both codes (30; those of ../shared/reference/path_a_blocks, or as many of the sample site quarry_a where these are absent)
#   --runner-blocks N   of them with Siconos' runner writing every step (5)
#   --copies N          of each block in Scree, from up to a centimetre beside, for smooth distributions and times (20)
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../.." && pwd)"
source "$here/machine.sh"

blocks=30 runner_blocks=5 copies=20
while [[ $# -gt 0 ]]; do
    case "$1" in
        --blocks) blocks="$2" ;;
        --runner-blocks) runner_blocks="$2" ;;
        --copies) copies="$2" ;;
        *) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 2 ;;
    esac
    shift 2
done

"$root/sample_sites/install_dependencies.sh" python3-siconos libsiconos-kernel-dev python3-h5py python3-scipy
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake -S "$root" --preset release -Wno-dev >/dev/null
cmake --build "$root/build/release" --target scree_throw >&2
throw="$root/build/release/tests/bench/scree_throw"
siconos=/usr/include/siconos
g++ -std=c++17 -O2 -isystem $siconos -isystem $siconos/kernel -isystem $siconos/numerics -o "$work/siconos_blocks" "$here/siconos_blocks.cpp" \
    -lsiconos_kernel -lsiconos_numerics
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1  # CPU time of one core: matrices of five rows gain nothing from more

reference="${SCREE_SHARED_DATA:-$root/../shared}/reference"
if [[ -d "$reference/path_a_blocks" ]]; then
    folder="$work/blocks" terrain="$reference/path_a.asc" site="path_a of the shared references"
    mkdir "$folder"
    cp "$reference"/path_a_blocks/hull_*.csv "$folder"
    head -n $((blocks + 1)) "$reference/path_a_blocks/blocks.csv" >"$folder/blocks.csv"
else
    folder="$work/blocks" terrain="$work/terrain.asc" site="the sample site quarry_a, all of it loose waste"
    "$throw" sample "$folder" "$terrain" --blocks "$blocks"
fi
blocks=$(($(wc -l <"$folder/blocks.csv") - 1))

# The law and the limits, the same in both: e, mu, mu_r [m], longest trajectory [s], tolerance of the contact solver.
e=0 mu=0.5 mu_r=0.04 limit=15 tolerance=1e-4
scree() {  # NAME options
    echo "running $1" >&2
    "$throw" throw "$folder" "$terrain" "$work/$1.csv" --name "$1" --copies "$copies" --time $limit --tolerance $tolerance \
        --restitution $e --friction $mu --rolling $mu_r "${@:2}" >"$work/$1.txt"
}
siconos_kernel() {  # NAME frame
    echo "running $1" >&2
    "$work/siconos_blocks" "$folder" "$terrain" "$work/$1.csv" "$1" "$2" 1e-3 $limit $e $mu $mu_r $tolerance >"$work/$1.txt"
}
siconos_runner() {  # NAME blocks every
    echo "running $1" >&2
    (cd "$work" && /usr/bin/python3 "$here/siconos_runner.py" "$folder" "$terrain" "$work/$1.csv" "$1" --clock "$throw" --blocks "$2" --every "$3" \
        --time $limit -e $e --mu $mu --mu-r $mu_r 2>&1) | grep -v fclib >"$work/$1.txt"
}
value() { awk -v key="$2" '$1 == key { print $2 }' "$work/$1.txt"; }

scree scree_event --mode event --step 8e-3
scree scree_moreau_jean --mode moreau_jean --step 1e-3
scree scree_vertices_only --mode moreau_jean --step 1e-3 --vertices-only
siconos_kernel siconos_kernel shipped
siconos_kernel siconos_kernel_orthogonal orthogonal
siconos_runner siconos_runner_quiet "$blocks" 100
siconos_runner siconos_runner "$runner_blocks" 1

report() {
    echo "# Scree beside Siconos"
    echo
    provenance "$root"
    echo "- Siconos: Debian's $(dpkg-query -W -f='${Version}' python3-siconos), one thread"
    echo "- terrain and blocks: $site; $blocks blocks, in Scree $copies copies of each from up to a centimetre beside"
    echo "- law in both: e $e, mu $mu, mu_r $mu_r m; at most $limit s of motion, ended at rest; tolerance of the contact solver $tolerance, each by its own measure"
    echo
    echo "| run | what | blocks | CPU per block [s] | the same in dependent additions | CPU of scree_event / of scree_moreau_jean goes into it |"
    echo "|---|---|---|---|---|---|"
    row() {
        awk -v name="$1" -v what="$2" -v n="$(value "$1" blocks)" -v cpu="$(value "$1" cpu_s_per_block)" -v adds="$(value "$1" additions_per_block)" \
            -v event="$(value scree_event additions_per_block)" -v jean="$(value scree_moreau_jean additions_per_block)" \
            'BEGIN { printf "| %s | %s | %d | %.4g | %.3g | %.3g / %.3g |\n", name, what, n, cpu, adds, adds / event, adds / jean }'
    }
    row scree_event "mode event, 8 ms"
    row scree_moreau_jean "mode moreau_jean, 1 ms"
    row scree_vertices_only "the same without contacts of crests and tips: the contacts of siconos_kernel"
    row siconos_runner "standard runner: Python, height map and hull in Bullet, output every step (its default)"
    row siconos_runner_quiet "the same, output every 100th step"
    row siconos_kernel "C++ on Siconos' kernel and solver, vertices on facets in double precision, no output"
    row siconos_kernel_orthogonal "the same, contact frame made orthogonal"
    echo
    echo "The ratios are of the last but one column: CPU time times the dependent additions per second that the core delivered just before and after, because"
    echo "shared machines change their clock. All Siconos runs at 1 ms, theta 1/2. Building the hull is part of Scree's time, importing the scene of Siconos'."
    echo
    echo "## Where they stop and how fast they were, compared with scree_vertices_only"
    echo
    "$throw" compare "$work/scree_vertices_only.csv:scree_vertices_only" "$work/scree_moreau_jean.csv:scree_moreau_jean" "$work/scree_event.csv:scree_event" \
        "$work/siconos_kernel_orthogonal.csv:siconos_kernel_orthogonal" "$work/siconos_kernel.csv:siconos_kernel" \
        "$work/siconos_runner_quiet.csv:siconos_runner_quiet"
    echo
    echo "## The frame defect"
    echo
    echo "This release builds the tangents of a contact from the wrong components of the normal (\`orthoBaseFromVector\` in \`op3x3.h\`; fixed upstream in 2024): where"
    echo "the vertical component is the largest, T1.N = Nz (Nx - Ny) / sqrt(Nx^2 + Nz^2) instead of 0. The largest |T1.N| met in these runs:"
    echo "$(value siconos_kernel largest_frame_skew). Friction then acts partly along the normal: blocks are pushed sideways and reach the foot of the slope faster"
    echo "(siconos_kernel and siconos_runner_quiet against siconos_kernel_orthogonal above). Only siconos_kernel_orthogonal solves the law that Scree solves."
}
mkdir -p "$here/results"
result="$here/results/siconos_$(machine_name).md"
report | tee "$result"
echo "kept in ${result#"$root"/}" >&2
