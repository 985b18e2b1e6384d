// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scree/dynamics/contact_solver.hpp"

#include <iosfwd>
#include <string>

namespace scree {

// A contact problem as text, so that a hard one that a run met can be kept, sent and made a test. It is the format of Siconos' rolling-friction test
// data: numbers separated by blanks,
//     size of a contact (kLocalSize: 3 or 5), number of contacts,
//     W: storage, rows, columns; storage 0 (dense): rows and columns again, then the entries column by column;
//        storage 1 (sparse blocks; read only): 1 number of blocks, block rows, block columns, ends of the block rows and columns, sizes of the two
//        index arrays, row pointers and block columns (compressed rows), then for each block its number and its entries column by column;
//     q contact by contact, mu of each contact, mu_r of each contact.

/// With all digits: reading gives the same numbers.
template <int Dim>
void write_contact_problem(std::ostream& out, const ContactProblem<Dim>& problem);

/// Throws InputError, which names the `source`, what is wrong and what is allowed.
template <int Dim>
ContactProblem<Dim> read_contact_problem(std::istream& in, const std::string& source);

}  // namespace scree
