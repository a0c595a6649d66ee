// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <sys/stat.h>

#include <cstring>
#include <limits>

#include "sample_volume.hpp"

namespace eti::imaging {
namespace {

using test::expect_refused;
using test::expect_same;
using test::sample;

class VolumeFiles : public test::Folder {};

Bytes i16(const Volume& volume) {
    Bytes data;
    for (const float v : volume.value) {
        store(data, static_cast<std::int16_t>(v));
    }
    return data;
}

/// A plain NRRD with one header field changed, or omitted if `value` is empty.
Bytes nrrd_with(const std::string& field, const std::string& value, const Bytes& data,
                const std::string& type = "short") {
    std::string text = "NRRD0004\n";
    const std::vector<std::pair<std::string, std::string>> fields = {
        {"type", type},
        {"dimension", "3"},
        {"space", "left-posterior-superior"},
        {"sizes", "7 6 5"},
        {"space directions", "(0.5,0,0) (0,0.7,0) (0,0,1.5)"},
        {"endian", "little"},
        {"encoding", "raw"},
        {"space origin", "(1,2,3)"}};
    for (const auto& [name, usual] : fields) {
        const std::string& written = name == field ? value : usual;
        if (!written.empty()) {
            text += name + ": " + written + "\n";
        }
    }
    text += "\n";
    Bytes out(text.begin(), text.end());
    out.insert(out.end(), data.begin(), data.end());
    return out;
}

TEST_F(VolumeFiles, RoundTripPreservesVolume) {
    for (const char* name : {"a.nrrd", "a.nii", "a.nii.gz"}) {
        write(sample(), folder / name);
        SCOPED_TRACE(name);
        expect_same(read(folder / name).volume, sample());
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 3) << "a partial file was left";
}

TEST_F(VolumeFiles, RoundTripPreservesLabels) {
    Mask labels{sample().geometry, {}};
    for (std::size_t i = 0; i < labels.geometry.count(); ++i) {
        labels.value.push_back(static_cast<std::uint8_t>(i % 9));
    }
    write(labels, folder / "l.nrrd");
    const Volume back = read(folder / "l.nrrd").volume;
    for (std::size_t i = 0; i < labels.value.size(); ++i) {
        ASSERT_EQ(back.value[i], static_cast<float>(labels.value[i]));
    }
}

TEST_F(VolumeFiles, BigEndianNrrdIsByteSwapped) {
    Bytes data = i16(sample());
    for (std::size_t i = 0; i < data.size(); i += 2) {
        std::swap(data[i], data[i + 1]);
    }
    EXPECT_EQ(read(put("big.nrrd", nrrd_with("endian", "big", data))).volume.value, sample().value);
}

TEST_F(VolumeFiles, RasIsConvertedToLps) {
    const Volume volume =
        read(put("ras.nrrd", nrrd_with("space", "right-anterior-superior", i16(sample())))).volume;
    EXPECT_LT((volume.geometry.origin - Vec3d(-1e-3, -2e-3, 3e-3)).norm(), 1e-12);
    EXPECT_LT((volume.geometry.step.col(0) - Vec3d(-0.5e-3, 0, 0)).norm(), 1e-12);
}

TEST_F(VolumeFiles, BadNrrdHeadersAreRefused) {
    const Bytes data = i16(sample());
    int number = 0;
    const auto refused = [&](const std::string& field, const std::string& value, const std::string& said) {
        SCOPED_TRACE(field + ": " + value);
        expect_refused(put(std::to_string(++number) + ".nrrd", nrrd_with(field, value, data)), said);
    };
    refused("endian", "", "endian");
    refused("endian", "middle", "middle");
    refused("encoding", "bzip2", "bzip2");
    refused("encoding", "gzip", "compressed data are damaged");
    refused("type", "block", "block");
    refused("type", "double", "bytes of voxels");
    refused("space", "scanner-xyz", "scanner-xyz");
    refused("space", "", "space");
    refused("space origin", "", "space origin");
    refused("space directions", "(1,0,0) (0,1,0) (1,1,0)", "nearly dependent");
    refused("space directions", "(0,0,0) (0,1,0) (0,0,1)", "voxel spacing");
    refused("space directions", "none (0,1,0) (0,0,1)", "none");
    refused("sizes", "7 6", "sizes");
    refused("sizes", "7 6 1", "single slice");
    refused("sizes", "7 6 -5", "-5");
    refused("sizes", "7 6 nan", "nan");
    refused("sizes", "2097152 2097152 4194304", "2097152");  // 2^64 voxels
    refused("sizes", "65536 65536 65536", "at most");        // 2^48
    refused("sizes", "7 6 5000", "bytes of voxels");
}

TEST_F(VolumeFiles, NanVoxelIsRefusedWithItsIndex) {
    Bytes data;
    for (int i = 0; i < 7 * 6 * 5; ++i) {
        store(data, i == 7 + 2 ? std::numeric_limits<float>::quiet_NaN() : 0.0f);
    }
    expect_refused(put("nan.nrrd", nrrd_with("type", "float", data, "float")), "(2, 1, 0)");
}

TEST_F(VolumeFiles, TruncatedFilesAreRefused) {
    for (const char* name : {"a.nrrd", "a.nii", "a.nii.gz"}) {
        write(sample(), folder / name);
        const Bytes whole = read_bytes(folder / name);
        for (const std::size_t length : {whole.size() - 12, whole.size() / 2, std::size_t{100}}) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(length));
            const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
            expect_refused(put(std::string("cut-") + name, part), "Remedy");
        }
    }
}

