// SPDX-License-Identifier: GPL-3.0-or-later
#include "gis/vector_reader.hpp"
#include "gis/words.hpp"
#include "scree/base/error.hpp"

#include <charconv>
#include <cmath>

namespace scree::gis {

namespace {

constexpr std::size_t kListed = 5;  // how many offenders a message names

std::string place_of(const VectorData& data) {
    return words("'", data.report.file, "', layer '", data.report.layer, "'");
}

// A list of offenders that stays short.
class Offenders {
public:
    void add(std::int64_t id, const std::string& value) {
        if (++count_ <= kListed) text_ += words(count_ > 1 ? ", " : "", "feature ", id, ": ", value);
    }
    bool empty() const { return count_ == 0; }
    std::string text() const { return count_ > kListed ? words(text_, " and ", count_ - kListed, " more") : text_; }

private:
    std::size_t count_ = 0;
    std::string text_;
};

std::string shown(const FieldValue& value) {
    if (const auto* i = std::get_if<std::int64_t>(&value)) return words(*i);
    if (const auto* d = std::get_if<double>(&value)) return shortest(*d);
    if (const auto* s = std::get_if<std::string>(&value)) return words("'", *s, "'");
    return "no value";
}

// NaN where the value is no number.
double as_number(const FieldValue& value) {
    if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
    if (const auto* d = std::get_if<double>(&value)) return *d;
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return kNaN;
    double number = 0;
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
    return error == std::errc() && end == text->data() + text->size() ? number : kNaN;
}

std::string allowed(const NumberRule& rule) {
    std::string text = "a finite number";
    if (std::isfinite(rule.low)) text += words(rule.low_included ? " of at least " : " greater than ", rule.low);
    if (std::isfinite(rule.high)) text += words(std::isfinite(rule.low) ? " and" : "", " of at most ", rule.high);
    return text;
}

}  // namespace

std::size_t field_index(const VectorData& data, const std::string& field) {
    std::string names;
    for (std::size_t f = 0; f < data.layer.fields.size(); ++f) {
        if (data.layer.fields[f].name == field) return f;
        names += words(f > 0 ? ", '" : "'", data.layer.fields[f].name, "'");
    }
    throw InputError(words(place_of(data), " has no field '", field, "'; it has ", names.empty() ? "no fields" : names,
                           "; name the one to use with the key field beside that of the file."));
}

std::vector<double> number_field(const VectorData& data, const NumberRule& rule) {
    const std::size_t field = field_index(data, rule.field);
    std::vector<double> numbers;
    Offenders wrong;
    for (const Feature& feature : data.layer.features) {
        const FieldValue& value = feature.values[field];
        const double x = as_number(value);
        const bool fits = std::isfinite(x) && x <= rule.high && (rule.low_included ? x >= rule.low : x > rule.low);
        const bool missing = std::holds_alternative<std::monostate>(value) && rule.null_allowed;
        if (!fits && !missing) wrong.add(feature.id, shown(value));
        numbers.push_back(missing ? kNaN : x);
    }
    if (!wrong.empty()) {
        throw InputError(words(place_of(data), " has values in the field '", rule.field,
                               "' that are not allowed: ", wrong.text(), "; each must be ", allowed(rule), "."));
    }
    return numbers;
}

std::vector<std::string> text_field(const VectorData& data, const std::string& field) {
    const std::size_t index = field_index(data, field);
    std::vector<std::string> texts;
    Offenders wrong;
    for (const Feature& feature : data.layer.features) {
        const FieldValue& value = feature.values[index];
        const auto* text = std::get_if<std::string>(&value);
        const bool blank = text && text->find_first_not_of(" \t\r\n") == std::string::npos;
        if (std::holds_alternative<std::monostate>(value) || blank) wrong.add(feature.id, "no value");
        texts.push_back(text ? *text : shown(value));
    }
    if (!wrong.empty())
        throw InputError(
            words(place_of(data), " lacks values in the field '", field, "': ", wrong.text(), "; fill them in."));
    return texts;
}

}  // namespace scree::gis
