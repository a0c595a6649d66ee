// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/model_file.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "common/hdf5/file.hpp"
#include "random_patient.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti::patient {
namespace {

class ModelFile : public eti::test::ScratchFolderTest {
  protected:
    const std::filesystem::path path = folder / "patient.h5";
};

using test::random_patient;

void expect_same(const std::vector<SkinWeights>& a, const std::vector<SkinWeights>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].frame, b[i].frame);
        EXPECT_EQ(a[i].weight, b[i].weight);
    }
}

void expect_same(const CarriedPoint& a, const CarriedPoint& b) {
    EXPECT_EQ(a.rest, b.rest);
    expect_same(std::vector{a.skin}, std::vector{b.skin});
}

TEST_F(ModelFile, EveryFieldRoundTripsExactly) {
    const Patient saved = random_patient(500, 40, 9);
    save_patient(saved, path, {{"generator", "test"}, {"spacing_m", "0.002"}});
    const Patient loaded = load_patient(path);

    EXPECT_EQ(loaded.weight, saved.weight);
    EXPECT_EQ(loaded.skeleton.neck_joint, saved.skeleton.neck_joint);
    EXPECT_EQ(loaded.skeleton.jaw_joint, saved.skeleton.jaw_joint);
    EXPECT_EQ(loaded.skeleton.jaw_slide_per_radian, saved.skeleton.jaw_slide_per_radian);
    EXPECT_EQ(loaded.particles.rest, saved.particles.rest);
    EXPECT_EQ(loaded.particles.mass, saved.particles.mass);
    EXPECT_EQ(loaded.particles.radius, saved.particles.radius);
    EXPECT_EQ(loaded.particles.tissue, saved.particles.tissue);
    EXPECT_EQ(loaded.particles.bones, saved.particles.bones);
    EXPECT_EQ(loaded.clusters.first, saved.clusters.first);
    EXPECT_EQ(loaded.clusters.member, saved.clusters.member);
    EXPECT_EQ(loaded.clusters.youngs_modulus, saved.clusters.youngs_modulus);
    EXPECT_EQ(loaded.clusters.tissue, saved.clusters.tissue);
    EXPECT_EQ(loaded.tetrahedra.corners, saved.tetrahedra.corners);
    EXPECT_EQ(loaded.tetrahedra.youngs_modulus, saved.tetrahedra.youngs_modulus);
    EXPECT_EQ(loaded.links.ends, saved.links.ends);
    EXPECT_EQ(loaded.links.stiffness, saved.links.stiffness);
    EXPECT_EQ(loaded.frame_rest_centre, saved.frame_rest_centre);
    ASSERT_EQ(loaded.surfaces.size(), saved.surfaces.size());
    for (std::size_t i = 0; i < saved.surfaces.size(); ++i) {
        EXPECT_EQ(loaded.surfaces[i].name, saved.surfaces[i].name);
        EXPECT_EQ(loaded.surfaces[i].tissue, saved.surfaces[i].tissue);
        EXPECT_EQ(loaded.surfaces[i].mesh.vertices, saved.surfaces[i].mesh.vertices);
        EXPECT_EQ(loaded.surfaces[i].mesh.triangles, saved.surfaces[i].mesh.triangles);
        EXPECT_EQ(loaded.surfaces[i].triangle_tissue, saved.surfaces[i].triangle_tissue);
        expect_same(loaded.surfaces[i].skin, saved.surfaces[i].skin);
    }
    EXPECT_EQ(loaded.shell.mesh.vertices, saved.shell.mesh.vertices);
    EXPECT_EQ(loaded.shell.mesh.triangles, saved.shell.mesh.triangles);
    EXPECT_EQ(loaded.shell.triangle_tissue, saved.shell.triangle_tissue);
    EXPECT_EQ(loaded.shell.vertex_bones, saved.shell.vertex_bones);
    EXPECT_EQ(loaded.shell.distance.origin, saved.shell.distance.origin);
    EXPECT_EQ(loaded.shell.distance.spacing, saved.shell.distance.spacing);
    EXPECT_EQ(loaded.shell.distance.size, saved.shell.distance.size);
    EXPECT_EQ(loaded.shell.distance.value, saved.shell.distance.value);
    for (std::size_t i = 0; i < landmark_count; ++i) {
        expect_same(loaded.landmarks[i], saved.landmarks[i]);
    }
    ASSERT_EQ(loaded.glottis_contour.size(), saved.glottis_contour.size());
    for (std::size_t i = 0; i < saved.glottis_contour.size(); ++i) {
        expect_same(loaded.glottis_contour[i], saved.glottis_contour[i]);
    }
    EXPECT_EQ(load_provenance(path), (Provenance{{"generator", "test"}, {"spacing_m", "0.002"}}));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1)
        << "leaves nothing beside the model";
}