TEST_F(VolumeFiles, NiftiOfOtherByteOrderIsSwapped) {
    const Volume volume = sample();
    Bytes file = encode_nifti(volume.geometry, Scalar::i16, i16(volume));
    // Byte-swaps every number of the header and all voxels.
    const auto turn = [&](std::size_t at, std::size_t size, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k, at += size) {
            std::reverse(file.begin() + static_cast<std::ptrdiff_t>(at),
                         file.begin() + static_cast<std::ptrdiff_t>(at + size));
        }
    };
    turn(0, 4, 1);
    turn(40, 2, 8);
    turn(68, 2, 4);
    turn(76, 4, 11);
    turn(252, 2, 2);
    turn(256, 4, 18);
    turn(352, 2, volume.value.size());
    expect_same(read(put("turned.nii", file)).volume, volume);
}

TEST_F(VolumeFiles, NiftiQuaternionGivesDirections) {
    Volume volume = sample();
    Bytes file = encode_nifti(volume.geometry, Scalar::i16, i16(volume));
    const auto put_at = [&](std::size_t at, auto value) {
        std::memcpy(file.data() + at, &value, sizeof(value));
    };
    put_at(254, std::int16_t{0});  // no sform
    const auto unoriented = put("none.nii", file);
    expect_refused(unoriented, "directions");
    put_at(252, std::int16_t{1});
    put_at(76, 1.0f);
    // In RAS, the quaternion of the rotation that maps the index axes.
    Eigen::Matrix3d ras = Vec3d(-1, -1, 1).asDiagonal() * volume.geometry.step;
    for (int k = 0; k < 3; ++k) {
        ras.col(k).normalize();
    }
    Eigen::Quaterniond q(ras);
    if (q.w() < 0.0) {
        q.coeffs() *= -1.0;
    }
    put_at(256, static_cast<float>(q.x()));
    put_at(260, static_cast<float>(q.y()));
    put_at(264, static_cast<float>(q.z()));
    const Vec3d origin = 1e3 * Vec3d(-1, -1, 1).cwiseProduct(volume.geometry.origin);
    for (int k = 0; k < 3; ++k) {
        put_at(268 + 4 * static_cast<std::size_t>(k), static_cast<float>(origin[k]));
    }
    const Volume back = read(put("q.nii", file)).volume;
    // Floats in the quaternion: 1e-6 of 1.5 mm.
    EXPECT_LT((back.geometry.step - volume.geometry.step).norm(), 5e-9);
    EXPECT_LT((back.geometry.origin - volume.geometry.origin).norm(), 1e-8);
}

TEST_F(VolumeFiles, MirroredNiftiFormsAreRefused) {
    const Volume volume = sample();
    Bytes file = encode_nifti(volume.geometry, Scalar::i16, i16(volume));
    const auto put_at = [&](std::size_t at, auto value) {
        std::memcpy(file.data() + at, &value, sizeof(value));
    };
    // The sample's directions in RAS have a positive determinant. A qform of any rotation has the sign of
    // pixdim[0].
    ASSERT_GT(volume.geometry.step.determinant(), 0.0);
    put_at(252, std::int16_t{1});
    put_at(76, 1.0f);
    EXPECT_NO_THROW((void)read(put("same.nii", file)));
    put_at(76, -1.0f);
    expect_refused(put("mirrored.nii", file), "mirror image");
    put_at(252, std::int16_t{0});
    EXPECT_NO_THROW((void)read(put("sform.nii", file)));
}

