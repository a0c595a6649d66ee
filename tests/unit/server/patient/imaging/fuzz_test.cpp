// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include "common/math/random.hpp"
#include "sample_volume.hpp"

namespace eti::imaging {
namespace {

using test::sample;

/// Every format with a reader of our own, as a complete file.
std::vector<std::pair<std::string, Bytes>> seeds() {
    Bytes data;
    for (const float v : sample().value) {
        store(data, static_cast<std::int16_t>(v));
    }
    const Bytes nifti = encode_nifti(sample().geometry, Scalar::i16, data);
    const std::string plist =
        "<plist><dict><key>matrix</key><dict><key>dtype</key><string>int16</string><key>filename</key>"
        "<string>matrix.dat</string><key>shape</key><array><integer>5</integer><integer>6</integer>"
        "<integer>7</integer></array></dict><key>spacing</key><array><real>1.0</real><real>1.0</real>"
        "<real>2.0</real></array></dict></plist>";
    Bytes tar;
    const auto add = [&](const std::string& name, const Bytes& content) {
        const std::size_t at = tar.size();
        tar.resize(at + 512 + (content.size() + 511) / 512 * 512, 0);
        std::copy(name.begin(), name.end(), tar.begin() + static_cast<std::ptrdiff_t>(at));
        const std::string size = fmt::format("{:011o}", content.size());
        std::copy(size.begin(), size.end(), tar.begin() + static_cast<std::ptrdiff_t>(at + 124));
        std::copy(content.begin(), content.end(), tar.begin() + static_cast<std::ptrdiff_t>(at + 512));
    };
    add("project/main.plist", Bytes(plist.begin(), plist.end()));
    add("project/matrix.dat", data);
    tar.resize(tar.size() + 1024, 0);
    return {{"nrrd", encode_nrrd(sample().geometry, Scalar::i16, data)},
            {"nifti", nifti},
            {"nifti.gz", gzip(nifti)},
            {"inv3", tar}};
}

/// Returns whether the bytes were accepted; the volume is valid then. Any other outcome than this and a
/// VolumeError ends the test.
bool accepted(const std::string& kind, const Bytes& data) {
    try {
        const Volume volume = kind == "nrrd"   ? parse_nrrd(data, "file")
                              : kind == "inv3" ? parse_inv3(data, "file")
                                               : parse_nifti(data, "file");
        EXPECT_EQ(volume.value.size(), volume.geometry.count()) << kind;
        require_valid(volume.geometry, "file");
        return true;
    } catch (const VolumeError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("file: ", 0), 0u) << error.what();
        return false;
    }
}

TEST(Fuzz, TruncatedVolumesAreRefused) {
    for (const auto& [kind, whole] : seeds()) {
        ASSERT_TRUE(accepted(kind, whole)) << kind;
        // The archive ends in empty blocks, and compressed data in a checksum, which are not required.
        const std::size_t needed = whole.size() - (kind == "inv3" ? 1200 : 16);
        for (std::size_t length = 0; length < needed; length += 1 + length / 50) {
            const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
            ASSERT_FALSE(accepted(kind, part)) << kind << " of " << length << " bytes";
        }
    }
}

TEST(Fuzz, DamagedVolumesAreRefusedOrHarmless) {
    Random random(2020);
    for (const auto& [kind, whole] : seeds()) {
        std::size_t refused = 0;
        for (int round = 0; round < 1500; ++round) {
            Bytes data = whole;
            for (int flips = 1 + static_cast<int>(random.bits() % 4); flips > 0; --flips) {
                // Mostly in the header.
                const std::size_t reach =
                    round % 4 == 0 ? data.size() : std::min<std::size_t>(data.size(), 420);
                std::uint8_t& byte = data[random.bits() % reach];
                byte = round % 2 == 0 ? static_cast<std::uint8_t>(byte ^ 1u << random.bits() % 8)
                                      : static_cast<std::uint8_t>("0123456789-.() \n:e"[random.bits() % 18]);
            }
            refused += accepted(kind, data) ? 0 : 1;
        }
        EXPECT_GT(refused, 100u) << kind << ": damage goes unnoticed";
    }
}

}  // namespace
}  // namespace eti::imaging
