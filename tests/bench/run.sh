#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds and runs the scenes and keeps the table in tests/bench/results/engine_MACHINE.md. Leave the machine alone meanwhile: about two minutes.
#
# Usage: run.sh [--dry] [options of Google Benchmark]
#   --dry     print the table and keep nothing
#   for example --benchmark_filter=campaign --benchmark_repetitions=5 --benchmark_enable_random_interleaving=true, where other machines on the same
#   processor disturb: medians of runs that take turns
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../.." && pwd)"
source "$here/machine.sh"

keep=yes
case "${1:-}" in
    --dry) keep=no; shift ;;
    -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac

"$root/sample_sites/install_dependencies.sh"
(cd "$root" && cmake --preset release -Wno-dev >/dev/null && cmake --build --preset release --target scree_bench >&2)
json="$(mktemp)"
trap 'rm -f "$json"' EXIT
"$root/build/release/tests/bench/scree_bench" --benchmark_out="$json" --benchmark_out_format=json "$@" >&2

report() {
    echo "# Speed of the engine and its parts"
    echo
    provenance "$root"
    /usr/bin/python3 "$here/table.py" "$json"
}
if [[ $keep == no ]]; then
    report
else
    mkdir -p "$here/results"
    result="$here/results/engine_$(machine_name).md"
    report | tee "$result"
    echo "kept in ${result#"$root"/}" >&2
fi