TEST_F(VolumeFiles, UndefinedNiftiScaleIsRemarked) {
    const Volume volume = sample();
    Bytes file = encode_nifti(volume.geometry, Scalar::i16, i16(volume));
    const auto put_at = [&](std::size_t at, float value) {
        std::memcpy(file.data() + at, &value, sizeof(value));
    };
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    put_at(112, nan);
    put_at(116, nan);
    const LoadedVolume undefined = read(put("nan.nii", file));
    expect_same(undefined.volume, volume);
    ASSERT_EQ(undefined.remarks.size(), 1u);
    EXPECT_NE(undefined.remarks[0].find("scl_slope is nan"), std::string::npos) << undefined.remarks[0];
    put_at(112, 0.0f);  // unscaled, by nifti1.h
    EXPECT_TRUE(read(put("zero.nii", file)).remarks.empty());
    put_at(112, 2.0f);
    expect_refused(put("inter.nii", file), "scl_inter is nan");
    put_at(116, 0.0f);
    put_at(112, 1.0f);
    put_at(108, 0.0f);  // vox_offset
    expect_same(read(put("offset.nii", file)).volume, volume);
}

TEST_F(VolumeFiles, SegmentNamesAreRead) {
    Bytes file = nrrd_with("", "", Bytes(7 * 6 * 5, 1), "uchar");
    const std::string pairs =
        "Segment0_ID:=a\nSegment0_LabelValue:=3\nSegment0_Name:=Tongue\nSegment1_LabelValue:=1\n"
        "Segment1_Name:=Lower jaw\n";
    const auto end = std::search_n(file.begin(), file.end(), 2, std::uint8_t{'\n'}) + 1;
    file.insert(end, pairs.begin(), pairs.end());
    const LoadedVolume reading = read(put("a.seg.nrrd", file));
    EXPECT_EQ(reading.segments, (std::map<int, std::string>{{1, "Lower jaw"}, {3, "Tongue"}}));
    file[std::string(file.begin(), file.end()).find("LabelValue:=3") + 12] = 'x';
    expect_refused(put("b.seg.nrrd", file), "Segment0_LabelValue is 'x'");
}

TEST_F(VolumeFiles, UnknownAndMissingFilesAreRefused) {
    expect_refused(put("a.txt", Bytes{'h', 'i'}), "unknown format");
    expect_refused(put("empty.nrrd", Bytes{}), "unknown format");
    expect_refused(folder / "absent.nrrd", "does not exist");
    expect_refused("/dev/null", "is a device");
    ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
    expect_refused(folder / "pipe.nrrd", "is a pipe");
    expect_refused(folder, "DICOM");
}

TEST_F(VolumeFiles, NonMillimetreUnitsAreRefused) {
    // 0.6 x 0.6 x 3 mm written in metres, in micrometres, and with two of the three units missing.
    const Bytes data = i16(sample());
    for (const auto& [directions, said] : std::vector<std::pair<std::string, std::string>>{
             {"(0.0006,0,0) (0,0.0006,0) (0,0,0.003)", "in metres"},
             {"(0.1,0,0) (0,0.1,0) (0,0,0.003)", "expected 0.05 to 20 mm"},
             {"(600,0,0) (0,600,0) (0,0,3000)", "expected 0.05 to 20 mm"}}) {
        expect_refused(put("unit.nrrd", nrrd_with("space directions", directions, data)), said);
    }
}

TEST_F(VolumeFiles, OnlyRegularFilesAreOverwritten) {
    ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
    EXPECT_THROW(write(sample(), folder / "pipe.nrrd"), VolumeError);
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe.nrrd"));
    write(sample(), folder / "a.nrrd");
    write(sample(), folder / "a.nrrd");
}

TEST_F(VolumeFiles, DecompressionBombStopsAtHeaderSize) {
    const Bytes zeros(std::size_t{64} << 20, 0);
    const auto file = put("bomb.nrrd", nrrd_with("encoding", "gzip", gzip(zeros)));
    EXPECT_EQ(read(file).volume.value.size(), 7u * 6u * 5u);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(VolumeFiles, MemoryIsLimited) {
    Volume volume = sample();
    volume.geometry.size = {256, 256, 256};
    volume.value.assign(volume.geometry.count(), 0.0f);
    write(volume, folder / "large.nrrd");
    expect_refused(folder / "large.nrrd", "memory", {.memory_bytes = std::uint64_t{48} << 20});
}
#endif

TEST_F(VolumeFiles, FailedWriteLeavesNoFile) {
    EXPECT_THROW(write(sample(), folder / "missing" / "a.nrrd"), VolumeError);
    EXPECT_THROW(write(sample(), folder / "a.png"), VolumeError);
    EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace eti::imaging
