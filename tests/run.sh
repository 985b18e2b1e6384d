#!/usr/bin/env bash
# Installs what is missing, builds Scree with warnings as errors and runs all tests. Ends with ctest's summary.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sample_sites/install_dependencies.sh --with-tests
cmake --preset ci
cmake --build --preset ci
ctest --preset ci --parallel "$(nproc)"
