// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gdcmAttribute.h>
#include <gdcmImageWriter.h>
#include <gdcmReader.h>
#include <gdcmWriter.h>

#include "common/math/random.hpp"
#include "sample_volume.hpp"

namespace eti::imaging {
namespace {

using test::expect_refused;

/// Attributes of one slice.
struct Slice {
    Vec3d position = Vec3d::Zero();  ///< [mm]
    std::string series = "1.2.3";
    std::string modality = "CT";
    unsigned rows = 6;
    unsigned columns = 8;
};

const Vec3d row_direction(0.8, 0.6, 0.0);
const Vec3d column_direction(0.0, 0.0, -1.0);
const Vec3d normal = row_direction.cross(column_direction);

void write_slice(const std::filesystem::path& file, const Slice& slice) {
    gdcm::ImageWriter writer;
    gdcm::Image& image = writer.GetImage();
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, slice.columns);
    image.SetDimension(1, slice.rows);
    image.SetPixelFormat(gdcm::PixelFormat(gdcm::PixelFormat::INT16));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    image.SetSpacing(0, 0.5);
    image.SetSpacing(1, 0.75);
    for (unsigned k = 0; k < 3; ++k) {
        image.SetOrigin(k, slice.position[static_cast<int>(k)]);
        image.SetDirectionCosines(k, row_direction[static_cast<int>(k)]);
        image.SetDirectionCosines(k + 3, column_direction[static_cast<int>(k)]);
    }
    image.SetSlope(2.0);
    image.SetIntercept(-1024.0);
    std::vector<std::int16_t> pixels;
    for (unsigned i = 0; i < slice.rows * slice.columns; ++i) {
        pixels.push_back(static_cast<std::int16_t>(i + 100 * std::lround(slice.position.dot(normal))));
    }
    gdcm::DataElement data(gdcm::Tag(0x7fe0, 0x0010));
    data.SetByteValue(reinterpret_cast<const char*>(pixels.data()),
                      static_cast<std::uint32_t>(2 * pixels.size()));
    image.SetDataElement(data);
    gdcm::DataSet& set = writer.GetFile().GetDataSet();
    gdcm::Attribute<0x0008, 0x0016> kind;
    kind.SetValue("1.2.840.10008.5.1.4.1.1.2");  // CT image storage
    set.Replace(kind.GetAsDataElement());
    gdcm::Attribute<0x0008, 0x0060> modality;
    modality.SetValue(slice.modality);
    set.Replace(modality.GetAsDataElement());
    gdcm::Attribute<0x0020, 0x000e> series;
    series.SetValue(slice.series);
    set.Replace(series.GetAsDataElement());
    writer.SetFileName(file.c_str());
    ASSERT_TRUE(writer.Write());
}

/// Replaces the value of a tag in a file by a decimal text; empty: removes the tag.
void put_text(const std::filesystem::path& file, const gdcm::Tag& tag, std::string text) {
    gdcm::Reader reader;
    reader.SetFileName(file.c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::DataSet& set = reader.GetFile().GetDataSet();
    if (text.empty()) {
        set.Remove(tag);
    } else {
        text += text.size() % 2 == 0 ? "" : " ";
        gdcm::DataElement element(tag);
        element.SetVR(gdcm::VR::DS);
        element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
        set.Replace(element);
    }
    gdcm::Writer writer;
    writer.SetFile(reader.GetFile());
    writer.SetFileName(file.c_str());
    ASSERT_TRUE(writer.Write());
}

class Dicom : public test::Folder {
  protected:
    /// Slices 2 mm apart, named so that the files' order is not the slices'.
    void write_series(int count, const Slice& like = {}, const std::string& prefix = "") {
        for (int i = 0; i < count; ++i) {
            Slice slice = like;
            slice.position = Vec3d(10, 20, 30) + 2.0 * i * normal;
            write_slice(folder / (prefix + std::to_string(i * 3 % count) + ".dcm"), slice);
        }
    }
};

TEST_F(Dicom, SlicesAreStackedByPosition) {
    write_series(5);
    const LoadedVolume reading = read(folder);
    const Geometry& g = reading.volume.geometry;
    EXPECT_EQ(g.size, (std::array<int, 3>{8, 6, 5}));
    EXPECT_LT((g.origin - Vec3d(10e-3, 20e-3, 30e-3)).norm(), 1e-9);
    EXPECT_LT((g.step.col(0) - 0.5e-3 * row_direction).norm(), 1e-9);
    EXPECT_LT((g.step.col(1) - 0.75e-3 * column_direction).norm(), 1e-9);
    EXPECT_LT((g.step.col(2) - 2e-3 * normal).norm(), 1e-9);
    const double first = Vec3d(10, 20, 30).dot(normal);
    for (int z = 0; z < 5; ++z) {
        const auto raw = static_cast<float>(3 + 100 * std::lround(first + 2.0 * z));
        EXPECT_EQ(reading.volume.at(3, 0, z), 2.0f * raw - 1024.0f);
    }
}

TEST_F(Dicom, OneSliceIsRefused) {
    write_series(1);
    expect_refused(folder, "whole series");
}

TEST_F(Dicom, MissingSliceIsRefused) {
    write_series(7);
    std::filesystem::remove(folder / "0.dcm");  // the first
    EXPECT_NO_THROW((void)read(folder));
    std::filesystem::remove(folder / "5.dcm");
    expect_refused(folder, "mm apart");  // slice 4 of 7
}

TEST_F(Dicom, TruncatedFileIsRefused) {
    write_series(5);
    const auto file = folder / "2.dcm";
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 30);
    try {
        (void)read(folder);
        FAIL();
    } catch (const VolumeError& error) {
        EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("Remedy"), std::string::npos) << error.what();
    }
}

