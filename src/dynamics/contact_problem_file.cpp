// SPDX-License-Identifier: GPL-3.0-or-later
#include "scree/dynamics/contact_problem_file.hpp"

#include "scree/base/error.hpp"

#include <iomanip>
#include <istream>
#include <limits>
#include <ostream>

namespace scree {

namespace {

/// Most contacts that a file may have: beyond this it is not what it says it is.
constexpr int kMostContacts = 10000;

class Reader {
public:
    Reader(std::istream& in, const std::string& source) : in_(in), source_(source) {}

    double real(const char* what) {
        double value = 0.0;
        if (!(in_ >> value)) fail(what, "a number is missing or is none");
        ++numbers_;
        return value;
    }
    int integer(const char* what, int least, int most) {
        const double value = real(what);
        if (!(value >= least && value <= most) || value != static_cast<int>(value))
            fail(what, "a whole number from " + std::to_string(least) + " to " + std::to_string(most) + " is allowed");
        return static_cast<int>(value);
    }
    /// Numbers that do not fall.
    std::vector<int> ascending(const char* what, int count, int least, int most) {
        std::vector<int> values(static_cast<std::size_t>(count));
        for (int& v : values) least = v = integer(what, least, most);
        return values;
    }
    [[noreturn]] void fail(const char* what, const std::string& why) const {
        throw InputError(source_ + ": number " + std::to_string(numbers_ + 1) + " (" + what + "): " + why +
                         "; take a contact problem as Scree writes it");
    }

private:
    std::istream& in_;
    const std::string& source_;
    std::int64_t numbers_ = 0;
};

void read_dense(Reader& read, Eigen::MatrixXd& matrix) {
    const auto rows = static_cast<int>(matrix.rows());
    read.integer("rows", rows, rows);
    read.integer("columns", rows, rows);
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
        for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix(i, j) = read.real("entry of W");
}

void read_blocks(Reader& read, Eigen::MatrixXd& matrix) {
    const auto rows = static_cast<int>(matrix.rows());
    const int most_blocks = rows * rows;
    read.integer("number of blocks", 0, most_blocks);
    const int block_rows = read.integer("block rows", 1, rows), block_columns = read.integer("block columns", 1, rows);
    const auto row_end = read.ascending("end of a block row", block_rows, 0, rows);
    const auto column_end = read.ascending("end of a block column", block_columns, 0, rows);
    const int pointers = read.integer("size of the row pointers", 1, block_rows + 1);
    const int blocks = read.integer("size of the block columns", 0, most_blocks);
    const auto pointer = read.ascending("row pointer", pointers, 0, blocks);
    std::vector<int> column(static_cast<std::size_t>(blocks));
    for (int& c : column) c = read.integer("block column", 0, block_columns - 1);
    for (std::size_t i = 0; i + 1 < pointer.size(); ++i) {
        for (int k = pointer[i]; k < pointer[i + 1]; ++k) {
            const auto j = static_cast<std::size_t>(column[static_cast<std::size_t>(k)]);
            read.integer("number of a block", 0, most_blocks);
            for (int c = j > 0 ? column_end[j - 1] : 0; c < column_end[j]; ++c)
                for (int r = i > 0 ? row_end[i - 1] : 0; r < row_end[i]; ++r) matrix(r, c) = read.real("entry of W");
        }
    }
}

}  // namespace

template <int Dim>
void write_contact_problem(std::ostream& out, const ContactProblem<Dim>& problem) {
    const Eigen::Index size = problem.free_velocity.size();
    out << std::setprecision(std::numeric_limits<double>::max_digits10);
    out << kLocalSize<Dim> << "\n" << problem.count << "\n0 " << size << " " << size << "\n" << size << " " << size;
    for (Eigen::Index j = 0; j < size; ++j)
        for (Eigen::Index i = 0; i < size; ++i) out << (i == 0 ? "\n" : " ") << problem.delassus(i, j);
    for (Eigen::Index i = 0; i < size; ++i) out << (i == 0 ? "\n" : " ") << problem.free_velocity[i];
    for (std::size_t c = 0; c < problem.friction.size(); ++c) out << (c == 0 ? "\n" : " ") << problem.friction[c];
    for (std::size_t c = 0; c < problem.rolling.size(); ++c) out << (c == 0 ? "\n" : " ") << problem.rolling[c];
    out << "\n";
}

template <int Dim>
ContactProblem<Dim> read_contact_problem(std::istream& in, const std::string& source) {
    Reader read(in, source);
    read.integer("size of a contact", kLocalSize<Dim>, kLocalSize<Dim>);
    ContactProblem<Dim> problem;
    problem.resize(read.integer("number of contacts", 1, kMostContacts));
    problem.delassus.setZero();
    const auto size = static_cast<int>(problem.free_velocity.size());
    const int storage = read.integer("storage of W", 0, 1);
    read.integer("rows", size, size);
    read.integer("columns", size, size);
    if (storage == 0)
        read_dense(read, problem.delassus);
    else
        read_blocks(read, problem.delassus);
    for (Eigen::Index i = 0; i < size; ++i) problem.free_velocity[i] = read.real("q");
    for (double& mu : problem.friction) mu = read.real("mu");
    for (double& mu_r : problem.rolling) mu_r = read.real("mu_r");
    return problem;
}

template void write_contact_problem<2>(std::ostream&, const ContactProblem<2>&);
template void write_contact_problem<3>(std::ostream&, const ContactProblem<3>&);
template ContactProblem<2> read_contact_problem<2>(std::istream&, const std::string&);
template ContactProblem<3> read_contact_problem<3>(std::istream&, const std::string&);

}  // namespace scree
