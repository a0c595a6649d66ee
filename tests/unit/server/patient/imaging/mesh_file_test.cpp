// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/mesh_file.hpp"

#include <fmt/format.h>

#include "common/math/random.hpp"
#include "common/mesh/check.hpp"
#include "sample_volume.hpp"
#include "tests/support/error_of.hpp"

namespace eti::imaging {
namespace {

// A tetrahedron with legs of 10, 20 and 30 mm: its volume is 10 * 20 * 30 / 6 = 1000 mm^3.
constexpr float corner[4][3] = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}, {0, 0, 30}};
constexpr int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

Bytes bytes_of(const std::string& text) {
    return {text.begin(), text.end()};
}

Bytes binary_stl(const std::string& title = "tetrahedron") {
    Bytes out = bytes_of(title);
    out.resize(80, ' ');
    store(out, std::uint32_t{4});
    for (const auto& f : face) {
        for (int k = 0; k < 3; ++k) {
            store(out, 0.0f);
        }
        for (const int v : f) {
            for (const float x : corner[v]) {
                store(out, x);
            }
        }
        store(out, std::uint16_t{0});
    }
    return out;
}

std::string text_stl() {
    std::string out = "solid tetrahedron\n";
    for (const auto& f : face) {
        out += "facet normal 0 0 0\nouter loop\n";
        for (const int v : f) {
            out += fmt::format("vertex {} {} {:e}\r\n", corner[v][0], corner[v][1], corner[v][2]);
        }
        out += "endloop\nendfacet\n";
    }
    return out + "endsolid\n";
}

std::string obj() {
    std::string out = "# a comment\no it\n";
    for (const auto& v : corner) {
        out += fmt::format("v {} {} {}\nvn 0 0 1\n", v[0], v[1], v[2]);
    }
    // Each syntax for a corner: alone, with texture and normal, from the end.
    return out + "f 1 3 2\nf 1/1/1 2/1/1 4/1/1\nf 1//1 4//1 3//1\nf -3 -2 -1\n";
}

std::string ply_head(const char* format) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\n"
        "end_header\n",
        format);
}

std::string text_ply() {
    std::string out = ply_head("ascii");
    for (const auto& v : corner) {
        out += fmt::format("{} {} {} 255\n", v[0], v[1], v[2]);
    }
    for (const auto& f : face) {
        out += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    }
    return out;
}

Bytes binary_ply(bool big) {
    Bytes out = bytes_of(ply_head(big ? "binary_big_endian" : "binary_little_endian"));
    const auto put = [&](const auto& value) {
        Bytes raw;
        store(raw, value);
        if (big) {
            std::reverse(raw.begin(), raw.end());
        }
        out.insert(out.end(), raw.begin(), raw.end());
    };
    for (const auto& v : corner) {
        put(v[0]);
        put(v[1]);
        put(v[2]);
        out.push_back(255);
    }
    for (const auto& f : face) {
        out.push_back(3);
        for (const int v : f) {
            put(static_cast<std::int32_t>(v));
        }
    }
    return out;
}

std::vector<std::pair<std::string, Bytes>> files() {
    return {{"binary.stl", binary_stl()},      {"text.stl", bytes_of(text_stl())},
            {"it.obj", bytes_of(obj())},       {"text.ply", bytes_of(text_ply())},
            {"little.ply", binary_ply(false)}, {"big.ply", binary_ply(true)}};
}

TEST(MeshFile, EveryFormatGivesTheSameClosedSolid) {
    for (const auto& [name, data] : files()) {
        const TriangleMesh mesh = parse_mesh(data, name);
        EXPECT_EQ(mesh.vertices.size(), 4u) << name << ": corners at one place are one vertex";
        EXPECT_EQ(mesh.triangles.size(), 4u) << name;
        const MeshReport report = check(mesh);
        EXPECT_TRUE(report.is_valid()) << name << ": " << report.describe();
        EXPECT_NEAR(1e9 * report.volume, 1000.0, 1e-3) << name << ": millimetres, outwards";
    }
}

TEST(MeshFile, RasOf3dSlicerBecomesLps) {
    const TriangleMesh lps = parse_mesh(binary_stl(), "a.stl");
    const TriangleMesh ras = parse_mesh(binary_stl("3D Slicer output. SPACE=RAS"), "a.stl");
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(ras.vertices[i], Vec3f(-lps.vertices[i].x(), -lps.vertices[i].y(), lps.vertices[i].z()));
    }
    EXPECT_TRUE(check(ras).is_valid());
    EXPECT_GT(check(ras).volume, 0.0);
}

TEST(MeshFile, PolygonsBecomeTriangles) {
    const std::string quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    EXPECT_EQ(parse_mesh(bytes_of(quad), "quad.obj").triangles.size(), 2u);
}

std::string refusal(const Bytes& data, const std::string& name) {
    return eti::test::error_of<VolumeError>([&] { (void)parse_mesh(data, name); });
}

TEST(MeshFile, ErrorsNameLineAndRemedy) {
    const auto expect = [](const std::string& text, const std::string& name, const char* finding) {
        const std::string said = refusal(bytes_of(text), name);
        EXPECT_NE(said.find(finding), std::string::npos) << finding << " not in: " << said;
        EXPECT_EQ(said.rfind(name + ": ", 0), 0u) << said;
        EXPECT_NE(said.find("Remedy"), std::string::npos) << said;
    };
    expect("v 0 0 zero\n", "a.obj", "line 1: 'zero'; expected a number");
    expect("v 0 0\n", "a.obj", "three coordinates");
    expect("v 0 0 nan\n", "a.obj", "not within a patient");
    expect("v 0 0 0\nf 1 2 3\n", "a.obj", "line 2: vertex 2; expected 1 to 1");
    expect("", "a.obj", "no triangles");
    expect("ply\nformat ascii 1.0\n", "a.ply", "does not end");
    expect(ply_head("ascii") + "0 0 0 1\n", "a.ply", "ends early");
    expect("ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "a.ply", "99999999999 times");
    expect("anything", "a.vtk", "does not indicate the format");
    Bytes cut = binary_stl();
    cut.resize(cut.size() - 7);
    EXPECT_NE(refusal(cut, "a.stl").find("expected 284 bytes"), std::string::npos) << refusal(cut, "a.stl");
}

TEST(MeshFile, DamagedFilesAreRefusedOrHarmless) {
    Random random(77);
    for (const auto& [name, whole] : files()) {
        for (int round = 0; round < 3000; ++round) {
            Bytes data = whole;
            for (int flips = 1 + static_cast<int>(random.bits() % 4); flips > 0; --flips) {
                data[random.bits() % data.size()] = static_cast<std::uint8_t>(random.bits());
            }
            if (round % 3 == 0) {
                data.resize(random.bits() % data.size());
            }
            try {
                const TriangleMesh mesh = parse_mesh(data, name);
                for (const Triangle& t : mesh.triangles) {
                    for (const std::uint32_t v : t) {
                        ASSERT_LT(v, mesh.vertices.size()) << name;
                    }
                }
            } catch (const VolumeError& error) {
                ASSERT_EQ(std::string(error.what()).rfind(name + ": ", 0), 0u) << error.what();
            }
        }
    }
}

class MeshFiles : public test::Folder {};

TEST_F(MeshFiles, AreReadInAChildProcess) {
    write_bytes(folder / "a.stl", binary_stl());
    EXPECT_TRUE(check(read_mesh(folder / "a.stl")).is_valid());
    EXPECT_THROW((void)read_mesh(folder / "none.stl"), VolumeError);
}

}  // namespace
}  // namespace eti::imaging
