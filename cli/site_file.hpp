// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/site_settings.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scree::cli {

/// A name of GDAL with the path of a file in it: /vsizip/, data/a.zip/dtm.tif; GPKG:, data/a.gpkg, :dtm. Without a file (a data base, a network) all of it is `before`.
struct GdalName {
    std::string before, path, after;

    std::string with(const std::string& other_path) const { return before + other_path + after; }
};

/// A site file as read, with the folder that its paths refer to.
struct SiteFile {
    std::filesystem::path file;
    std::filesystem::path folder;
    SiteSettings settings;

    /// What a path of the settings is, if it is a name of GDAL and no path.
    std::optional<GdalName> gdal_name(const std::string& path) const;
    /// A path of the settings as it is opened. In names of GDAL, too, the path is relative to the folder of the site.
    std::filesystem::path resolve(const std::string& path) const;
    /// The same of what is made, where a colon is a colon.
    std::filesystem::path beside(const std::string& path) const;
};

/// Reads a site file and applies `--set key=value` changes. Throws InputError that names file, line, key, value and what is allowed; unknown keys
/// are errors. Settings that belong together are checked against each other.
SiteFile read_site_file(const std::filesystem::path& file, const std::vector<std::string>& changes);

/// Which entries WHICH of soil.WHICH.key or effect.WHICH.key means, counted from 0: by their names (of effects: kinds), by numbers that are no name, several
/// with | between them, or * for all. Empty if one of them is nothing.
std::vector<std::size_t> entries_meant(std::string_view which, const std::vector<std::string>& names);
std::vector<std::string> names_of(const std::vector<Soil>& soils);
std::vector<std::string> names_of(const std::vector<EffectSettings>& effects);

/// A site as read, with other values of some keys ("release.height=3", "soil.NAME.rolling=0.05", "effect.KIND.coefficient=1"), in memory: the file is
/// not read again.
SiteFile with_changes(SiteFile site, const std::vector<std::string>& changes);

}  // namespace scree::cli
