// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/geometry/types.hpp"

#include <memory>
#include <optional>
#include <string>

namespace scree::gis {

/// Transforms horizontal positions between two CRSs with the most accurate operation that PROJ has for each place; x is always
/// the easting or longitude [m or degrees], whatever order the CRS defines. Never a ballpark: PROJ would shift positions by
/// hundreds of metres without a word.
class CrsTransform {
public:
    /// Both as WKT. Throws InputError where there is no known transformation; `place` begins the message.
    CrsTransform(const std::string& from, const std::string& to, const std::string& place);
    ~CrsTransform();
    CrsTransform(CrsTransform&&) noexcept;
    CrsTransform& operator=(CrsTransform&&) noexcept;

    /// The position in the target CRS, none if it has none there.
    std::optional<Vec2> operator()(const Vec2& p);
    /// What was last used: PROJ's name of the operation and its accuracy [m], NaN if not stated.
    struct Operation {
        std::string name;
        double accuracy = kNaN;  ///< [m]
    };
    Operation last_operation() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace scree::gis