TEST_F(Dicom, OtherModalityIsRefused) {
    Slice magnetic;
    magnetic.modality = "MR";
    write_series(5, magnetic);
    expect_refused(folder, "MR");
}

TEST_F(Dicom, LargestSeriesIsUsedAndOthersReported) {
    write_series(5);
    Slice scout;
    scout.series = "9.9.9";
    write_series(2, scout, "scout-");
    std::ofstream(folder / "readme.txt") << "not DICOM";
    const LoadedVolume reading = read(folder);
    EXPECT_EQ(reading.volume.geometry.size[2], 5);
    ASSERT_EQ(reading.remarks.size(), 2u);
    EXPECT_NE(reading.remarks[0].find("9.9.9"), std::string::npos) << reading.remarks[0];
}

TEST_F(Dicom, InvalidSpacingOrOrientationIsRefused) {
    const gdcm::Tag spacing(0x0028, 0x0030), directions(0x0020, 0x0037);
    const auto tried = [&](const gdcm::Tag& tag, const std::string& text, const std::string& said) {
        SCOPED_TRACE(text);
        write_series(4);
        for (int i = 0; i < 4; ++i) {
            put_text(folder / (std::to_string(i) + ".dcm"), tag, text);
        }
        expect_refused(folder, said);
    };
    // GDCM reads most of these as 1 mm and as the axes.
    for (const char* const text : {"0\\0", "0.5\\0", "-0.5\\0.5", "0.5", "nan\\nan", "wide\\wide", ""}) {
        tried(spacing, text, "Pixel Spacing");
    }
    for (const char* const text : {"1\\0\\0\\1\\0\\0", "0\\0\\0\\0\\0\\0", "1\\0\\0\\0.7\\0.7\\0",
                                   "2\\0\\0\\0\\1\\0", "1\\0\\0", "nan\\0\\0\\0\\1\\0", ""}) {
        tried(directions, text, "Image Orientation");
    }
    // As scanners write them: rounded, with signs and spaces.
    write_series(4);
    for (int i = 0; i < 4; ++i) {
        put_text(folder / (std::to_string(i) + ".dcm"), spacing, "+0.75 \\0.50");
        put_text(folder / (std::to_string(i) + ".dcm"), directions, "0.8\\0.6001\\0\\0\\0\\-1");
    }
    EXPECT_NEAR(read(folder).volume.geometry.spacing().x(), 0.5e-3, 1e-9);
}

TEST_F(Dicom, UnequalSlicesAreRefused) {
    write_series(5);
    Slice wide;
    wide.columns = 10;
    wide.position = Vec3d(10, 20, 30) + 10.0 * normal;
    write_slice(folder / "wide.dcm", wide);
    expect_refused(folder, "series' first slice");
}

TEST_F(Dicom, DamagedFilesAreRefusedOrHarmless) {
    write_series(4);
    std::vector<Bytes> whole;
    for (int k = 0; k < 4; ++k) {
        whole.push_back(read_bytes(folder / (std::to_string(k) + ".dcm")));
    }
    Random random(1902);
    int refusals = 0;
    constexpr int rounds = 150;
    for (int round = 0; round < rounds; ++round) {
        const std::size_t which = random.bits() % whole.size();
        Bytes data = whole[which];
        for (int flips = 1 + static_cast<int>(random.bits() % 6); flips > 0; --flips) {
            data[random.bits() % data.size()] = static_cast<std::uint8_t>(random.bits());
        }
        if (round % 5 == 0) {
            data.resize(random.bits() % data.size());
        }
        const std::filesystem::path file = folder / (std::to_string(which) + ".dcm");
        write_bytes(file, data);
        try {
            // In a child process: any failure of the library becomes an error there.
            const LoadedVolume reading = read(folder, {.processor_seconds = 10});
            EXPECT_EQ(reading.volume.value.size(), reading.volume.geometry.count());
            require_finite(reading.volume, "round");
        } catch (const VolumeError& error) {
            ++refusals;
            EXPECT_NE(std::string(error.what()).find(folder.string()), std::string::npos) << error.what();
        }
        write_bytes(file, whole[which]);
    }
    // Changed pixels may go unnoticed; changed tags and lengths may not.
    EXPECT_GT(refusals, rounds / 10);
    EXPECT_LT(refusals, rounds);
}

}  // namespace
}  // namespace eti::imaging
