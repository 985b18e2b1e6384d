#!/usr/bin/env bash
# The quickstart with warnings as errors, then all tests. Ends with ctest's summary.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sample_sites/quickstart.sh ci
cmake --build --preset ci
ctest --preset ci --parallel "$(nproc)" --no-tests=error
