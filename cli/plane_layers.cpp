// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plane_layers.hpp"

#include "gis/words.hpp"
#include "scree/inference/distance.hpp"

#include <algorithm>
#include <cmath>

namespace scree::cli {

namespace {

/// The line of a profile between two chainages, with its vertices between them.
std::vector<Vec3> line_between(const Profile& p, double from, double to) {
    std::vector<Vec3> points;
    auto add = [&](double s) {
        const Vec2 place = p.place_at(s);
        points.emplace_back(place.x(), place.y(), p.height_at(s));
    };
    add(from);
    for (std::size_t k = p.reach_at(from) + 1; k < p.vertex_count() && p.s[k] < to; ++k)
        if (p.s[k] > from) points.emplace_back(p.place[k].x(), p.place[k].y(), p.z[k]);
    add(to);
    return points;
}

/// Names and values of the columns that layer and table share, cell by cell.
struct Curves {
    std::vector<Field> fields;
    struct Row {
        std::size_t profile = 0;
        double from = 0.0, to = 0.0;  ///< chainages [m]
        std::vector<FieldValue> values;
    };
    std::vector<Row> rows;
};

std::vector<FieldValue> values_of(const CellStatistics& c, double thrown) {
    std::vector<FieldValue> values{c.passages, static_cast<double>(c.passages) / std::max(thrown, 1.0), c.deposits};
    for (const QuantityInfo& q : kQuantities) {
        const QuantityStatistics& s = c.quantities[static_cast<std::size_t>(q.quantity)];
        auto add = [&](double value) {
            if (c.passages > 0)
                values.emplace_back(q.factor * value);
            else
                values.emplace_back();
        };
        add(c.passages > 0 ? mean_of(s, c.passages) : 0.0);
        for (const int percent : kPercents) add(s.quantile(0.01 * percent));
        add(s.largest);
    }
    return values;
}

Curves curves_of(const SiteModel& model, const CampaignResult& result) {
    Curves curves;
    curves.fields = {{"profile", FieldType::Integer, "Profile"},
                     {"from_s_m", FieldType::Real, "From s [m]"},
                     {"to_s_m", FieldType::Real, "To s [m]"},
                     {"passages", FieldType::Integer, "Blocks that crossed the cell"},
                     {"reach_probability", FieldType::Real, "Share of the blocks thrown on this profile"},
                     {"deposits", FieldType::Integer, "Blocks at rest in the cell"}};
    for (const QuantityInfo& q : kQuantities) {
        auto add = [&](const std::string& suffix, const std::string& words) {
            curves.fields.push_back({std::string(q.name) + "_" + suffix, FieldType::Real,
                                     std::string(q.title) + ", " + words + " [" + q.unit + "]"});
        };
        add("mean", "mean");
        for (const int percent : kPercents) add("p" + std::to_string(percent), std::to_string(percent) + " % quantile");
        add("max", "maximum");
    }
    for (std::size_t k = 0; k < model.campaign.tracks.size(); ++k) {
        const Profile& profile = model.campaign.tracks[k].profile;
        const double cell = model.campaign.cell_along, thrown = blocks_thrown_on(result, k);
        for (std::size_t j = 0; j < cells_along(profile, cell); ++j) {
            const auto found = result.cells_along[k].find(j);
            const double from = static_cast<double>(j) * cell;
            curves.rows.push_back(
                {k, from, std::min(from + cell, profile.length()),
                 values_of(found == result.cells_along[k].end() ? CellStatistics{} : found->second, thrown)});
        }
    }
    return curves;
}

std::string text_of(const FieldValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
    if (const auto* number = std::get_if<double>(&value)) {  // a probability may be small
        const int zeros = *number == 0.0 ? 0 : std::max(0, static_cast<int>(-std::log10(std::abs(*number))));
        return gis::fixed(*number, 4 + zeros);
    }
    return "";
}

}  // namespace

double blocks_thrown_on(const CampaignResult& result, std::size_t track) {
    return static_cast<double>(std::count_if(result.blocks.begin(), result.blocks.end(), [&](const BlockResult& b) {
        return b.done && static_cast<std::size_t>(b.profile) == track;
    }));
}

Polylines stretches_in(const SiteModel& model, const MultiPolygon& area) {
    Polylines parts;
    for (const ProfileTrack& track : model.campaign.tracks)
        for (const Stretch& s : track.profile.inside(area))
            parts.push_back({line_between(track.profile, s.from, s.to), {}});
    return parts;
}

gis::VectorLayer curves_layer(const SiteModel& model, const CampaignResult& result) {
    const Curves curves = curves_of(model, result);
    gis::VectorLayer layer;
    layer.title = "Curves along the profiles";
    layer.description =
        "Cells along the profiles: blocks that crossed them, and of each block's largest values inside the cell the "
        "mean, quantiles and maximum";
    layer.data.name = "profile_curves";
    layer.data.kind = GeometryKind::LineString;
    layer.data.fields = curves.fields;
    for (const Curves::Row& row : curves.rows) {
        Feature f;
        f.id = static_cast<std::int64_t>(layer.data.features.size()) + 1;
        f.geometry =
            Polylines{Polyline{line_between(model.campaign.tracks[row.profile].profile, row.from, row.to), {}}};
        f.values = {static_cast<std::int64_t>(row.profile) + 1, row.from, row.to};
        f.values.insert(f.values.end(), row.values.begin(), row.values.end());
        layer.data.features.push_back(std::move(f));
    }
    layer.styles = {{.name = "By energy, 95 % quantile",
                     .colour_by = "energy_kj_p95",
                     .limits = {10, 30, 100, 300, 1000, 3000},
                     .ramp = gis::Ramp::Inferno,
                     .unit = "kJ",
                     .size_mm = 1.4},
                    {.name = "By reach probability",
                     .colour_by = "reach_probability",
                     .limits = {0.001, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75},
                     .ramp = gis::Ramp::Viridis,
                     .size_mm = 1.4}};
    return layer;
}

std::string curves_csv(const SiteModel& model, const CampaignResult& result) {
    const Curves curves = curves_of(model, result);
    std::string text;
    for (const Field& field : curves.fields) text += (text.empty() ? "" : ",") + field.name;
    text += "\n";
    for (const Curves::Row& row : curves.rows) {
        text += std::to_string(row.profile + 1) + "," + gis::fixed(row.from, 3) + "," + gis::fixed(row.to, 3);
        for (const FieldValue& value : row.values) text += "," + text_of(value);
        text += "\n";
    }
    return text;
}

std::vector<std::string> profile_summaries(const SiteModel& model, const CampaignResult& result) {
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < model.campaign.tracks.size(); ++k) {
        std::vector<double> stops;
        std::int64_t thrown = 0;
        for (const BlockResult& b : result.blocks) {
            if (!b.done || b.profile != static_cast<std::int32_t>(k)) continue;
            ++thrown;
            if (b.reason == StopReason::AtRest) stops.push_back(b.stop_s);
        }
        std::sort(stops.begin(), stops.end());
        const auto quantile = [&](double q) { return gis::fixed(sample_quantile(stops, q), 1); };
        std::string line =
            gis::counted(static_cast<std::size_t>(thrown), "block") + ", " + std::to_string(stops.size()) + " at rest";
        if (!stops.empty())
            line += " at s = " + quantile(0.0) + " to " + gis::fixed(stops.back(), 1) + " m, median " + quantile(0.5) +
                    " m, 95 % quantile " + quantile(0.95) + " m";
        lines.push_back(line + " (of " + gis::fixed(model.campaign.tracks[k].profile.length(), 1) + " m)");
    }
    return lines;
}

}  // namespace scree::cli
