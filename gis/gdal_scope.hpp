// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace scree::gis {

/// Registers GDAL's drivers once and collects GDAL's messages of this thread while it lives, so that nothing goes to stderr behind
/// our back and the reason of a failure can be quoted. Scopes nest; a message goes to the innermost.
class GdalScope {
public:
    GdalScope();
    ~GdalScope();
    GdalScope(const GdalScope&) = delete;
    GdalScope& operator=(const GdalScope&) = delete;

    /// GDAL's warnings and errors so far, in order.
    const std::vector<std::string>& messages() const { return messages_; }
    /// The last error, as a clause to put behind our own sentence ("; GDAL says: ..."), or nothing.
    std::string reason() const;
    void clear();

private:
    friend void collect_gdal_message(int severity, const char* text);
    std::vector<std::string> messages_;
    std::string last_error_;
};

}  // namespace scree::gis
