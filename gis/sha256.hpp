// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace scree::gis {

/// SHA-256 (FIPS 180-4) of a stream of bytes: the identity of input files in the provenance and of the files of a result.
class Sha256 {
public:
    Sha256();
    void update(std::string_view bytes);
    /// 64 lower-case hexadecimal digits. Ends the stream: update() must not follow.
    std::string hex();

private:
    void compress(const unsigned char* block);

    std::array<std::uint32_t, 8> state_;
    std::array<unsigned char, 64> pending_{};  ///< bytes that do not fill a block yet
    std::size_t pending_size_ = 0;             ///< how many of them [byte]
    std::uint64_t length_ = 0;                 ///< bytes seen so far [byte]
};

std::string sha256_of_text(std::string_view text);

/// Reads the file in pieces. Throws InputError where it cannot be read to its end.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace scree::gis
