# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts of this folder: what the machine is called in the names of result files, and where results come from.

# CPU model and number of cores, fit for a file name: intel_xeon_processor_2.50ghz_2_cores. Nothing that tells one machine of the kind from another.
machine_name() {
    local model
    model="$(LC_ALL=C lscpu | sed -n 's/^Model name: *//p' | head -1 | sed -E 's/\((R|TM)\)//g; s/[^A-Za-z0-9.]+/_/g; s/^_|_$//g')"
    echo "${model,,}_$(getconf _NPROCESSORS_ONLN)_cores"
}

# Date, the last commit that changed the engine (with a + where files have been changed since), compiler and load, as lines of a list.
provenance() {
    local commit
    commit="$(git -C "$1" log -1 --format=%h -- src include 2>/dev/null || echo unknown)"
    git -C "$1" diff --quiet HEAD -- src include 2>/dev/null || commit+="+"
    echo "- date: $(date -u +%Y-%m-%d), commit of src and include: $commit"
    echo "- processor: $(LC_ALL=C lscpu | sed -n 's/^Model name: *//p' | head -1), $(getconf _NPROCESSORS_ONLN) cores; compiler: $(g++ --version | head -1)"
    echo "- load of the machine over the last 1, 5 and 15 minutes: $(cut -d" " -f1-3 /proc/loadavg)"
}
