// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/html.hpp"

#include "cli/commands.hpp"
#include "gis/xml.hpp"

#include <sstream>

namespace scree::cli {

namespace {

constexpr const char* kStyle =
    R"(body { font: 15px/1.45 Arial, Helvetica, 'Liberation Sans', sans-serif; color: #222; max-width: 1320px; margin: 24px auto; padding: 0 20px; }
h1 { font-size: 24px; } h2 { font-size: 18px; margin-top: 32px; } h3 { font-size: 15px; margin-bottom: 4px; }
table { border-collapse: collapse; display: block; max-width: 100%; overflow-x: auto; margin: 10px 0; font-size: 13px; } th, td { padding: 3px 8px; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; } td { white-space: nowrap; } @page { size: A3 landscape; } th { border-bottom: 2px solid #444; vertical-align: bottom; }
td.beyond { color: #b04400; font-weight: bold; } tr.all td { border-top: 2px solid #444; font-weight: bold; }
.verdict { font-size: 17px; border-left: 5px solid #0b4f8a; padding: 6px 14px; background: #f3f6fa; }
.error { color: #a00000; } figure { margin: 18px 0; } figure svg { max-width: 100%; height: auto; }
figcaption { color: #555; max-width: 900px; } .small { display: flex; flex-wrap: wrap; gap: 8px 24px; } .small figure { margin: 8px 0; }
)";

}  // namespace

std::string escaped(const std::string& text) {
    return gis::xml_text(text);
}

std::string html_figure(const Figure& figure) {
    return "<figure>" + figure.svg.substr(figure.svg.find("<svg")) +
           (figure.caption.empty() ? "" : "<figcaption>" + escaped(figure.caption) + "</figcaption>") + "</figure>\n";
}

std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
    std::ostringstream html;
    html << "<table><tr>";
    for (const std::string& h : head) html << "<th>" << escaped(h) << "</th>";
    html << "</tr>\n";
    for (const auto& row : rows) {
        html << "<tr>";
        for (const std::string& cell : row) html << "<td>" << escaped(cell) << "</td>";
        html << "</tr>\n";
    }
    html << "</table>\n";
    return html.str();
}

std::string html_list(const std::vector<std::string>& items) {
    std::string html = "<ul>\n";
    for (const std::string& item : items) html += "<li>" + escaped(item) + "</li>\n";
    return html + "</ul>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
    return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(title) +
           "</title><style>\n" + kStyle + "</style></head><body>\n<h1>" + escaped(title) + "</h1>\n" + body +
           "<p>scree " + version() + "</p>\n</body></html>\n";
}

}  // namespace scree::cli
