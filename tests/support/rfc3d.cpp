// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/rfc3d.hpp"

#include <fstream>
#include <stdexcept>
#include <vector>

namespace scree::test {

ContactProblem<3> read_rfc3d(const std::filesystem::path& path) {
    std::ifstream in(path);
    auto integer = [&] {
        int value = 0;
        in >> value;
        return value;
    };
    auto real = [&] {
        double value = 0;
        in >> value;
        return value;
    };
    auto integers = [&](int n) {
        std::vector<int> values(static_cast<std::size_t>(n));
        for (int& v : values) v = integer();
        return values;
    };
    if (integer() != 5) throw std::runtime_error("not a 3D rolling-friction problem");
    ContactProblem<3> problem;
    problem.resize(integer());
    const int storage = integer();
    const int rows = integer(), columns = integer();
    problem.delassus.setZero(rows, columns);
    if (storage == 0) {
        integer();
        integer();
        for (int j = 0; j < columns; ++j)
            for (int i = 0; i < rows; ++i) problem.delassus(i, j) = real();
    } else {
        integer();
        const int blocks0 = integer(), blocks1 = integer();
        const auto end0 = integers(blocks0), end1 = integers(blocks1);
        const int filled1 = integer(), filled2 = integer();
        const auto pointer = integers(filled1), column = integers(filled2);
        for (int i = 0; i + 1 < filled1; ++i) {
            const auto ui = static_cast<std::size_t>(i);
            const int r0 = i ? end0[ui - 1] : 0, r1 = end0[ui];
            for (int k = pointer[ui]; k < pointer[ui + 1]; ++k) {
                const auto j = static_cast<std::size_t>(column[static_cast<std::size_t>(k)]);
                const int c0 = j ? end1[j - 1] : 0, c1 = end1[j];
                integer();  // number of the block
                for (int c = c0; c < c1; ++c)
                    for (int r = r0; r < r1; ++r) problem.delassus(r, c) = real();
            }
        }
    }
    for (Eigen::Index i = 0; i < rows; ++i) problem.free_velocity[i] = real();
    for (double& mu : problem.friction) mu = real();
    for (double& mu_r : problem.rolling) mu_r = real();
    if (!in) throw std::runtime_error(path.string() + ": short file");
    return problem;
}

}  // namespace scree::test
