// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/app.hpp"

#include <csignal>
#include <iostream>

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of writing, with a sentence
    return scree::cli::run({argv + 1, argv + argc}, std::cout, std::cerr);
}
