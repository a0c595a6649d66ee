// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gdcmAttribute.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gdcmReader.h>
#include <gdcmWriter.h>
#include <gmock/gmock.h>

#include "common/math/random.hpp"
#include "sample_volume.hpp"
#include "tests/support/error_of.hpp"

namespace eti::imaging {
namespace {

using test::expect_refused;

const Vec3d row_direction(0.8, 0.6, 0.0);
const Vec3d column_direction(0.0, 0.0, -1.0);
const Vec3d normal = row_direction.cross(column_direction);

/// Attributes of one slice.
struct Slice {
    Vec3d position = Vec3d::Zero();  ///< [mm]
    std::string series = "1.2.3";
    std::string modality = "CT";
    std::string sop_class = "1.2.840.10008.5.1.4.1.1.2";  // CT image storage
    std::string image_type;
    Vec3d row = row_direction;
    Vec3d column = column_direction;
    gdcm::TransferSyntax::TSType syntax = gdcm::TransferSyntax::ExplicitVRLittleEndian;
    unsigned rows = 6;
    unsigned columns = 8;
};

void write_slice(const std::filesystem::path& file, const Slice& slice) {
    gdcm::ImageWriter writer;
    gdcm::Image& image = writer.GetImage();
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, slice.columns);
    image.SetDimension(1, slice.rows);
    image.SetPixelFormat(gdcm::PixelFormat(gdcm::PixelFormat::INT16));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetTransferSyntax(slice.syntax);
    image.SetSpacing(0, 0.5);
    image.SetSpacing(1, 0.75);
    for (unsigned k = 0; k < 3; ++k) {
        image.SetOrigin(k, slice.position[static_cast<int>(k)]);
        image.SetDirectionCosines(k, slice.row[static_cast<int>(k)]);
        image.SetDirectionCosines(k + 3, slice.column[static_cast<int>(k)]);
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
    kind.SetValue(slice.sop_class);
    set.Replace(kind.GetAsDataElement());
    gdcm::Attribute<0x0008, 0x0060> modality;
    modality.SetValue(slice.modality);
    set.Replace(modality.GetAsDataElement());
    gdcm::Attribute<0x0020, 0x000e> series;
    series.SetValue(slice.series);
    set.Replace(series.GetAsDataElement());
    if (!slice.image_type.empty()) {
        gdcm::DataElement type(gdcm::Tag(0x0008, 0x0008));
        type.SetVR(gdcm::VR::CS);
        type.SetByteValue(slice.image_type.data(), static_cast<std::uint32_t>(slice.image_type.size()));
        set.Replace(type);
    }
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

/// Compresses a slice without loss.
void compress(const std::filesystem::path& file) {
    gdcm::ImageReader reader;
    reader.SetFileName(file.c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(gdcm::TransferSyntax::RLELossless);
    change.SetInput(reader.GetImage());
    ASSERT_TRUE(change.Change());
    gdcm::ImageWriter writer;
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    writer.SetFileName(file.c_str());
    ASSERT_TRUE(writer.Write());
}

/// An object without pixels.
void write_object(const std::filesystem::path& file, const std::string& sop_class,
                  const std::string& modality) {
    gdcm::Writer writer;
    gdcm::DataSet& set = writer.GetFile().GetDataSet();
    gdcm::Attribute<0x0008, 0x0016> kind;
    kind.SetValue(sop_class);
    set.Replace(kind.GetAsDataElement());
    gdcm::Attribute<0x0008, 0x0018> instance;
    instance.SetValue("1.2.3.4");
    set.Replace(instance.GetAsDataElement());
    if (!modality.empty()) {
        gdcm::Attribute<0x0008, 0x0060> made;
        made.SetValue(modality);
        set.Replace(made.GetAsDataElement());
    }
    gdcm::Attribute<0x0020, 0x000e> series;
    series.SetValue("1.2.3");
    set.Replace(series.GetAsDataElement());
    writer.GetFile().GetHeader().SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
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
    expect_refused(folder, "gaps of 2.00 and 4.00 mm between slices");  // slice 4 of 7
}

TEST_F(Dicom, TruncatedFileIsRefused) {
    write_series(5);
    const auto file = folder / "2.dcm";
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 30);
    EXPECT_THAT(eti::test::error_of<VolumeError>([&] { (void)read(folder); }),
                ::testing::AllOf(::testing::HasSubstr(file.string()), ::testing::HasSubstr("Remedy")));
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
    ASSERT_EQ(reading.remarks.size(), 1u);
    for (const char* said :
         {"series 1.2.3 (5 slices)", "series 9.9.9 (2 slices)", "1 file that is not DICOM"}) {
        EXPECT_NE(reading.remarks[0].find(said), std::string::npos) << reading.remarks[0];
    }
}

TEST_F(Dicom, ForeignObjectsAreLeftOut) {
    // As on a patient's disc: slices in folders, among everything else that a scanner stores.
    std::filesystem::create_directories(folder / "DICOM" / "S1");
    std::filesystem::create_directories(folder / "DICOM" / "S2");
    write_series(5, {}, "DICOM/S1/");
    Slice magnetic;
    magnetic.modality = "MR";
    write_slice(folder / "DICOM" / "S2" / "mr.dcm", magnetic);
    Slice capture;
    capture.sop_class = "1.2.840.10008.5.1.4.1.1.7";
    write_slice(folder / "DICOM" / "S1" / "capture.dcm", capture);
    Slice drawn;  // a dose report as an image, without a position
    drawn.image_type = "DERIVED\\SECONDARY\\OTHER ";
    write_slice(folder / "DICOM" / "S1" / "drawn.dcm", drawn);
    put_text(folder / "DICOM" / "S1" / "drawn.dcm", gdcm::Tag(0x0020, 0x0032), "");
    Slice scout;
    scout.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER ";
    write_slice(folder / "DICOM" / "S1" / "scout.dcm", scout);
    Slice other = {};  // a scout that is not labelled as one
    other.row = normal;
    write_slice(folder / "DICOM" / "S1" / "other.dcm", other);
    write_object(folder / "DICOMDIR", "1.2.840.10008.1.3.10", "");
    write_object(folder / "DICOM" / "S2" / "dose.dcm", "1.2.840.10008.5.1.4.1.1.88.67", "SR");
    write_object(folder / "DICOM" / "S2" / "state.dcm", "1.2.840.10008.5.1.4.1.1.11.1", "PR");
    write_object(folder / "DICOM" / "S1" / "raw.dcm", "1.2.840.10008.5.1.4.1.1.66", "CT");
    const LoadedVolume reading = read(folder);
    EXPECT_EQ(reading.volume.geometry.size, (std::array<int, 3>{8, 6, 5}));
    ASSERT_EQ(reading.remarks.size(), 1u);
    for (const char* said :
         {"1 DICOMDIR", "1 MR image", "2 screen captures", "1 scout image", "1 dose report",
          "1 PR object without pixels", "1 object without pixels", "1 image in another direction"}) {
        EXPECT_NE(reading.remarks[0].find(said), std::string::npos) << said << ": " << reading.remarks[0];
    }
}

TEST_F(Dicom, EqualSeriesAreListedForAChoice) {
    write_series(5);
    Slice sharp;
    sharp.series = "1.2.4";
    write_series(5, sharp, "sharp-");
    expect_refused(folder, "1.2.3 (5 slices), 1.2.4 (5 slices)");
    EXPECT_EQ(read(folder, {}, "1.2.4").volume.geometry.size[2], 5);
    EXPECT_THAT(eti::test::error_of<VolumeError>([&] { (void)read(folder, {}, "1.2.5"); }),
                ::testing::HasSubstr("one of 1.2.3 (5 slices), 1.2.4"));
}

TEST_F(Dicom, SeriesThatFormsAVolumeIsPreferred) {
    write_series(5);
    Slice thick;
    thick.series = "1.2.4";
    write_series(8, thick, "gap-");
    std::filesystem::remove(folder / "gap-4.dcm");  // slice 4 of 8
    EXPECT_EQ(read(folder).volume.geometry.size[2], 5);
}

TEST_F(Dicom, GapsAreReportedAsFound) {
    double at = 0.0;
    for (const double gap : {0.0, 4.22, 4.22, 7.38, 4.22, 4.22}) {
        Slice slice;
        at += gap;
        slice.position = at * normal;
        write_slice(folder / (std::to_string(static_cast<int>(at * 100)) + ".dcm"), slice);
    }
    expect_refused(folder, "gaps of 4.22 and 7.38 mm between slices, the first of 7.38 mm between " +
                               (folder / "844.dcm").string() + " and " + (folder / "1582.dcm").string());
}

TEST_F(Dicom, DuplicatePositionIsRefused) {
    write_series(5);
    std::filesystem::copy_file(folder / "2.dcm", folder / "copy.dcm");
    expect_refused(folder, "at the same position");
}

TEST_F(Dicom, TruncatedBigEndianSliceIsRefused) {
    Slice big;
    big.syntax = gdcm::TransferSyntax::ExplicitVRBigEndian;
    write_series(5, big);
    EXPECT_EQ(read(folder).volume.geometry.size[2], 5);
    const auto file = folder / "2.dcm";
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 30);
    expect_refused(file, "truncated");
}

TEST_F(Dicom, DeflatedFileIsNamed) {
    Slice deflated;
    deflated.syntax = gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian;
    write_series(5, deflated);
    expect_refused(folder / "0.dcm", "deflated as a whole");
}

TEST_F(Dicom, PixelsWithoutDelimiterAreNamed) {
    write_series(5);
    for (int i = 0; i < 5; ++i) {
        compress(folder / (std::to_string(i) + ".dcm"));
    }
    EXPECT_EQ(read(folder).volume.geometry.size[2], 5);
    const auto file = folder / "2.dcm";
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 8);
    expect_refused(file, "sequence delimiter");
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
