// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors: NIST, Cryptographic Standards and Guidelines, "SHA-256 examples"; FIPS 180-2, appendix B.
#include "gis/sha256.hpp"
#include "scree/base/error.hpp"
#include "support/paths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scree::gis {
namespace {

TEST(Sha256, NistVectors) {
    EXPECT_EQ(sha256_of_text(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_of_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of_text("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sha256_of_text(std::string(1'000'000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, PiecesOfAnySizeGiveTheHashOfTheWhole) {
    std::string text;
    for (int i = 0; i < 300; ++i) text.push_back(static_cast<char>(i * 7));
    const std::string whole = sha256_of_text(text);
    for (std::size_t piece : {1U, 3U, 55U, 56U, 63U, 64U, 65U, 128U, 299U}) {
        Sha256 hash;
        for (std::size_t at = 0; at < text.size(); at += piece) hash.update(std::string_view(text).substr(at, piece));
        EXPECT_EQ(hash.hex(), whole) << "pieces of " << piece;
    }
}

TEST(Sha256, FileAndItsErrors) {
    const test::TempDir dir;
    const std::string text(700'001, 'x');  // more than two read buffers and not a multiple of a block
    std::ofstream(dir / "data.bin", std::ios::binary) << text;
    EXPECT_EQ(sha256_of_file(dir / "data.bin"), sha256_of_text(text));
    for (const auto& bad : {dir / "missing.tif", dir.path()}) {
        try {
            sha256_of_file(bad);
            FAIL() << "no error for " << bad;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(bad.string()));
        }
    }
}

}  // namespace
}  // namespace scree::gis
