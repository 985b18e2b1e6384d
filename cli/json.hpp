// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace scree::cli {

/// JSON as all reports write it: keys in the order in which they were set.
using Json = nlohmann::ordered_json;

/// Indented by `indent` blanks per level, on one line if that is negative. Bytes that are no UTF-8, as of a file name, are replaced: no result is lost over one.
inline std::string json_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace scree::cli
