// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gis/vector_reader.hpp"
#include "scree/geometry/diagonals.hpp"
#include "scree/geometry/region.hpp"
#include "scree/geometry/triangle_mesh.hpp"

#include <string>
#include <vector>

namespace scree::gis {

struct SoilZoneSettings {
    std::string field = "soil";  ///< text field that names the soil of a polygon
    std::string priority_field;  ///< numeric field that decides overlaps, the higher wins; empty: overlaps are an error
    std::vector<std::string> soils;  ///< names of the soils; the index is the SoilId
    SoilId default_soil = 0;         ///< where no polygon lies [-]
};

struct SoilReport {
    std::vector<std::string> soils;  ///< names, as in the settings
    std::vector<double> area;        ///< plan area of the facets of each soil [m^2]
    double gap_area = 0.0;           ///< plan area of facets in no polygon, which took the default soil [m^2]
    /// Plan area of the facets that a boundary between soils passes through. A facet takes the soil at its centroid, so at most this
    /// area has another soil than the polygons say; zero for a conforming mesh [m^2].
    double divided_area = 0.0;
    std::vector<std::string> warnings;
};

struct FacetSoils {
    std::vector<SoilId> soil;  ///< of each facet
    SoilReport report;
};

/// Polygons with soils, indexed for point location.
class SoilZones {
public:
    /// No polygons: the default soil everywhere.
    explicit SoilZones(const SoilZoneSettings& settings);
    /// Throws InputError for a soil name that is not in the settings, listing those that are, and for polygons of different soils that
    /// overlap without a priority that decides, naming the features and the area. Overlaps that are slivers from digitising (thinner
    /// than 5 cm in the mean) become a warning; there and between polygons of one soil the feature that comes first wins.
    SoilZones(const VectorData& polygons, const SoilZoneSettings& settings);

    /// The zone at a place, -1 in a gap. Zones are ordered by priority.
    int zone_at(const Vec2& p) const;
    SoilId soil_at(const Vec2& p) const;
    SoilId soil_of(int zone) const {
        return zone < 0 ? settings_.default_soil : zones_[static_cast<std::size_t>(zone)].soil;
    }
    /// All rings of all polygons [m].
    const std::vector<Ring>& boundaries() const { return boundaries_; }
    const SoilZoneSettings& settings() const { return settings_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    struct Zone {
        Region region;
        MultiPolygon polygons;
        SoilId soil = 0;        ///< [-]
        double priority = 0.0;  ///< [-]
        std::int64_t id = 0;    ///< feature id in the file [-]
    };
    void check_overlaps(const VectorData& polygons);
    void build_index();

    SoilZoneSettings settings_;
    std::vector<Zone> zones_;
    std::vector<Ring> boundaries_;
    std::vector<std::string> warnings_;
    Box2 bounds_;                         ///< of all zones [m]
    Vec2 bin_{1, 1};                      ///< size of a bin [m]
    std::vector<std::vector<int>> bins_;  ///< zones whose box reaches into a bin, row by row
};

/// Soil of each facet of the surface of a grid whose nodes are the CENTRES of its cells, numbered as in make_grid_surface().
/// Facets with a node without height get the default soil and count in no area.
FacetSoils assign_soils(const SoilZones& zones, const Grid<double>& grid, DiagonalRule rule = DiagonalRule::Alike);
/// Soil of each facet of a mesh. A boundary that reaches less than `touch` [m] into a facet does not divide it: a conforming mesh
/// follows boundaries to within a small part of a cell only.
FacetSoils assign_soils(const SoilZones& zones, const TriangleMesh& mesh, double touch = 1e-6);

}  // namespace scree::gis
