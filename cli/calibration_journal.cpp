// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/calibration_journal.hpp"

#include "cli/json.hpp"
#include "scree/base/error.hpp"

#include <sstream>

namespace scree::cli {

namespace {

std::string line_of(const CalibrationEvaluation& e) {
    Json json;
    json["stage"] = kCalibrationStageNames[static_cast<std::size_t>(e.task.stage)];
    json["values"] = e.task.point.values;
    json["levels"] = e.task.point.levels;
    json["seed"] = e.task.seed;
    json["repeats"] = e.task.repeats;
    json["loss"] = e.result.loss;
    json["floor"] = e.result.floor;
    json["loss_at"] = e.result.loss_at;
    json["floor_at"] = e.result.floor_at;
    json["log_loss"] = e.result.log_loss;
    return json_text(json, -1);
}

CalibrationEvaluation evaluation_of(const Json& json) {
    CalibrationEvaluation e;
    const std::string stage = json.at("stage");
    for (std::size_t k = 0; k < kCalibrationStageNames.size(); ++k)
        if (stage == kCalibrationStageNames[k]) e.task.stage = static_cast<CalibrationStage>(k);
    json.at("values").get_to(e.task.point.values);
    json.at("levels").get_to(e.task.point.levels);
    json.at("seed").get_to(e.task.seed);
    json.at("repeats").get_to(e.task.repeats);
    json.at("loss").get_to(e.result.loss);
    json.at("floor").get_to(e.result.floor);
    json.at("loss_at").get_to(e.result.loss_at);
    json.at("floor_at").get_to(e.result.floor_at);
    json.at("log_loss").get_to(e.result.log_loss);
    return e;
}

}  // namespace

JournalFile::JournalFile(std::filesystem::path file, const std::string& subject, bool resume) : file_(std::move(file)) {
    lock_.hold(file_, "another calibration");
    if (resume) read(subject);
    std::error_code error;  // of the folder it does not matter: what does is whether the file can be written then
    if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), error);
    // written anew, without a last line that was cut short, and in the place of the old one when it is whole
    std::filesystem::path draft = file_;
    draft += ".part";
    out_.open(draft, std::ios::binary | std::ios::trunc);
    out_ << subject << "\n";
    try {
        write(journal);
    } catch (const ComputeError&) {
        std::filesystem::remove(draft, error);
        throw;
    }
    std::filesystem::rename(draft, file_, error);
    if (error) throw ComputeError(file_.string() + " cannot be written: " + error.message());
    lock_.hold(file_, "another calibration");
}

bool JournalFile::is_one(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    if (!std::getline(in, line)) return in.eof();  // ended before it had begun
    const Json json = Json::parse(line, nullptr, false);
    return json.is_object() && json.contains("calibration");
}

void JournalFile::read(const std::string& subject) {
    std::ifstream in(file_, std::ios::binary);
    std::string line;
    if (!in)
        throw InputError("there is no calibration to go on with: " + file_.string() +
                         " does not exist or cannot be read; begin one without --resume");
    if (!std::getline(in, line)) return;  // ended before it had begun
    if (line != subject)
        throw InputError(file_.string() +
                         " belongs to a calibration of something else: the site, its inputs, the measurements, the "
                         "free parameters and the "
                         "settings must be those of then; begin anew with --overwrite");
    while (std::getline(in, line)) {
        const Json json = Json::parse(line, nullptr, false);
        if (json.is_discarded()) break;  // cut short
        try {
            journal.push_back(evaluation_of(json));
        } catch (const Json::exception&) {
            throw InputError(file_.string() + ": line " + std::to_string(journal.size() + 2) +
                             " is no simulation of a calibration: restore the file, or begin anew with --overwrite");
        }
    }
}

void JournalFile::write(const CalibrationJournal& all) {
    for (; written_ < all.size(); ++written_) out_ << line_of(all[written_]) << "\n";
    out_.flush();
    check();
}

void JournalFile::check() const {
    if (!out_) throw ComputeError(file_.string() + " cannot be written: check the folder and the space on the disc");
}

std::string JournalFile::text() const {
    std::ifstream in(file_, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
}

void JournalFile::remove() {
    out_.close();
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

}  // namespace scree::cli
