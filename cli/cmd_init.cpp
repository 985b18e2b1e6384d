// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.hpp"
#include "cli/text.hpp"

#include <filesystem>
#include <fstream>
#include <ostream>

namespace scree::cli {

namespace {

constexpr const char* kTemplate =
    R"(# A site for Scree. Paths are relative to this file. All keys with units, ranges and defaults: scree settings

[site]
name = "My site"

[terrain]
dtm = "data/dtm.tif"            # heights in metres in a projected CRS: any raster that GDAL reads
resolution = 1.0                # [m] cell of the model; 0 keeps the DTM's own
surface = "grid"                # grid | tin
diagonals = "by_relief"         # how cells are parted into facets: by_relief | alike, which gives rough ground a grain

# One [[soil]] per kind of ground. Starting values are those of the quarry of Bourrier & Acary (2022): calibrate your own.
[[soil]]
name = "loose"
restitution = 0.0               # [-] e: 0 does not bounce
friction = 0.5                  # [-] mu
rolling = 0.04                  # [m] mu_r, a length

[[soil]]
name = "compact"
restitution = 0.0
friction = 0.6
rolling = 0.05

[zones]                         # leave out the section if all ground is the first soil
file = "data/zones.gpkg"        # polygons in any CRS
field = "soil"                  # text field with the name of a [[soil]]
default = "loose"               # where no polygon lies

[blocks]
list = "data/blocks.csv"        # block_id,mass_kg,L1_m,L2_m,L3_m; or leave out and give volume, density, ratios
shape = "hull"                  # hull | sharp | round | box | eota | ellipsoid | file

[release]
file = "data/release.gpkg"      # polygons, lines or points
count = 1000
height = 1.0                    # [m] centre of mass above the ground

[model]
seed = 1

[screens]                       # leave out if there are none
file = "data/screens.gpkg"      # lines, or polygons whose outline counts
field = "name"

[deposit_zones]                 # leave out if there are none
file = "data/deposit_zones.gpkg"
field = "name"

[output]
directory = "out"
trajectories = 100              # how many to keep as lines
)";

}  // namespace

ExitCode run_init(const Context& context) {
    namespace fs = std::filesystem;
    const fs::path folder(context.target);
    const fs::path file = folder / "site.toml";
    std::error_code error;
    if (fs::exists(file, error))
        throw InputError(file.string() + " exists already: choose another folder or remove it");
    fs::create_directories(folder / "data", error);
    std::ofstream out(file, std::ios::binary);
    if (error || !out) throw InputError(file.string() + " cannot be written: check that the folder may be created");
    if (!(out << kTemplate) || !out.flush()) {
        fs::remove(file, error);
        throw ComputeError(file.string() + " could not be stored; check that the disc has room");
    }
    *context.out << "Wrote " << file.string() << "\nPut your data into " << (folder / "data").string()
                 << ", adapt the file, then: scree check " << shell_word(file.string()) << "\n";
    return ExitCode::Done;
}

}  // namespace scree::cli
