// SPDX-License-Identifier: GPL-3.0-or-later
// write_sample FOLDER: writes the sample results, for the test that opens them in QGIS.
#include "gis/output_sample.hpp"
#include "gis/output_wkt.hpp"

#include <cstdio>

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    try {
        scree::gis::write_results(argv[1], scree::test::SampleResults(scree::test::wkt2(2154)).package, true);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
