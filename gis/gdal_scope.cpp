// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/gdal_scope.hpp"

#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <mutex>
#include <string>

namespace scree::gis {

void collect_gdal_message(int severity, const char* text) {
    auto* scope = static_cast<GdalScope*>(CPLGetErrorHandlerUserData());
    if (severity < CE_Warning) return;
    // a damaged file can make a driver complain about every row, each time quoting the complaint before
    constexpr std::size_t kMaxMessages = 50, kMaxLength = 1000;
    const std::string message = std::string(text).substr(0, kMaxLength);
    if (scope->messages_.size() < kMaxMessages) scope->messages_.push_back(message);
    if (severity >= CE_Failure) scope->last_error_ = message;
}

namespace {
void CPL_STDCALL handler(CPLErr severity, CPLErrorNum, const char* text) {
    collect_gdal_message(severity, text);
}
}  // namespace

GdalScope::GdalScope() {
    static std::once_flag once;
    std::call_once(once, [] { GDALAllRegister(); });
    CPLPushErrorHandlerEx(handler, this);
}

GdalScope::~GdalScope() {
    CPLPopErrorHandler();
}

std::string GdalScope::reason() const {
    const std::size_t end = last_error_.find_last_not_of(". \n");  // our sentence goes on or has its own full stop
    return end == std::string::npos ? std::string() : "; GDAL says: " + last_error_.substr(0, end + 1);
}

void GdalScope::clear() {
    messages_.clear();
    last_error_.clear();
}

}  // namespace scree::gis
