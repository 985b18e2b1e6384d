// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/sweep_report.hpp"

#include "cli/html.hpp"
#include "cli/json.hpp"
#include "cli/plot.hpp"
#include "cli/text.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace scree::cli {

namespace {
using gis::Svg;
using gis::SvgPanel;

std::string label_of(const SweepValue& v) {
    return v.key.empty() ? "the site as it is" : v.key + " = " + v.value;
}

std::string share_text(double share) {
    return std::isfinite(share) ? std::to_string(std::lround(100.0 * share)) + " %" : "-";
}

std::vector<const SweepValue*> rows_of(const SweepStudy& study) {
    std::vector<const SweepValue*> rows{&study.base};
    for (const SweepValue& v : study.values) rows.push_back(&v);
    return rows;
}

std::string spread_text(const SetSpread& s) {
    if (!std::isfinite(s.mean)) return "-";
    return short_number(s.mean) + " +- " + short_number(std::isfinite(s.deviation) ? s.deviation : 0.0);
}

/// What a panel shows of a value: how far it is from the site as it is, or a measure.
const SetSpread& shown(const SweepValue& v, std::ptrdiff_t measure) {
    return measure < 0 ? v.influence : v.measures[static_cast<std::size_t>(measure)];
}

/// One key, one measure: sets of each value over the scatter of the site as it is.
void draw_panel(Svg& svg, const Box2& pixels, const SweepStudy& study, const std::vector<const SweepValue*>& values,
                std::ptrdiff_t measure, const Box2& range) {
    const SvgPanel panel{pixels, range};
    draw_y_axis(svg, panel, "", 5);
    const SetSpread& base = shown(study.base, measure);
    const double left = range.min.x(), right = range.max.x();
    if (std::isfinite(base.low))
        svg.box({panel.at({left, base.high}), panel.at({right, base.low})}, fill(kChanceColour, 0.55));
    const double measured = measure < 0 ? kNaN : study.measures[static_cast<std::size_t>(measure)].measured;
    if (std::isfinite(measured))
        svg.segment(panel.at({left, measured}), panel.at({right, measured}), stroke(kMeasuredColour, 2.0));
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double x = static_cast<double>(k) + 0.5;
        const SetSpread& s = shown(*values[k], measure);
        svg.text({panel.at({x, 0.0}).x(), pixels.max.y() + 16.0}, values[k]->value, words(11.0, "middle"));
        if (!std::isfinite(s.mean)) continue;
        draw_interval(svg, panel.at({x, s.low}), panel.at({x, s.high}), kSimulatedColour);
        svg.circle(panel.at({x, s.mean}), 4.0, fill(kSimulatedColour));
    }
    draw_frame(svg, panel);
}

}  // namespace

