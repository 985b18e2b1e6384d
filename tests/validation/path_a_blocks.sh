#!/usr/bin/env bash
# Thirty blocks on a slope like path A of the paper, against the reference's exact-contact outcomes: prints the table of README.md, "Thirty blocks on path A".
# Usage: path_a_blocks.sh [COPIES]     (of each block, default 40; needs the target scree_throw of the release build, takes minutes)
set -euo pipefail
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../.." && pwd)"
copies="${1:-40}"
throw="$root/build/release/tests/bench/scree_throw"
reference="${SCREE_SHARED_DATA:-$root/../shared}/reference"
[[ -d "$reference/path_a_blocks" ]] || { echo "skipped: shared data not found: reference/path_a_blocks"; exit 77; }
[[ -x "$throw" ]] || { echo "build it first: cmake --preset release && cmake --build --preset release --target scree_throw" >&2; exit 2; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# thrown NAME options: the 30 blocks with the time limit of the reference
thrown() {
    echo "$1: $("$throw" throw "$reference/path_a_blocks" "$reference/path_a.asc" "$work/$1.csv" --name "$1" --time 15 \
        --copies "$copies" "${@:2}" | tr '\n' ',')"
}
thrown moreau_jean_vertices --mode moreau_jean --step 1e-3 --vertices-only
thrown moreau_jean --mode moreau_jean --step 1e-3
thrown event_vertices --step 4e-3 --vertices-only
thrown event --step 4e-3
thrown rough_event_vertices --step 4e-3 --vertices-only --noise 0.05
thrown rough_event --step 4e-3 --noise 0.05
# compared NAME|FILE:MODEL...: how far sets are from the first of them
compared() {
    local sets=()
    for name in "$@"; do [[ "$name" == */* ]] && sets+=("$name") || sets+=("$work/$name.csv:$name"); done
    "$throw" compare "${sets[@]}"
}

echo; echo "Against the reference:"
compared "$reference/path_a_blocks/outcomes.csv:exact vertex contact" moreau_jean_vertices moreau_jean event_vertices event
echo; echo "What contacts of crests and tips change, in the scheme of the paper:"
compared moreau_jean_vertices moreau_jean
echo; echo "and in event mode:"
compared event_vertices event
echo; echo "and there with 5 cm of noise on every node:"
compared rough_event_vertices rough_event
echo; echo "What the step of the paper changes:"
compared event moreau_jean