/// The error of save_patient for a patient corrupted by `spoil`.
std::string refusal(const std::filesystem::path& path, const std::function<void(Patient&)>& spoil) {
    Patient patient = random_patient(50, 5, 4);
    spoil(patient);
    return eti::test::error_of<hdf5::Error>([&] { save_patient(patient, path, {}); });
}

TEST_F(ModelFile, RefusesInvalidModels) {
    const auto expect_named = [&](const std::string& place, const std::function<void(Patient&)>& spoil) {
        const std::string text = refusal(path, spoil);
        EXPECT_NE(text.find(place), std::string::npos) << place << " is not named by: " << text;
        EXPECT_FALSE(std::filesystem::exists(path));
    };
    EXPECT_EQ(refusal(path, [](Patient&) {}), "");
    std::filesystem::remove(path);
    expect_named("/particles/mass", [](Patient& p) { p.particles.mass.pop_back(); });
    expect_named("/particles/mass", [](Patient& p) { p.particles.mass[3] = -1.0f; });
    expect_named("/particles/rest", [](Patient& p) { p.particles.rest[1].y() = std::nanf(""); });
    expect_named("/particles/bones", [](Patient& p) { p.particles.bones[1][0] += 0.5f; });
    expect_named("/particles/tissue", [](Patient& p) { p.particles.tissue[0] = static_cast<Tissue>(200); });
    expect_named("/clusters/member", [](Patient& p) { p.clusters.member[2] = 50; });
    expect_named("/clusters/first", [](Patient& p) { p.clusters.first.back() += 1; });
    expect_named("/clusters/first", [](Patient& p) { p.clusters.first[2] = 0xffffffffu; });
    expect_named("/clusters/youngs_modulus", [](Patient& p) { p.clusters.youngs_modulus[0] = 0.0f; });
    expect_named("/tetrahedra/corners", [](Patient& p) { p.tetrahedra.corners[0][3] = 50; });
    expect_named("/tetrahedra/youngs_modulus", [](Patient& p) { p.tetrahedra.youngs_modulus.pop_back(); });
    expect_named("/links/ends", [](Patient& p) { p.links.ends[0][1] = 50; });
    expect_named("/frame_rest_centre", [](Patient& p) { p.frame_rest_centre.pop_back(); });
    expect_named("/surfaces/1/triangles", [](Patient& p) { p.surfaces[1].mesh.triangles[0][2] = 25; });
    expect_named("/surfaces/0/skin_frame", [](Patient& p) {
        p.surfaces[0].skin[4] = {{13, 0, 0, 0}, {1, 0, 0, 0}};
    });
    expect_named("/surfaces/0/skin_weight", [](Patient& p) {
        p.surfaces[0].skin[4].weight = {0.5f, 0, 0, 0};
    });
    expect_named("/surfaces/0/triangle_tissue", [](Patient& p) { p.surfaces[0].triangle_tissue.pop_back(); });
    expect_named("/shell/vertex_bones", [](Patient& p) { p.shell.vertex_bones.pop_back(); });
    expect_named("/shell/distance", [](Patient& p) { p.shell.distance.value[5] = INFINITY; });
    expect_named("/shell", [](Patient& p) { p.shell.distance.spacing = 0.0f; });
    // None of these is skinned to the head's frames.
    expect_named("/landmarks/skin_frame", [](Patient& p) {
        p.landmarks[3].skin = {{8, 0, 0, 0}, {1, 0, 0, 0}};
    });
    expect_named("/landmarks/skin_weight", [](Patient& p) { p.landmarks[3].skin.weight = {0, 0, 0, 0}; });
    expect_named("/glottis_contour/rest", [](Patient& p) { p.glottis_contour[3].rest.x() = INFINITY; });
}

TEST_F(ModelFile, RefusesMissingForeignAndTruncatedFiles) {
    const auto text = [&] { return eti::test::error_of<hdf5::Error>([&] { (void)load_patient(path); }); };
    EXPECT_NE(text().find("no such file"), std::string::npos) << text();
    std::ofstream(path) << "";
    EXPECT_NE(text().find("empty"), std::string::npos) << text();
    std::ofstream(path) << "a text, long enough to be taken for a file with a header and a body";
    EXPECT_NE(text().find("not an HDF5 file"), std::string::npos) << text();
    std::filesystem::remove(path);
    {
        hdf5::File other = hdf5::File::create(path);
        other.close();
    }
    EXPECT_NE(text().find("not a patient model"), std::string::npos) << text();

    save_patient(random_patient(500, 40, 9), path, {});
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * 2 / 3);
    EXPECT_NE(text().find(path.string()), std::string::npos) << "accepted a truncated file";
}

TEST_F(ModelFile, ReportsUnwritablePath) {
    EXPECT_THAT(eti::test::error_of<hdf5::Error>(
                    [&] { save_patient(random_patient(50, 5, 4), folder / "missing" / "patient.h5", {}); }),
                ::testing::HasSubstr("No such file or directory"));
}

}  // namespace
}  // namespace eti::patient