Figure sweep_figure(const SweepStudy& study) {
    constexpr double kWidth = 230.0, kHeight = 150.0, kLeft = 66.0, kTop = 66.0, kRight = 18.0, kBottom = 70.0;
    constexpr std::ptrdiff_t kAcross = 4;  // panels in a row: more would be too small to read on a page
    std::vector<std::string> keys;
    for (const SweepValue& v : study.values)
        if (std::find(keys.begin(), keys.end(), v.key) == keys.end()) keys.push_back(v.key);
    const auto panels = static_cast<std::ptrdiff_t>(study.measures.size()) + 1;
    const std::ptrdiff_t rows = (panels + kAcross - 1) / kAcross;  // of each key
    Svg svg(static_cast<double>(std::min(panels, kAcross)) * (kLeft + kWidth + kRight),
            kTop + static_cast<double>(std::ssize(keys) * rows) * (kHeight + kBottom));
    for (std::ptrdiff_t p = 0; p < panels; ++p) {
        const std::ptrdiff_t measure = p - 1;
        double low = kInfinity, high = -kInfinity;
        for (const SweepValue* v : rows_of(study)) {
            const SetSpread& s = shown(*v, measure);
            if (!std::isfinite(s.low)) continue;
            low = std::min(low, s.low);
            high = std::max(high, s.high);
        }
        if (measure >= 0 && std::isfinite(study.measures[static_cast<std::size_t>(measure)].measured)) {
            low = std::min(low, study.measures[static_cast<std::size_t>(measure)].measured);
            high = std::max(high, study.measures[static_cast<std::size_t>(measure)].measured);
        }
        if (!(low <= high)) continue;
        const auto [bottom, top] = padded_range(low, high);
        for (std::size_t k = 0; k < keys.size(); ++k) {
            std::vector<const SweepValue*> values;
            for (const SweepValue& v : study.values)
                if (v.key == keys[k]) values.push_back(&v);
            const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(k) * rows + p / kAcross;
            const Vec2 corner(kLeft + static_cast<double>(p % kAcross) * (kLeft + kWidth + kRight),
                              kTop + 22.0 + static_cast<double>(row) * (kHeight + kBottom));
            draw_panel(svg, {corner, corner + Vec2(kWidth, kHeight)}, study, values, measure,
                       {{0.0, bottom}, {static_cast<double>(values.size()), top}});
            svg.text(corner + Vec2(0.5 * kWidth, kHeight + 35.0), keys[k], words(12.0, "middle"));
            const std::string name = measure < 0 ? "gap to the site as it is [-]"
                                                 : study.measures[static_cast<std::size_t>(measure)].name + " [" +
                                                       study.measures[static_cast<std::size_t>(measure)].unit + "]";
            svg.text(corner + Vec2(0.0, -8.0), name, words(11.5, "start", true));
        }
    }
    svg.text({10.0, 20.0}, study.title + ": influence of keys, beside the scatter from set to set",
             words(13.5, "start", true));
    Vec2 at(kLeft, 46.0);
    at.x() += draw_legend(svg, at, LegendMark::Dot, kSimulatedColour, "mean of the sets, 95 % of them");
    at.x() += draw_legend(svg, at, LegendMark::Box, kChanceColour, "95 % of sets of the site as it is");
    draw_legend(svg, at, LegendMark::Line, kMeasuredColour, "measured");
    return {"sweep.svg", "Influence",
            "Each dot is the mean over " + std::to_string(study.sets) +
                " sets of blocks, its line 95 % of them; grey: 95 % of as many sets of the site as it is, with " +
                std::to_string(study.base.blocks) +
                " blocks each. A line that leaves the grey band is an influence that so many blocks show.",
            svg.text()};
}

void print_sweep(std::ostream& out, const SweepStudy& study) {
    std::size_t key = 18;
    for (const SweepValue* v : rows_of(study)) key = std::max(key, label_of(*v).size());
    out << study.title << ": " << study.sets << " sets per value (seed " << study.seed
        << "); mean +- standard deviation of a set\n\n"
        << padded("", key) << "  " << padded("blocks", 7) << padded("gap to site", 12) << padded("told apart", 11)
        << padded("to test", 9);
    std::vector<std::size_t> widths;
    for (const SweepMeasure& m : study.measures) {
        const std::string name = m.name + " [" + m.unit + "]";
        widths.push_back(std::max<std::size_t>(name.size(), 15) + 2);
        out << padded(name, widths.back());
    }
    out << "\n";
    for (const SweepValue* v : rows_of(study)) {
        out << padded(label_of(*v), key) << "  " << padded(std::to_string(v->blocks), 7)
            << padded(gap_number(v->influence.mean), 12) << padded(share_text(v->told_apart), 11)
            << padded(gap_number(v->gap), 9);
        for (std::size_t m = 0; m < v->measures.size(); ++m) out << padded(spread_text(v->measures[m]), widths[m]);
        out << "\n";
    }
    out << padded("measured", key) << "  " << padded("", 39);
    for (std::size_t m = 0; m < study.measures.size(); ++m)
        out << padded(std::isfinite(study.measures[m].measured) ? short_number(study.measures[m].measured) : "-",
                      widths[m]);
    out << "\n\ntold apart: share of the sets that are farther from the site as it is than 95 % of its own sets; 5 % "
           "if a key does nothing, give or take "
        << share_text(std::sqrt(0.05 * 0.95 / static_cast<double>(std::max<std::int64_t>(study.sets, 1))))
        << "; - where a set is more than half of the site's own blocks\n";
}

std::string sweep_csv(const SweepStudy& study) {
    std::ostringstream out;
    out << "key,value,blocks_per_set,gap_to_site,gap_to_site_low,gap_to_site_high,told_apart_share,gap_to_test";
    for (const SweepMeasure& m : study.measures) {
        const std::string name = m.name + " " + m.unit;
        for (const char* what : {"mean", "deviation", "low", "high"}) out << "," << csv_cell(name + " " + what);
    }
    out << "\n";
    const auto number = [&](double v) {
        out << ",";
        if (std::isfinite(v)) out << v;
    };
    for (const SweepValue* v : rows_of(study)) {
        out << csv_cell(v->key) << "," << csv_cell(v->value) << "," << v->blocks;
        for (const double n : {v->influence.mean, v->influence.low, v->influence.high, v->told_apart, v->gap})
            number(n);
        for (const SetSpread& s : v->measures)
            for (const double n : {s.mean, s.deviation, s.low, s.high}) number(n);
        out << "\n";
    }
    return out.str();
}

std::string sweep_json(const SweepStudy& study) {
    const auto spread = [](const SetSpread& s) {
        return Json{{"mean", s.mean}, {"deviation", s.deviation}, {"sets_95", Json::array({s.low, s.high})}};
    };
    const auto value = [&](const SweepValue& v) {
        Json json{{"key", v.key},
                  {"value", v.value},
                  {"blocks_per_set", v.blocks},
                  {"gap_to_site", spread(v.influence)},
                  {"told_apart", v.told_apart},
                  {"gap_to_test", v.gap},
                  {"measures", Json::object()}};
        for (std::size_t m = 0; m < v.measures.size(); ++m)
            json["measures"][study.measures[m].name] = spread(v.measures[m]);
        return json;
    };
    Json json{{"site", study.title}, {"seed", study.seed}, {"sets", study.sets}, {"observables", study.observables}};
    json["measured"] = Json::object();
    for (const SweepMeasure& m : study.measures)
        json["measured"][m.name] = Json{{"value", m.measured}, {"unit", m.unit}};
    json["site_as_it_is"] = value(study.base);
    json["values"] = Json::array();
    for (const SweepValue& v : study.values) json["values"].push_back(value(v));
    return json_text(json, 1) + "\n";
}

std::string sweep_html(const SweepStudy& study, const Figure& figure) {
    std::ostringstream html;
    html << html_figure(figure)
         << "<table><tr><th></th><th>blocks of a set</th><th>gap to the site as it is</th><th>told apart</th><th>gap "
            "to the test</th>";
    for (const SweepMeasure& m : study.measures) html << "<th>" << escaped(m.name + " [" + m.unit + "]") << "</th>";
    html << "</tr>\n";
    for (const SweepValue* v : rows_of(study)) {
        html << "<tr><td>" << escaped(label_of(*v)) << "</td><td>" << v->blocks << "</td><td>"
             << gap_number(v->influence.mean) << "</td><td" << (v->told_apart >= 0.5 ? " class=\"beyond\"" : "") << ">"
             << share_text(v->told_apart) << "</td><td>" << gap_number(v->gap) << "</td>";
        for (const SetSpread& s : v->measures) html << "<td>" << spread_text(s) << "</td>";
        html << "</tr>\n";
    }
    html << "<tr class=\"all\"><td>measured</td><td></td><td></td><td></td><td></td>";
    for (const SweepMeasure& m : study.measures)
        html << "<td>" << (std::isfinite(m.measured) ? short_number(m.measured) : "-") << "</td>";
    html << "</tr></table>\n<p>" << study.sets
         << " sets per value; mean +- standard deviation of a set. <b>Gap to the site as it is</b>: energy distance of "
            "a set to all sets of the site as it is, 1 on average if the key "
            "does nothing; mean over: ";
    for (std::size_t k = 0; k < study.observables.size(); ++k) html << (k ? ", " : "") << escaped(study.observables[k]);
    html << ". <b>Told apart</b>: share of the sets that are farther away than 95 % of the site's own sets of as many "
            "blocks; 5 % if the key does nothing.</p>\n";
    return html_page(study.title + ": sweep", html.str());
}

}  // namespace scree::cli
